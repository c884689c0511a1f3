/* walkgen_friction_needed.h: the least friction with which feet carry a load; walkgen_math.h explains the macros.
 *
 * With s(mu) the greatest normal force that every foot has above what its friction needs (walkgen_friction.h), the least friction is the root
 * of s, which does not fall. Newton on s over 1 / mu, where s is the least of straight lines for any forces, within bounds that every
 * solve narrows: forces found show that no more is needed, twists that less does not do.
 */
#include "walkgen_friction.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_FRICTION_NEEDED_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_FRICTION_NEEDED_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_FRICTION_NEEDED_F64
#define WG_SHARP WG_C(4e-15)
#define WG_CLOSE WG_C(1e-13)
#define WG_FAIR WG_C(1e-10)
#define WG_LEAST WG_C(1e-13)
#define WG_MOST WG_C(1e7)
#else
#define WALKGEN_FRICTION_NEEDED_F32
#define WG_SHARP WG_C(1e-6)
#define WG_CLOSE WG_C(1e-6)
#define WG_FAIR WG_C(2e-4)
#define WG_LEAST WG_C(1e-6)
#define WG_MOST WG_C(1e4)
#endif

/* The largest |T| / N of the forces found, infinite where one pulls; feet without force do not count. */
static inline WG_REAL WG_NAME(wg_friction_used)(const struct WG_NAME(wg_conic) * conic, WG_REAL mu) {
    WG_REAL used = WG_C(0.0);
    int i;
    for (i = 0; i < 3 * conic->cones; i += 3) {
        const WG_REAL N = conic->x[i] + conic->s, T = WG_SQRT(conic->x[i + 1] * conic->x[i + 1] + conic->x[i + 2] * conic->x[i + 2]);
        if (T > WG_SHARP || N < -WG_SHARP) {
            used = N > WG_C(0.0) ? WG_MAX(used, mu * T / N) : WG_INFINITY;
        }
    }
    return used;
}

/* How fast s falls with 1 / mu, over mu: what tangents give. */
static inline WG_REAL WG_NAME(wg_friction_slope)(const struct WG_NAME(wg_conic) * conic) {
    WG_REAL sum = WG_C(0.0);
    int i;
    for (i = 0; i < 3 * conic->cones; ++i) {
        sum -= i % 3 == 0 ? WG_C(0.0) : conic->x[i] * conic->z[i];
    }
    return sum;
}

/* The root of s over a factor on mu [k] (1 where NULL), and the problem solved there; 0 where it is above WG_MOST, -1 where the search fails. */
static inline int WG_NAME(wg_friction_root)(int rank, const WG_REAL *rough, struct WG_NAME(wg_friction) * friction, WG_REAL *root) {
    struct WG_NAME(wg_conic) *conic = &friction->conic;
    WG_REAL low = WG_C(0.0), refuted = WG_C(0.0), high = WG_INFINITY, mu = WG_C(0.5), next, slope;
    int turn, closed;
    for (turn = 0; turn < 100; ++turn) {
        WG_NAME(wg_friction_pose)(0, rank, rough, mu, friction);
        closed = WG_NAME(wg_conic_solve)(WG_C(1.0), conic);
        slope = WG_NAME(wg_friction_slope)(conic);
        *root = mu;
        if (!closed && !(conic->s > WG_C(0.0) && conic->unbalanced <= WG_C(10.0) * WG_FAIR)) {
            if (!(high <= WG_HUGE)) {
                return -1;
            }
            conic->s = -WG_FAIR; /* forces too large to be told from none */
            slope = WG_C(1.0);
        }
        next = conic->s + slope > WG_C(0.0) ? mu * slope / (conic->s + slope) : WG_INFINITY;
        if (closed && (WG_ABS(conic->s) <= WG_SHARP || WG_ABS(next - mu) <= WG_CLOSE * mu) && slope > WG_FAIR) {
            *root = next;
            return 1;
        }
        if (conic->s >= WG_C(0.0) || (conic->s > -WG_FAIR && slope <= WG_FAIR)) {
            high = mu;
            next = WG_MIN(next, WG_NAME(wg_friction_used)(conic, mu));
            next = WG_MAX(next, WG_C(1e-4) * mu);
        } else {
            low = mu;
            refuted = closed ? mu : refuted;
            next = WG_MIN(next, WG_C(16.0) * mu);
        }
        if (high <= WG_LEAST || (high <= WG_HUGE && high - low <= WG_CLOSE * high)) {
            WG_NAME(wg_friction_pose)(0, rank, rough, high, friction);
            (void)WG_NAME(wg_conic_solve)(WG_C(1.0), conic);
            *root = high <= WG_LEAST ? WG_C(0.0) : high;
            return conic->s >= -WG_FAIR && conic->unbalanced <= WG_C(10.0) * WG_FAIR &&
                           high - refuted <= WG_MAX(WG_FAIR * high, WG_LEAST)
                       ? 1
                       : -1;
        }
        if (!(next > low && next < high)) {
            next = high <= WG_HUGE ? (low > WG_C(0.0) ? WG_SQRT(low) * WG_SQRT(high) : WG_C(0.1) * high) : WG_C(16.0) * low;
        }
        if (next > WG_MOST) {
            return 0;
        }
        mu = next;
    }
    return -1;
}

/* The least coefficient of friction with which k feet at points [k, 3] with unit normals [k, 3] carry the load, mu_needed, and forces f [k, 3]
 * that do; with less they slip. twist [6] (velocity of the frame's origin, angular velocity) is how: the least motion of feet away from the
 * ground is mu_needed of that along it, V . n >= mu_needed |V - n V . n| for every foot, while the load gains nothing, wrench . twist = 0;
 * the fastest foot has speed 1; zeros where none is needed. INFEASIBLE where no friction helps: mu_needed infinite, f NaN, and twist proves
 * it: wrench . twist = 1 while
 * no foot moves but away from the ground. NO_CONVERGENCE with NaN where no proof was found, as with feet that carry by pressing against each other
 * ever harder; BAD_INPUT with NaN. A coefficient above 1e7 counts as none. */
static inline void WG_NAME(wg_friction_needed)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT normals,
                                               const WG_REAL *WG_RESTRICT wrench, WG_REAL *WG_RESTRICT mu_needed, WG_REAL *WG_RESTRICT f,
                                               WG_REAL *WG_RESTRICT twist, int32_t *WG_RESTRICT status) {
    static const int32_t states[3] = {WALKGEN_NO_CONVERGENCE, WALKGEN_INFEASIBLE, WALKGEN_OK};
    const int known = k >= 1 && k <= WALKGEN_MAX_FEET ? k : 0;
    struct WG_NAME(wg_friction) friction;
    WG_REAL y[6], fastest = WG_C(0.0), V[3];
    int i, j, rank, found;
    *status = WALKGEN_BAD_INPUT;
    *mu_needed = WG_NAN;
    for (i = 0; i < 6; ++i) {
        twist[i] = WG_NAN;
    }
    for (i = 0; i < 3 * known; ++i) {
        f[i] = WG_NAN;
    }
    if (!WG_NAME(wg_friction_read)(k, points, normals, wrench, &friction)) {
        return;
    }
    found = WG_NAME(wg_friction_helps)(&friction, &rank, y);
    if (found > 0) {
        found = WG_NAME(wg_friction_root)(rank, NULL, &friction, mu_needed);
        WG_NAME(wg_friction_twist)(&friction, 0, y);
    }
    *status = states[1 + found];
    *mu_needed = found > 0 ? *mu_needed : WG_NAN;
    if (found == 0) {
        *mu_needed = WG_INFINITY;
        WG_NAME(wg_friction_outside)(&friction.stance, y, WG_C(1.0) / (WG_NAME(wg_stance_product)(y, friction.stance.load) * friction.stance.force),
                                     twist);
    } else if (found > 0) {
        WG_NAME(wg_friction_forces)(&friction, normals, NULL, *mu_needed, f);
        for (i = 0; i < k; ++i) {
            WG_NAME(wg_cross)(y + 3, friction.stance.r[i], V);
            WG_NAME(wg_add)(V, WG_C(1.0), y, V);
            fastest = WG_MAX(fastest, WG_NAME(wg_norm)(V));
        }
        WG_NAME(wg_friction_outside)(&friction.stance, y, *mu_needed > WG_C(0.0) ? WG_C(1.0) / fastest : WG_C(0.0), twist);
        for (j = 0; j < 3 * k; ++j) {
            f[j] *= friction.stance.force;
        }
    }
}

#undef WG_SHARP
#undef WG_CLOSE
#undef WG_FAIR
#undef WG_LEAST
#undef WG_MOST
#endif
