/* walkgen_contact.h: the least forces with which feet carry a load within their friction cones; walkgen_math.h explains the macros.
 *
 * Everything is in one frame; wrench is the load on the robot (force, moment about the frame's origin) and f_i the ground's force on foot i,
 * so that sum (f_i, p_i x f_i) + wrench = 0. While no cone is active, walkgen_contact_inside.h has the answer; otherwise
 * walkgen_contact_newton.h finds the multipliers.
 */
#include "walkgen_contact_finish.h"
#include "walkgen_contact_inside.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_F64
#define WG_LIBM(name) name
#define WG_FAIR WG_C(1e-10)
#define WG_MODERATE WG_C(1e4)
#else
#define WALKGEN_CONTACT_F32
#define WG_LIBM(name) name##f
#define WG_FAIR WG_C(5e-5)
#define WG_MODERATE WG_C(1e3)
#endif

/* A search: the stance, its multipliers, the forces. */
struct WG_NAME(wg_contact_search) {
    struct WG_NAME(wg_contact_stance) stance;
    struct WG_NAME(wg_contact_dual) dual;
    WG_REAL f[3][WALKGEN_MAX_FEET];
};

/* The stance inside; 0 where an input is bad. */
WG_CALLED int WG_NAME(wg_contact_read)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *wrench,
                                           const WG_REAL *weight, const WG_REAL *n_max, int32_t facets,
                                           struct WG_NAME(wg_contact_stance) * stance, WG_REAL *noise) {
    struct WG_NAME(wg_contact_cones) *cones = &stance->cones;
    const WG_REAL angle = WG_PI / (WG_REAL)(facets > 0 ? facets : 1);
    WG_REAL unit;
    int i, j;
    if (!WG_NAME(wg_contact_fine)(k, points, normals, mu, wrench, weight, n_max, facets)) {
        return 0;
    }
    stance->feet = cones->rows = k;
    stance->turned = stance->lost[0] = stance->lost[1] = stance->lost[2] = 0;
    WG_NAME(wg_contact_place)(points, weight, stance);
    *noise = WG_NAME(wg_contact_load)(wrench, stance);
    WG_NAME(wg_contact_inertia)(stance);
    unit = WG_C(1.0) / stance->force_unit;
    cones->facets = facets;
    cones->side = cones->corner = WG_C(0.7071067811865476);
    if (facets != 0 && facets != 4) {
        cones->side = WG_COS(angle);
        cones->corner = WG_SIN(angle);
    }
    for (i = 0; i < ((k + 3) & ~3); ++i) {
        const int foot = i < k;
        for (j = 0; j < 3; ++j) {
            cones->n[j][i] = foot ? normals[3 * i + j] : WG_C(0.0);
            cones->along[j][i] = cones->aside[j][i] = WG_C(0.0);
            stance->r[j][i] = foot ? stance->r[j][i] : WG_C(0.0);
        }
        stance->ease[i] = foot ? stance->ease[i] : WG_C(0.0);
        cones->n_max[i] = foot ? unit * n_max[i] : WG_C(0.0);
        WG_NAME(wg_contact_rub)(foot ? mu[i] : WG_C(0.0), i, cones);
        if (foot && facets) {
            WG_NAME(wg_contact_aim)(i, cones);
        }
    }
    return WG_NAME(wg_contact_finite)(stance->b, 6);
}

/* Multipliers of the forces without cones in dual->y. Where the feet are not spread well, the principal axes; the axis of a moment that
 * cannot be carried, or -1. */
static inline int WG_NAME(wg_contact_spread)(WG_REAL noise, struct WG_NAME(wg_contact_stance) * stance, WG_REAL y[6]) {
    const WG_REAL *J = stance->inertia, trace = J[0] + J[3] + J[5], inverse = WG_C(1.0) / stance->mass;
    WG_REAL turning[6];
    int i, axis = -1;
    if (WG_NAME(wg_contact_invert)(J, trace, turning) > WG_C(1e-5)) {
        WG_NAME(wg_contact_apply)(turning, stance->b + 3, y + 3);
    } else {
        (void)WG_NAME(wg_contact_principal)(noise, stance, &axis);
        for (i = 0; i < 3; ++i) {
            y[3 + i] = stance->lost[i] ? WG_C(0.0) : stance->b[3 + i] / J[i == 0 ? 0 : 2 * i + 1];
        }
    }
    for (i = 0; i < 3; ++i) {
        y[i] = inverse * stance->b[i];
    }
    return axis;
}

/* The search's start: forces without cones, or the last stance's multipliers where they leave less to be found; whether it is these. */
static inline int WG_NAME(wg_contact_start)(const struct WG_NAME(walkgen_contact_work) * work, struct WG_NAME(wg_contact_search) * search) {
    const struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    WG_REAL least, first[6];
    int i;
    WG_NAME(wg_contact_evaluate)(stance, dual);
    if (work->feet != stance->feet || stance->turned) {
        return 0;
    }
    least = WG_NAME(wg_contact_product)(dual->slope, dual->slope);
    for (i = 0; i < 6; ++i) {
        first[i] = dual->y[i];
        dual->y[i] = WG_LIBM(ldexp)(work->start[i], i < 3 ? -stance->force_size : stance->length_size - stance->force_size);
    }
    WG_NAME(wg_contact_evaluate)(stance, dual);
    if (WG_NAME(wg_contact_product)(dual->slope, dual->slope) < least) {
        return 1;
    }
    for (i = 0; i < 6; ++i) {
        dual->y[i] = first[i];
    }
    WG_NAME(wg_contact_evaluate)(stance, dual);
    return 0;
}

/* search->f handed over if they balance: whether they do. */
static inline int WG_NAME(wg_contact_deliver)(struct WG_NAME(wg_contact_search) * search, struct WG_NAME(walkgen_contact_work) * work,
                                              WG_REAL *f, int32_t *state, WG_REAL *violation) {
    const struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    const WG_REAL lacking = WG_NAME(wg_contact_imbalance)(stance, search->f);
    int i;
    if (!(lacking <= WG_FAIR)) {
        return 0;
    }
    WG_NAME(wg_contact_hand_over)(stance, search->f, f, state);
    *violation = lacking * stance->force_unit;
    work->feet = stance->turned ? 0 : stance->feet;
    for (i = 0; i < 6; ++i) {
        work->start[i] = WG_LIBM(ldexp)(search->dual.y[i], i < 3 ? stance->force_size : stance->force_size - stance->length_size);
    }
    return 1;
}

/* Newton from dual's multipliers: forces in search->f where it finds them. */
WG_CALLED int WG_NAME(wg_contact_climb)(struct WG_NAME(wg_contact_search) * search) {
    const int answer = WG_NAME(wg_contact_ascend)(&search->stance, 12, &search->dual);
    if (answer == WG_CONTACT_FOUND) {
        WG_NAME(wg_contact_copy)(search->stance.feet, search->dual.images.f, search->f);
        WG_NAME(wg_contact_polish)(&search->stance, &search->dual, search->f);
    }
    return answer;
}

/* The certificate of the better of two proofs: y's, or the one of the least violation, which dual holds; both may hide in rounding. */
WG_CALLED void WG_NAME(wg_contact_prove)(const struct WG_NAME(wg_contact_search) * search, const WG_REAL y[6], WG_REAL gain,
                                             WG_REAL certificate[6], WG_REAL *violation) {
    const struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    const WG_REAL *least = search->dual.y, strict = WG_NAME(wg_contact_proof)(stance, least, WG_C(8.0) * WG_EPSILON, WG_C(0.0));
    if (strict > WG_C(0.0) || !(gain > WG_C(0.0))) {
        gain = strict > WG_C(0.0) ? strict : WG_NAME(wg_contact_proof)(stance, least, WG_C(0.0), WG_C(1.0));
        y = least;
    }
    WG_NAME(wg_contact_refute)(stance, y, gain, certificate, violation);
}

/* The search from dual's multipliers: its status. At the edge of what can be carried (to 1e-10 of the load) the forces may be any that
 * carry it. */
WG_CALLED int32_t WG_NAME(wg_contact_find)(struct WG_NAME(wg_contact_search) * search, struct WG_NAME(walkgen_contact_work) * work,
                                               WG_REAL *f, int32_t *state, WG_REAL certificate[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    WG_REAL y[6], any[3][WALKGEN_MAX_FEET], gain = WG_C(0.0);
    const int answer = WG_NAME(wg_contact_climb)(search);
    int i;
    if (answer == WG_CONTACT_FOUND && WG_NAME(wg_contact_deliver)(search, work, f, state, violation)) {
        return WALKGEN_OK;
    }
    for (i = 0; i < 6; ++i) {
        y[i] = dual->y[i];
    }
    if (answer == WG_CONTACT_REFUTED) {
        gain = WG_NAME(wg_contact_proof)(stance, y, WG_C(8.0) * WG_EPSILON, WG_C(0.0));
    }
    if (WG_NAME(wg_contact_violate)(stance, dual) == WG_CONTACT_REFUTED || gain > WG_C(0.0)) {
        WG_NAME(wg_contact_prove)(search, y, gain, certificate, violation);
        return WALKGEN_INFEASIBLE;
    }
    WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, any);
    WG_NAME(wg_contact_into_cones)(stance, any);
    (void)WG_NAME(wg_contact_approach)(stance, dual);
    WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, search->f);
    WG_NAME(wg_contact_polish)(stance, dual, search->f);
    if (WG_NAME(wg_contact_deliver)(search, work, f, state, violation)) {
        return WALKGEN_OK;
    }
    WG_NAME(wg_contact_copy)(stance->feet, any, search->f);
    return WG_NAME(wg_contact_deliver)(search, work, f, state, violation) ? WALKGEN_OK : WALKGEN_NO_CONVERGENCE;
}

/* The same, from the last stance's multipliers where they are nearer and lead to moderate ones; else from the forces without cones, so that
 * a start never decides the verdict. */
WG_CALLED int32_t WG_NAME(wg_contact_resume)(struct WG_NAME(wg_contact_search) * search, struct WG_NAME(walkgen_contact_work) * work,
                                                 WG_REAL *f, int32_t *state, WG_REAL certificate[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    WG_REAL cold[6];
    int i;
    for (i = 0; i < 6; ++i) {
        cold[i] = dual->y[i];
    }
    dual->stretch = WG_C(1.0);
    dual->bound = WG_C(0.0);
    dual->centre = NULL;
    if (WG_NAME(wg_contact_start)(work, search)) {
        if (WG_NAME(wg_contact_climb)(search) == WG_CONTACT_FOUND &&
            WG_NAME(wg_contact_product)(dual->y, dual->y) <= WG_MODERATE * WG_MODERATE &&
            WG_NAME(wg_contact_deliver)(search, work, f, state, violation)) {
            return WALKGEN_OK;
        }
        for (i = 0; i < 6; ++i) {
            dual->y[i] = cold[i];
        }
        WG_NAME(wg_contact_evaluate)(&search->stance, dual);
    }
    return WG_NAME(wg_contact_find)(search, work, f, state, certificate, violation);
}

/* Where no force lies in the inside of all cones: the status. Called, so that its room does not weigh on the short way. */
WG_CALLED int32_t WG_NAME(wg_contact_active)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                                 const WG_REAL *wrench, const WG_REAL *weight, const WG_REAL *n_max, int32_t facets,
                                                 struct WG_NAME(walkgen_contact_work) * work, WG_REAL *f, int32_t *state,
                                                 WG_REAL certificate[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_search) search;
    WG_REAL noise, y[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    int axis;
    if (!WG_NAME(wg_contact_read)(k, points, normals, mu, wrench, weight, n_max, facets, &search.stance, &noise)) {
        WG_NAME(wg_contact_blank)(k, WG_NAN, f, state, certificate, violation);
        return WALKGEN_BAD_INPUT;
    }
    WG_NAME(wg_contact_blank)(k, WG_C(0.0), f, state, certificate, violation);
    if (!(WG_NAME(wg_contact_product)(search.stance.b, search.stance.b) > WG_C(0.0))) {
        return WALKGEN_OK;
    }
    axis = WG_NAME(wg_contact_spread)(noise, &search.stance, search.dual.y);
    if (axis < 0) {
        return WG_NAME(wg_contact_resume)(&search, work, f, state, certificate, violation);
    }
    y[3 + axis] = search.stance.b[3 + axis];
    WG_NAME(wg_contact_refute)(&search.stance, y, y[3 + axis] * y[3 + axis], certificate, violation);
    *violation = WG_INFINITY;
    return WALKGEN_INFEASIBLE;
}

/* f [k,3] of least sum of weight |f|^2, NaN unless status is OK; state [k]; the balance that f lacks in violation. facets 0: circular cones.
 * INFEASIBLE: certificate . wrench = 1, while certificate . (f, p x f) is at least 0 for all forces that a foot can exert (with n_max: the
 * sum of its least values is above -1), and violation is a distance that all balanced forces have from the cones (infinite where feet on
 * a line cannot carry the moment). At most 18 kB of stack in double, 11 kB in float. */
static inline void WG_NAME(wg_contact_least_squares)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                                     const WG_REAL *wrench, const WG_REAL *weight, const WG_REAL *n_max, int32_t facets,
                                                     struct WG_NAME(walkgen_contact_work) * work, WG_REAL *f, int32_t *status, int32_t *state,
                                                     WG_REAL *certificate, WG_REAL *violation) {
    const WG_REAL share = facets == 0 ? WG_C(1.0) : facets == 4 ? WG_C(0.70710678118) : WG_C(0.0);
    int i;
    if (k >= 1 && k <= WALKGEN_MAX_FEET &&
        WG_NAME(wg_contact_inactive)(k, points, normals, mu, wrench, weight, n_max, share, facets == 4, f, violation)) {
        for (i = 0; i < k; ++i) {
            state[i] = WG_CONTACT_STICK;
        }
        for (i = 0; i < 6; ++i) {
            certificate[i] = WG_C(0.0);
        }
        *status = WALKGEN_OK;
        return;
    }
    *status = WG_NAME(wg_contact_active)(k, points, normals, mu, wrench, weight, n_max, facets, work, f, state, certificate, violation);
    for (i = 0; i < 3 * k && k <= WALKGEN_MAX_FEET && *status != WALKGEN_OK; ++i) {
        f[i] = WG_NAN;
    }
}

#undef WG_LIBM
#undef WG_FAIR
#undef WG_MODERATE
#endif
