/* walkgen_friction_needed.h: the least friction with which feet carry a load; walkgen_math.h explains the macros.
 *
 * With s(mu) the greatest normal force that every foot has above what its friction needs (walkgen_friction.h), the least friction is the
 * root of s, which does not fall. Newton on s over 1 / mu, where s is the least of straight lines for any forces, within bounds that every
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
#define WG_JUMP WG_C(1e-6)
#else
#define WALKGEN_FRICTION_NEEDED_F32
#define WG_SHARP WG_C(1e-6)
#define WG_CLOSE WG_C(1e-6)
#define WG_FAIR WG_C(2e-4)
#define WG_LEAST WG_C(1e-6)
#define WG_MOST WG_C(1e4)
#define WG_JUMP WG_C(1e-3)
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

/* What is known of the root of s: no less than `low`, proven up to `refuted`, no more than `high`; the present mu and the next one. */
struct WG_NAME(wg_friction_bounds) {
    WG_REAL low, refuted, high, mu, next;
};

/* The bounds by the problem solved at mu, `closed` or not: whether the next mu is the root. */
static inline int WG_NAME(wg_friction_narrow)(int closed, const struct WG_NAME(wg_conic) * conic, struct WG_NAME(wg_friction_bounds) * at) {
    const int vague = !closed && !(conic->s > WG_C(0.0) && conic->unbalanced <= WG_C(10.0) * WG_FAIR); /* by forces too large to balance */
    const WG_REAL slope = WG_NAME(wg_friction_slope)(conic), mu = at->mu;
    WG_REAL next = !vague && conic->s + slope > WG_C(0.0) ? mu * slope / (conic->s + slope) : WG_INFINITY;
    at->next = next;
    if (closed && (WG_ABS(conic->s) <= WG_SHARP || WG_ABS(next - mu) <= WG_CLOSE * mu) && slope > WG_FAIR) {
        return 1;
    }
    if (vague ? at->refuted > WG_C(0.0) : conic->s >= WG_C(0.0) || (conic->s > -WG_FAIR && slope <= WG_FAIR)) {
        at->high = mu;
        next = vague ? next : WG_MAX(WG_MIN(next, WG_NAME(wg_friction_used)(conic, mu)), WG_C(1e-4) * mu);
    } else {
        at->low = mu;
        at->refuted = closed ? mu : at->refuted;
        next = WG_MIN(next, WG_C(16.0) * mu);
    }
    if (!(next > at->low && next < at->high)) {
        next = at->low > WG_C(0.0) ? WG_SQRT(at->low) * WG_SQRT(at->high) : WG_C(0.1) * at->high;
        next = at->high <= WG_HUGE ? next : WG_C(16.0) * at->low;
    }
    at->next = next;
    return 0;
}

/* The problem solved with the least friction from `high` on whose forces balance, and the twist that refutes the lower bound where s jumps
 * there: whether these are an answer. s jumps where feet can press against each other from some friction on: towards that the forces grow
 * without bound, and a friction 1e-6 above it, with forces of about 1e6 loads, is as near as numbers come. */
static inline int WG_NAME(wg_friction_closing)(int rank, const WG_REAL *rough, const struct WG_NAME(wg_friction_bounds) * at,
                                               struct WG_NAME(wg_friction) * friction, WG_REAL *root) {
    struct WG_NAME(wg_conic) *conic = &friction->conic;
    WG_REAL y[6], step = WG_JUMP, rounding;
    int turn, closed, j;
    WG_NAME(wg_friction_pose)(0, rank, rough, at->refuted, friction);
    (void)WG_NAME(wg_conic_solve)(WG_C(1.0), conic);
    for (j = 0; j < rank; ++j) {
        y[j] = conic->y[j];
    }
    *root = at->high;
    for (turn = 0; turn < 4; ++turn) {
        WG_NAME(wg_friction_pose)(0, rank, rough, *root, friction);
        closed = WG_NAME(wg_conic_solve)(WG_C(1.0), conic);
        rounding = WG_MIN(WG_C(4.0) * WG_EPSILON * WG_NAME(wg_stance_largest)(conic->x, 3 * conic->cones), WG_C(100.0) * WG_FAIR);
        if (conic->s >= -WG_FAIR && conic->unbalanced <= WG_MAX(WG_C(10.0) * WG_FAIR, rounding)) {
            break;
        }
        *root = at->refuted * (WG_C(1.0) + step);
        step *= WG_C(4.0);
    }
    if (turn == 4 || *root - at->refuted > WG_MAX((closed ? WG_FAIR : WG_C(20.0) * WG_JUMP) * *root, WG_LEAST)) {
        return -1;
    }
    for (j = 0; j < rank && !closed; ++j) {
        conic->y[j] = y[j];
    }
    *root = at->high <= WG_LEAST ? WG_C(0.0) : *root;
    return 1;
}

/* The root of s over a factor on mu [k] (1 where NULL), and the problem solved there; 0 where it is above WG_MOST, -1 where the search
 * fails. */
static inline int WG_NAME(wg_friction_root)(int rank, const WG_REAL *rough, struct WG_NAME(wg_friction) * friction, WG_REAL *root) {
    struct WG_NAME(wg_friction_bounds) at = {WG_C(0.0), WG_C(0.0), WG_INFINITY, WG_C(0.5), WG_C(0.5)};
    int turn, closed;
    for (turn = 0; turn < 100 && at.next <= WG_MOST; ++turn) {
        at.mu = at.next;
        WG_NAME(wg_friction_pose)(0, rank, rough, at.mu, friction);
        closed = WG_NAME(wg_conic_solve)(WG_C(1.0), &friction->conic);
        if (WG_NAME(wg_friction_narrow)(closed, &friction->conic, &at)) {
            *root = at.next;
            return 1;
        }
        if (at.high <= WG_LEAST || (at.high <= WG_HUGE && at.high - at.low <= WG_CLOSE * at.high)) {
            return WG_NAME(wg_friction_closing)(rank, rough, &at, friction, root);
        }
    }
    return turn < 100 ? 0 : -1;
}

/* The speed of the fastest foot by a twist inside. */
static inline WG_REAL WG_NAME(wg_friction_fastest)(const struct WG_NAME(wg_stance) * stance, const WG_REAL y[6]) {
    WG_REAL fastest = WG_C(0.0), V[3];
    int i;
    for (i = 0; i < stance->feet; ++i) {
        WG_NAME(wg_cross)(y + 3, stance->r[i], V);
        WG_NAME(wg_add)(V, WG_C(1.0), y, V);
        fastest = WG_MAX(fastest, WG_NAME(wg_norm)(V));
    }
    return fastest;
}

/* The least coefficient of friction with which k feet at points [k, 3] with unit normals [k, 3] carry the load, mu_needed, and forces f [k,
 * 3] that do; with less they slip. twist [6] (velocity of the frame's origin, angular velocity) is how: the least motion of feet away from
 * the ground is mu_needed of that along it, V . n >= mu_needed |V - n V . n| for every foot, while the load gains nothing, wrench . twist =
 * 0; the fastest foot has speed 1; zeros where none is needed. INFEASIBLE where no friction helps: mu_needed infinite, f NaN, and twist
 * proves it: wrench . twist = 1 while no foot moves but away from the ground. NO_CONVERGENCE with NaN where no proof was found; BAD_INPUT
 * with NaN. A coefficient above 1e7 counts as none. Where feet carry only by pressing against each other, ever harder towards the least
 * coefficient, mu_needed is up to 2e-5 of it greater, with forces of 1e6 loads and more that balance to their rounding; the load then gains
 * by the twist. */
static inline void WG_NAME(wg_friction_needed)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT normals,
                                               const WG_REAL *WG_RESTRICT wrench, WG_REAL *WG_RESTRICT mu_needed, WG_REAL *WG_RESTRICT f,
                                               WG_REAL *WG_RESTRICT twist, int32_t *WG_RESTRICT status) {
    static const int32_t states[3] = {WALKGEN_NO_CONVERGENCE, WALKGEN_INFEASIBLE, WALKGEN_OK};
    const int known = k >= 1 && k <= WALKGEN_MAX_FEET ? k : 0;
    struct WG_NAME(wg_friction) friction;
    WG_REAL y[6], fastest;
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
    *mu_needed = found > 0 ? *mu_needed : found == 0 ? WG_INFINITY : WG_NAN;
    if (found == 0) {
        fastest = WG_NAME(wg_stance_product)(y, friction.stance.load) * friction.stance.force;
        WG_NAME(wg_friction_outside)(&friction.stance, y, WG_C(1.0) / fastest, twist);
    } else if (found > 0) {
        WG_NAME(wg_friction_forces)(&friction, normals, NULL, *mu_needed, f);
        fastest = WG_NAME(wg_friction_fastest)(&friction.stance, y);
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
#undef WG_JUMP
#endif
