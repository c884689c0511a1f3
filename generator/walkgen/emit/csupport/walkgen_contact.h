/* walkgen_contact.h: the least forces with which feet carry a load within their friction cones; walkgen_math.h explains the macros.
 *
 * Everything is in one frame; wrench is the load on the robot (force, moment about the frame's origin) and f_i the ground's force on foot
 * i, so that sum (f_i, p_i x f_i) + wrench = 0. While no cone is active, walkgen_contact_inside.h has the answer; otherwise
 * walkgen_contact_newton.h finds the multipliers, or near the edge of what can be carried walkgen_contact_edge.h and, with pyramids,
 * walkgen_contact_corner.h.
 */
#include "walkgen_contact_corner.h"
#include "walkgen_contact_edge.h"
#include "walkgen_contact_inside.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_F64
#define WG_MODERATE WG_C(1e4)
#else
#define WALKGEN_CONTACT_F32
#define WG_MODERATE WG_C(1e3)
#endif

/* The certificate of the better of two proofs: the one of the least violation, which dual holds, unless only y's is strict. */
WG_CALLED void WG_NAME(wg_contact_prove)(const struct WG_NAME(wg_contact_search) * search, const WG_REAL y[6], int strict,
                                             WG_REAL certificate[6], WG_REAL *violation) {
    const struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    const WG_REAL *least = search->dual.y;
    if (strict && !(WG_NAME(wg_contact_proof)(stance, least, WG_C(8.0) * WG_EPSILON, WG_C(0.0)) > WG_C(0.0))) {
        least = y;
    }
    WG_NAME(wg_contact_refute)(stance, least, certificate, violation);
}

/* The search by multipliers alone, of bounded feet and polygons: the least forces, else the forces of the least violation; where none are
 * found and feet are without bound, whatever forces carry the load, or a proof. */
WG_CALLED int32_t WG_NAME(wg_contact_bounded)(struct WG_NAME(wg_contact_search) * search, struct WG_NAME(walkgen_contact_work) * work,
                                              WG_REAL *f, int32_t *state, WG_REAL certificate[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    WG_REAL any[3][WALKGEN_MAX_FEET], y[6], lacking;
    WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, any);
    WG_NAME(wg_contact_into_cones)(stance, any);
    (void)WG_NAME(wg_contact_approach)(stance, dual);
    WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, search->f);
    if (WG_NAME(wg_contact_deliver)(search, WG_NAME(wg_contact_polish)(stance, dual, search->f), work, f, state, violation)) {
        return WALKGEN_OK;
    }
    WG_NAME(wg_contact_copy)(stance->feet, any, search->f);
    if (WG_NAME(wg_contact_deliver)(search, WG_NAME(wg_contact_imbalance)(stance, any), work, f, state, violation)) {
        return WALKGEN_OK;
    }
    if (!WG_NAME(wg_contact_is_unbounded)(stance)) {
        return WALKGEN_NO_CONVERGENCE;
    }
    if (WG_NAME(wg_contact_corners)(stance, y, search->f, &lacking) == WG_CONTACT_REFUTED) {
        WG_NAME(wg_contact_refute)(stance, y, certificate, violation);
        return WALKGEN_INFEASIBLE;
    }
    return WG_NAME(wg_contact_deliver)(search, lacking, work, f, state, violation) ? WALKGEN_OK : WALKGEN_NO_CONVERGENCE;
}

/* The search from dual's multipliers: its status. At the edge of what can be carried (to 1e-10 of the load) the forces may be any that
 * carry it. The least violation of feet without bound is sought by a few steps only, as it converges slowly near the edge. */
WG_CALLED int32_t WG_NAME(wg_contact_find)(struct WG_NAME(wg_contact_search) * search, struct WG_NAME(walkgen_contact_work) * work,
                                               WG_REAL *f, int32_t *state, WG_REAL certificate[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    WG_REAL y[6], lacking = WG_INFINITY;
    const int answer = WG_NAME(wg_contact_climb)(search, &lacking);
    const int round = stance->cones.facets == 0 && WG_NAME(wg_contact_is_unbounded)(stance);
    int i, strict;
    if (answer == WG_CONTACT_FOUND && WG_NAME(wg_contact_deliver)(search, lacking, work, f, state, violation)) {
        return WALKGEN_OK;
    }
    for (i = 0; i < 6; ++i) {
        y[i] = dual->y[i];
    }
    strict = answer == WG_CONTACT_REFUTED && WG_NAME(wg_contact_proof)(stance, y, WG_C(8.0) * WG_EPSILON, WG_C(0.0)) > WG_C(0.0);
    if (WG_NAME(wg_contact_violate)(stance, round ? 12 : 40, dual) == WG_CONTACT_REFUTED || strict) {
        WG_NAME(wg_contact_prove)(search, y, strict, certificate, violation);
        return WALKGEN_INFEASIBLE;
    }
    return round ? WG_NAME(wg_contact_at_edge)(search, work, f, state, certificate, violation)
                 : WG_NAME(wg_contact_bounded)(search, work, f, state, certificate, violation);
}

/* The same, from the last stance's multipliers where they are nearer and lead to moderate ones; else from the forces without cones, so that
 * a start never decides the verdict. */
WG_CALLED int32_t WG_NAME(wg_contact_resume)(struct WG_NAME(wg_contact_search) * search, struct WG_NAME(walkgen_contact_work) * work,
                                                 WG_REAL *f, int32_t *state, WG_REAL certificate[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    WG_REAL cold[6], lacking;
    int i;
    for (i = 0; i < 6; ++i) {
        cold[i] = dual->y[i];
    }
    dual->stretch = WG_C(1.0);
    dual->bound = WG_C(0.0);
    dual->centre = NULL;
    if (WG_NAME(wg_contact_start)(work, search)) {
        if (WG_NAME(wg_contact_climb)(search, &lacking) == WG_CONTACT_FOUND &&
            WG_NAME(wg_contact_product)(dual->y, dual->y) <= WG_MODERATE * WG_MODERATE &&
            WG_NAME(wg_contact_deliver)(search, lacking, work, f, state, violation)) {
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
    WG_REAL y[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    int axis;
    if (!WG_NAME(wg_contact_read)(k, points, normals, mu, wrench, weight, n_max, facets, &search.stance)) {
        WG_NAME(wg_contact_blank)(k, WG_NAN, f, state, certificate, violation);
        return WALKGEN_BAD_INPUT;
    }
    for (axis = 0; axis < 6; ++axis) {
        certificate[axis] = WG_C(0.0);
    }
    *violation = WG_C(0.0);
    if (!(WG_NAME(wg_contact_product)(search.stance.b, search.stance.b) > WG_C(0.0))) {
        WG_NAME(wg_contact_blank)(k, WG_C(0.0), f, state, certificate, violation);
        return WALKGEN_OK;
    }
    axis = WG_NAME(wg_contact_spread)(&search.stance, search.dual.y);
    if (axis < 0) {
        return WG_NAME(wg_contact_resume)(&search, work, f, state, certificate, violation);
    }
    y[3 + axis] = search.stance.b[3 + axis];
    WG_NAME(wg_contact_refute)(&search.stance, y, certificate, violation);
    *violation = WG_INFINITY;
    return WALKGEN_INFEASIBLE;
}

/* f [k,3] of least sum of weight |f|^2, NaN unless status is OK; state [k]; the balance that f lacks in violation. facets 0: circular
 * cones. INFEASIBLE: certificate . wrench = 1, while certificate . (f, p x f) is at least 0 for all forces that a foot can exert (with
 * n_max: the sum of its least values is above -1), and violation is a distance that all balanced forces have from the cones (infinite where
 * feet on a line cannot carry the moment). At most 36 kB of stack in double, 20 kB in float. */
static inline void WG_NAME(wg_contact_least_squares)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                                     const WG_REAL *wrench, const WG_REAL *weight, const WG_REAL *n_max, int32_t facets,
                                                     struct WG_NAME(walkgen_contact_work) * work, WG_REAL *f, int32_t *status,
                                                     int32_t *state,
                                                     WG_REAL *certificate, WG_REAL *violation) {
    const WG_REAL share = facets == 0 ? WG_C(1.0) : facets == 4 ? WG_C(0.70710678118) : WG_C(0.0);
    int i;
    if (k >= 1 && k <= WALKGEN_MAX_FEET && (facets == 0 || (facets >= 3 && facets <= 1024)) &&
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
        state[i / 3] = WG_CONTACT_FREE;
    }
}

#undef WG_MODERATE
#endif
