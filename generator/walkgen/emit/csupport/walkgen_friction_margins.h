/* walkgen_friction_margins.h: how far a stance is from slipping and lifting off, and where a foot may stand; walkgen_math.h explains the
 * macros. */
#include "walkgen_friction_needed.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_FRICTION_MARGINS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_FRICTION_MARGINS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_FRICTION_MARGINS_F64
#define WG_UNIT WG_C(1e-9)
#define WG_NONE WG_C(1e-11)
#define WG_FAR WG_C(1e6)
#else
#define WALKGEN_FRICTION_MARGINS_F32
#define WG_UNIT WG_C(1e-5)
#define WG_NONE WG_C(2e-5)
#define WG_FAR WG_C(1e3)
#endif

/* Whether coefficients of friction are some. */
static inline int WG_NAME(wg_friction_rough)(int32_t k, const WG_REAL *mu) {
    int fine = 1, i;
    for (i = 0; i < k; ++i) {
        fine &= mu[i] >= WG_C(0.0) && mu[i] <= WG_C(1.0) / WG_UNIT;
    }
    return fine;
}

/* The share of the friction that is needed: the least factor on all mu [k] with which the feet carry the load; above 1 they slip. Infinite
 * and INFEASIBLE where no factor helps, NaN with NO_CONVERGENCE or BAD_INPUT. */
static inline void WG_NAME(wg_friction_share)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT normals,
                                              const WG_REAL *WG_RESTRICT mu, const WG_REAL *WG_RESTRICT wrench, WG_REAL *WG_RESTRICT share,
                                              int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_friction) friction;
    WG_REAL y[6];
    int rank, found;
    *share = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    if (!WG_NAME(wg_friction_read)(k, points, normals, wrench, &friction) || !WG_NAME(wg_friction_rough)(k, mu)) {
        return;
    }
    found = WG_NAME(wg_friction_helps)(&friction, &rank, y);
    found = found > 0 ? WG_NAME(wg_friction_root)(rank, mu, &friction, share) : found;
    *status = found > 0 ? WALKGEN_OK : found == 0 ? WALKGEN_INFEASIBLE : WALKGEN_NO_CONVERGENCE;
    *share = found > 0 ? *share : found == 0 ? WG_INFINITY : WG_NAN;
}

/* The stance with friction above 0 and a further load: whether they are ones. */
static inline int WG_NAME(wg_margin_read)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                          const WG_REAL *wrench, const WG_REAL *direction, struct WG_NAME(wg_friction) * friction,
                                          struct WG_NAME(wg_stance) * other) {
    int i, fine = WG_NAME(wg_friction_read)(k, points, normals, wrench, friction) && WG_NAME(wg_friction_rough)(k, mu);
    for (i = 0; i < k && fine; ++i) {
        fine = mu[i] > WG_C(0.0);
    }
    if (!fine) {
        return 0;
    }
    *other = friction->stance;
    return WG_NAME(wg_stance_load)(direction, other) && WG_NAME(wg_stance_largest)(other->load, 6) > WG_C(0.0);
}

/* How much more load in a direction, wrench + reach . direction, the feet [k, 3] with friction mu [k] > 0 carry: reach, infinite from 1e6
 * of the load on. lift: the greatest normal force that every foot can have at once above what its friction needs, N_i - |T_i| / mu_i: at
 * this distance from slipping and lifting off is the foot nearest to it; infinite where feet can press against each other. INFEASIBLE where
 * the load itself cannot be carried (lift negative, or NaN where no friction helps; reach NaN); NO_CONVERGENCE or BAD_INPUT with NaN. */
static inline void WG_NAME(wg_load_margin)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT normals,
                                           const WG_REAL *WG_RESTRICT mu, const WG_REAL *WG_RESTRICT wrench,
                                           const WG_REAL *WG_RESTRICT direction, WG_REAL *WG_RESTRICT reach, WG_REAL *WG_RESTRICT lift,
                                           int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_friction) friction;
    struct WG_NAME(wg_stance) other;
    WG_REAL y[6];
    int rank, found, j;
    *reach = *lift = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    if (!WG_NAME(wg_margin_read)(k, points, normals, mu, wrench, direction, &friction, &other)) {
        return;
    }
    *status = WALKGEN_NO_CONVERGENCE;
    found = WG_NAME(wg_friction_helps)(&friction, &rank, y);
    if (found <= 0) {
        *status = found < 0 ? *status : WALKGEN_INFEASIBLE;
        return;
    }
    WG_NAME(wg_friction_pose)(0, rank, mu, WG_C(1.0), &friction);
    if (!WG_NAME(wg_conic_solve)(WG_FAR, &friction.conic) && !(friction.conic.s > WG_FAR)) {
        return;
    }
    *lift = friction.conic.s > WG_FAR ? WG_INFINITY : friction.conic.s * friction.stance.force;
    if (friction.conic.s < -WG_NONE) {
        *status = WALKGEN_INFEASIBLE;
        return;
    }
    for (j = 0; j < rank; ++j) {
        friction.conic.a[j] = WG_NAME(wg_stance_product)(friction.basis[j], other.load);
    }
    if (WG_NAME(wg_conic_solve)(WG_FAR, &friction.conic) || friction.conic.s > WG_FAR) {
        *reach = friction.conic.s > WG_FAR ? WG_INFINITY : WG_MAX(friction.conic.s, WG_C(0.0)) * (friction.stance.force / other.force);
        *status = WALKGEN_OK;
    }
}

/* Where foot number `foot` of k may stand: with a candidate [3] and its normal [3] instead of its own, the share of the friction that is
 * needed, as wg_friction_share says. The foot may stand there where it is at most 1. */
static inline void WG_NAME(wg_foot_admissible)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT normals,
                                               const WG_REAL *WG_RESTRICT mu, const WG_REAL *WG_RESTRICT wrench, int32_t foot,
                                               const WG_REAL *WG_RESTRICT candidate, const WG_REAL *WG_RESTRICT candidate_normal,
                                               WG_REAL *WG_RESTRICT share, int32_t *WG_RESTRICT status) {
    WG_REAL placed[3 * WALKGEN_MAX_FEET], turned[3 * WALKGEN_MAX_FEET];
    int j;
    *share = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    if (k < 1 || k > WALKGEN_MAX_FEET || foot < 0 || foot >= k) {
        return;
    }
    for (j = 0; j < 3 * k; ++j) {
        placed[j] = j / 3 == foot ? candidate[j % 3] : points[j];
        turned[j] = j / 3 == foot ? candidate_normal[j % 3] : normals[j];
    }
    WG_NAME(wg_friction_share)(k, placed, turned, mu, wrench, share, status);
}

#undef WG_UNIT
#undef WG_NONE
#undef WG_FAR
#endif
