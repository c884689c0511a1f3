/* walkgen_contact.h: the least forces with which feet carry a load within their friction cones; walkgen_math.h explains the macros.
 *
 * Everything is in one frame; wrench is the load on the robot (force, moment about the frame's origin) and f_i the ground's force on foot i,
 * so that sum (f_i, p_i x f_i) + wrench = 0. While no cone is active, the answer is a rigid body's: f_i = a + alpha x r_i about the feet's
 * centre, one 3 by 3 system. Otherwise walkgen_contact_newton.h finds the multipliers.
 */
#include "walkgen_contact_finish.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_F64
#define WG_LIBM(name) name
#define WG_FAIR WG_C(1e-10)
#define WG_UNIT WG_C(1e-9)
#define WG_SAFE WG_C(1e40)
#else
#define WALKGEN_CONTACT_F32
#define WG_LIBM(name) name##f
#define WG_FAIR WG_C(5e-5)
#define WG_UNIT WG_C(1e-5)
#define WG_SAFE WG_C(1e5)
#endif

/* What a caller keeps between stances: where the search starts. All zeros to begin with. */
struct WG_NAME(wg_contact_work) {
    int32_t feet;
    WG_REAL start[6];
    struct WG_NAME(wg_contact_stance) stance;
    struct WG_NAME(wg_contact_dual) dual;
    WG_REAL f[3][WALKGEN_MAX_FEET];
};

/* a = A^-1 m for the symmetric A of points' second moments (xx, yy, zz, xy, xz, yz); whether it is well conditioned. */
static inline int WG_NAME(wg_contact_turning)(const WG_REAL s[6], const WG_REAL m[3], WG_REAL a[3]) {
    const WG_REAL A = s[1] + s[2], B = s[0] + s[2], C = s[0] + s[1], trace = s[0] + s[1] + s[2];
    const WG_REAL xx = B * C - s[5] * s[5], xy = s[3] * C + s[4] * s[5], xz = s[3] * s[5] + s[4] * B;
    const WG_REAL yy = A * C - s[4] * s[4], yz = A * s[5] + s[3] * s[4], zz = A * B - s[3] * s[3];
    const WG_REAL determinant = A * xx - s[3] * xy - s[4] * xz, inverse = WG_C(1.0) / determinant;
    a[0] = (xx * m[0] + xy * m[1] + xz * m[2]) * inverse;
    a[1] = (xy * m[0] + yy * m[1] + yz * m[2]) * inverse;
    a[2] = (xz * m[0] + yz * m[1] + zz * m[2]) * inverse;
    return determinant > WG_C(1e-4) * trace * trace * trace;
}

/* Forces in the inside of all cones with equal weights: whether they are the answer. Numbers far from 1 are left to the scaled search. */
static inline int WG_NAME(wg_contact_inactive)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                               const WG_REAL *wrench, const WG_REAL *weight, const WG_REAL *n_max, WG_REAL share, WG_REAL *f,
                                               WG_REAL *violation) {
    const WG_REAL each = WG_C(1.0) / (WG_REAL)k;
    WG_REAL c[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, s[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    WG_REAL m[3], a[3], lacking[6], load, length, worst = WG_C(0.0);
    int i, j, fine;
    for (i = 0; i < k; ++i) {
        c[0] += each * points[3 * i];
        c[1] += each * points[3 * i + 1];
        c[2] += each * points[3 * i + 2];
    }
    for (i = 0; i < k; ++i) {
        const WG_REAL x = points[3 * i] - c[0], y = points[3 * i + 1] - c[1], z = points[3 * i + 2] - c[2];
        s[0] += x * x;
        s[1] += y * y;
        s[2] += z * z;
        s[3] += x * y;
        s[4] += x * z;
        s[5] += y * z;
    }
    WG_NAME(wg_cross)(c, wrench, m);
    for (j = 0; j < 3; ++j) {
        m[j] -= wrench[3 + j];
        lacking[j] = wrench[j];
        lacking[3 + j] = -m[j];
    }
    fine = WG_NAME(wg_contact_turning)(s, m, a);
    length = s[0] + s[1] + s[2];
    load = WG_NAME(wg_dot)(wrench, wrench);
    fine &= length > WG_C(1.0) / WG_SAFE && length < WG_SAFE && load > WG_C(1.0) / WG_SAFE && load < WG_SAFE;
    for (i = 0; i < k; ++i) {
        const WG_REAL *n = normals + 3 * i, x = points[3 * i] - c[0], y = points[3 * i + 1] - c[1], z = points[3 * i + 2] - c[2];
        const WG_REAL fx = a[1] * z - a[2] * y - each * wrench[0], fy = a[2] * x - a[0] * z - each * wrench[1];
        const WG_REAL fz = a[0] * y - a[1] * x - each * wrench[2], N = fx * n[0] + fy * n[1] + fz * n[2];
        const WG_REAL tx = fx - N * n[0], ty = fy - N * n[1], tz = fz - N * n[2], most = share * mu[i] * N;
        const WG_REAL unit = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - WG_C(1.0);
        fine &= (N > WG_C(0.0)) & (N <= n_max[i]) & (mu[i] >= WG_C(0.0)) & (tx * tx + ty * ty + tz * tz <= most * most);
        fine &= (WG_ABS(unit) <= WG_C(2.0) * WG_UNIT) & (mu[i] < WG_C(1.0) / WG_UNIT) & (weight[i] >= weight[0]) & (weight[i] <= weight[0]);
        f[3 * i] = fx;
        f[3 * i + 1] = fy;
        f[3 * i + 2] = fz;
        lacking[0] += fx;
        lacking[1] += fy;
        lacking[2] += fz;
        lacking[3] += y * fz - z * fy;
        lacking[4] += z * fx - x * fz;
        lacking[5] += x * fy - y * fx;
    }
    for (j = 0; j < 6; ++j) {
        worst = WG_MAX(worst, WG_ABS(lacking[j]));
    }
    *violation = worst;
    return fine && weight[0] > WG_C(0.0) && weight[0] <= WG_HUGE;
}

/* The stance inside; 0 where an input is bad. */
static inline int WG_NAME(wg_contact_read)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *wrench,
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

/* The search's start: forces without cones, or the last stance's multipliers where they leave less to be found. */
static inline void WG_NAME(wg_contact_start)(struct WG_NAME(wg_contact_work) * work) {
    const struct WG_NAME(wg_contact_stance) *stance = &work->stance;
    struct WG_NAME(wg_contact_dual) *dual = &work->dual;
    WG_REAL least, first[6];
    int i;
    dual->stretch = WG_C(1.0);
    dual->bound = WG_C(0.0);
    dual->centre = NULL;
    WG_NAME(wg_contact_evaluate)(stance, dual);
    if (work->feet != stance->feet || stance->turned) {
        return;
    }
    least = WG_NAME(wg_contact_product)(dual->slope, dual->slope);
    for (i = 0; i < 6; ++i) {
        first[i] = dual->y[i];
        dual->y[i] = WG_LIBM(ldexp)(work->start[i], i < 3 ? -stance->force_size : stance->length_size - stance->force_size);
    }
    WG_NAME(wg_contact_evaluate)(stance, dual);
    if (!(WG_NAME(wg_contact_product)(dual->slope, dual->slope) < least)) {
        for (i = 0; i < 6; ++i) {
            dual->y[i] = first[i];
        }
        WG_NAME(wg_contact_evaluate)(stance, dual);
    }
}

/* work->f handed over if they balance: whether they do. */
static inline int WG_NAME(wg_contact_deliver)(struct WG_NAME(wg_contact_work) * work, WG_REAL *f, int32_t *state, WG_REAL *violation) {
    const struct WG_NAME(wg_contact_stance) *stance = &work->stance;
    const WG_REAL lacking = WG_NAME(wg_contact_imbalance)(stance, work->f);
    int i;
    if (!(lacking <= WG_FAIR)) {
        return 0;
    }
    WG_NAME(wg_contact_hand_over)(stance, work->f, f, state);
    *violation = lacking * stance->force_unit;
    work->feet = stance->turned ? 0 : stance->feet;
    for (i = 0; i < 6; ++i) {
        work->start[i] = WG_LIBM(ldexp)(work->dual.y[i], i < 3 ? stance->force_size : stance->force_size - stance->length_size);
    }
    return 1;
}

/* The certificate of the better of two proofs: y's, or the one of the least violation, which dual holds; both may hide in rounding. */
static inline void WG_NAME(wg_contact_prove)(const struct WG_NAME(wg_contact_work) * work, const WG_REAL y[6], WG_REAL gain,
                                             WG_REAL certificate[6], WG_REAL *violation) {
    const struct WG_NAME(wg_contact_stance) *stance = &work->stance;
    const WG_REAL *least = work->dual.y, strict = WG_NAME(wg_contact_proof)(stance, least, WG_C(8.0) * WG_EPSILON, WG_C(0.0));
    if (strict > WG_C(0.0) || !(gain > WG_C(0.0))) {
        gain = strict > WG_C(0.0) ? strict : WG_NAME(wg_contact_proof)(stance, least, WG_C(0.0), WG_C(1.0));
        y = least;
    }
    WG_NAME(wg_contact_refute)(stance, y, gain, certificate, violation);
}

/* The search: its status. At the edge of what can be carried (to 1e-10 of the load) the forces may be any that carry it. */
static inline int32_t WG_NAME(wg_contact_find)(struct WG_NAME(wg_contact_work) * work, WG_REAL *f, int32_t *state, WG_REAL certificate[6],
                                               WG_REAL *violation) {
    struct WG_NAME(wg_contact_stance) *stance = &work->stance;
    struct WG_NAME(wg_contact_dual) *dual = &work->dual;
    WG_REAL y[6], any[3][WALKGEN_MAX_FEET], gain = WG_C(0.0);
    int i, answer;
    WG_NAME(wg_contact_start)(work);
    answer = WG_NAME(wg_contact_ascend)(stance, 12, dual);
    if (answer == WG_CONTACT_FOUND) {
        WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, work->f);
        WG_NAME(wg_contact_polish)(stance, dual, work->f);
        if (WG_NAME(wg_contact_deliver)(work, f, state, violation)) {
            return WALKGEN_OK;
        }
    }
    for (i = 0; i < 6; ++i) {
        y[i] = dual->y[i];
    }
    if (answer == WG_CONTACT_REFUTED) {
        gain = WG_NAME(wg_contact_proof)(stance, y, WG_C(8.0) * WG_EPSILON, WG_C(0.0));
    }
    if (WG_NAME(wg_contact_violate)(stance, dual) == WG_CONTACT_REFUTED || gain > WG_C(0.0)) {
        WG_NAME(wg_contact_prove)(work, y, gain, certificate, violation);
        return WALKGEN_INFEASIBLE;
    }
    WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, any);
    WG_NAME(wg_contact_into_cones)(stance, any);
    (void)WG_NAME(wg_contact_approach)(stance, dual);
    WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, work->f);
    WG_NAME(wg_contact_polish)(stance, dual, work->f);
    if (WG_NAME(wg_contact_deliver)(work, f, state, violation)) {
        return WALKGEN_OK;
    }
    WG_NAME(wg_contact_copy)(stance->feet, any, work->f);
    return WG_NAME(wg_contact_deliver)(work, f, state, violation) ? WALKGEN_OK : WALKGEN_NO_CONVERGENCE;
}

static inline int32_t WG_NAME(wg_contact_least_squares)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                                        const WG_REAL *wrench, const WG_REAL *weight, const WG_REAL *n_max, int32_t facets,
                                                        struct WG_NAME(wg_contact_work) * work, WG_REAL *f, int32_t *state,
                                                        WG_REAL certificate[6], WG_REAL *violation) {
    WG_REAL noise, y[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    int i, axis;
    int32_t status;
    if (k >= 1 && k <= WALKGEN_MAX_FEET &&
        WG_NAME(wg_contact_inactive)(k, points, normals, mu, wrench, weight, n_max,
                                     facets == 0 ? WG_C(1.0) : facets == 4 ? WG_C(0.70710678118) : WG_C(0.0), f, violation)) {
        for (i = 0; i < k; ++i) {
            state[i] = WG_CONTACT_STICK;
        }
        for (i = 0; i < 6; ++i) {
            certificate[i] = WG_C(0.0);
        }
        return WALKGEN_OK;
    }
    if (!WG_NAME(wg_contact_read)(k, points, normals, mu, wrench, weight, n_max, facets, &work->stance, &noise)) {
        WG_NAME(wg_contact_blank)(k, WG_NAN, f, state, certificate, violation);
        return WALKGEN_BAD_INPUT;
    }
    WG_NAME(wg_contact_blank)(k, WG_C(0.0), f, state, certificate, violation);
    if (!(WG_NAME(wg_contact_product)(work->stance.b, work->stance.b) > WG_C(0.0))) {
        return WALKGEN_OK;
    }
    axis = WG_NAME(wg_contact_spread)(noise, &work->stance, work->dual.y);
    if (axis >= 0) {
        y[3 + axis] = work->stance.b[3 + axis];
        WG_NAME(wg_contact_refute)(&work->stance, y, y[3 + axis] * y[3 + axis], certificate, violation);
        *violation = WG_INFINITY;
        status = WALKGEN_INFEASIBLE;
    } else {
        status = WG_NAME(wg_contact_find)(work, f, state, certificate, violation);
    }
    for (i = 0; i < 3 * k && status == WALKGEN_INFEASIBLE; ++i) {
        f[i] = WG_NAN;
    }
    return status;
}

#undef WG_LIBM
#undef WG_FAIR
#undef WG_UNIT
#undef WG_SAFE
#endif
