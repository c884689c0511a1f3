/* walkgen_contact_carried.h: whether any forces in the feet's cones carry a load, whatever the legs; walkgen_math.h explains the macros.
 *
 * The t [6] that is least for |t|^2 / 2 - w t + sum |projection of -(G' t)_i on its cone|^2 / 2 alpha is the part of the load w that no
 * forces carry, but for alpha: Newton descents, each with a tenth of the last one's alpha.
 */
#include "walkgen_contact_elastic.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_CARRIED_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_CARRIED_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_CARRIED_F64
#define WG_ALPHA WG_C(1e-8)
#define WG_UNCARRIED WG_C(1e-10)
#else
#define WALKGEN_CONTACT_CARRIED_F32
#define WG_ALPHA WG_C(3e-4)
#define WG_UNCARRIED WG_C(1e-4)
#endif

/* The projection of v on a foot's cone and its slope H; half its square. */
static inline WG_REAL WG_NAME(wg_carried_project)(const WG_REAL n[3], WG_REAL mu, const WG_REAL v[3], WG_REAL into[3], WG_REAL H[9]) {
    const WG_REAL N = WG_NAME(wg_elastic_dot)(n, v);
    WG_REAL T[3], size, along, edge[3], inner, outer, round;
    int j, m;
    for (j = 0; j < 3; ++j) {
        T[j] = v[j] - N * n[j];
    }
    size = WG_SQRT(WG_NAME(wg_elastic_dot)(T, T));
    if (mu <= WG_HUGE && !(size <= mu * N)) {
        along = (N + mu * size) / (WG_C(1.0) + mu * mu);
        inner = WG_C(0.0);
        outer = along > WG_C(0.0) ? WG_C(1.0) / (WG_C(1.0) + mu * mu) : WG_C(0.0);
        along = WG_MAX(along, WG_C(0.0));
        round = size > WG_C(0.0) ? along * mu / size : WG_C(0.0);
    } else {
        along = N;
        inner = N > WG_C(0.0) || mu > WG_HUGE ? WG_C(1.0) : WG_C(0.0);
        outer = round = WG_C(0.0);
    }
    for (j = 0; j < 3; ++j) {
        const WG_REAL way = size > WG_C(0.0) ? T[j] / size : WG_C(0.0);
        edge[j] = outer > WG_C(0.0) ? n[j] + mu * way : WG_C(0.0);
        into[j] = outer > WG_C(0.0) ? along * edge[j] : inner * (T[j] + WG_MAX(N, WG_C(0.0)) * n[j]);
    }
    for (j = 0; j < 3; ++j) {
        for (m = 0; m < 3; ++m) {
            const WG_REAL one = j == m ? WG_C(1.0) : WG_C(0.0), flat = one - n[j] * n[m];
            const WG_REAL ways = size > WG_C(0.0) ? T[j] / size * (T[m] / size) : WG_C(0.0);
            H[3 * j + m] = inner * (N > WG_C(0.0) ? one : flat) + outer * edge[j] * edge[m] + round * (flat - ways);
        }
    }
    return WG_C(0.5) * WG_NAME(wg_elastic_dot)(into, into);
}

/* The value at t, its slope and its curvature K [36] (lower triangle). */
static inline WG_REAL WG_NAME(wg_carried_value)(const struct WG_NAME(wg_contact_elastic) * stand, WG_REAL alpha, const WG_REAL t[6],
                                                WG_REAL slope[6], WG_REAL K[36]) {
    WG_REAL value = WG_C(0.0), v[3], into[3], H[9], turned[3][6];
    int32_t i;
    int j, m;
    for (j = 0; j < 6; ++j) {
        value += t[j] * (WG_C(0.5) * t[j] - stand->w[j]);
        slope[j] = t[j] - stand->w[j];
        for (m = 0; m < 6; ++m) {
            K[6 * j + m] = j == m ? WG_C(1.0) : WG_C(0.0);
        }
    }
    for (i = 0; i < stand->feet; ++i) {
        WG_NAME(wg_elastic_moved)(stand->r[i], t, v);
        for (j = 0; j < 3; ++j) {
            v[j] = -v[j];
        }
        value += WG_NAME(wg_carried_project)(stand->n[i], stand->mu[i], v, into, H) / alpha;
        WG_NAME(wg_elastic_gather)(stand->r[i], into, WG_C(-1.0) / alpha, slope, 1);
        for (j = 0; j < 3; ++j) { /* rows of H G' */
            WG_NAME(wg_elastic_cross)(stand->r[i], H + 3 * j, v);
            for (m = 0; m < 3; ++m) {
                turned[j][m] = H[3 * j + m];
                turned[j][3 + m] = v[m];
            }
        }
        for (m = 0; m < 6; ++m) {
            const WG_REAL push[3] = {turned[0][m], turned[1][m], turned[2][m]};
            WG_NAME(wg_elastic_gather)(stand->r[i], push, WG_C(1.0) / alpha, K + m, 6);
        }
    }
    return value;
}

/* One descent: t moved to where the slope vanishes. */
static inline void WG_NAME(wg_carried_descend)(const struct WG_NAME(wg_contact_elastic) * stand, WG_REAL alpha, WG_REAL t[6]) {
    WG_REAL slope[6], K[36], step[6], trial[6], next_slope[6], next_K[36], gain, share;
    WG_REAL value = WG_NAME(wg_carried_value)(stand, alpha, t, slope, K), next;
    int turn, cut, j;
    for (turn = 0; turn < 40; ++turn) {
        gain = WG_C(0.0);
        for (j = 0; j < 6; ++j) {
            step[j] = -slope[j];
        }
        (void)WG_NAME(wg_elastic_factor)(6, 6, K);
        WG_NAME(wg_elastic_resolve)(6, 6, K, step);
        for (j = 0; j < 6; ++j) {
            gain -= slope[j] * step[j];
        }
        share = WG_C(2.0);
        next = value;
        for (cut = 0; cut < 30 && !(next < value - WG_C(1e-4) * share * gain); ++cut) {
            share *= WG_C(0.5);
            for (j = 0; j < 6; ++j) {
                trial[j] = t[j] + share * step[j];
            }
            next = WG_NAME(wg_carried_value)(stand, alpha, trial, next_slope, next_K);
        }
        if (!(next < value)) {
            return;
        }
        value = next;
        for (j = 0; j < 36; ++j) {
            K[j] = next_K[j];
            t[j / 6] = trial[j / 6];
            slope[j / 6] = next_slope[j / 6];
        }
    }
}

/* The size of what no forces carry of the load, which stays while alpha shrinks; 0 where all of it shrinks as well. */
static inline WG_REAL WG_NAME(wg_carried_lack)(const struct WG_NAME(wg_contact_elastic) * stand) {
    WG_REAL t[6], alpha, load, lack = WG_C(0.0), before = WG_C(0.0);
    int j;
    for (j = 0; j < 6; ++j) {
        t[j] = stand->w[j];
    }
    load = WG_SQRT(WG_NAME(wg_elastic_dot)(t, t) + WG_NAME(wg_elastic_dot)(t + 3, t + 3));
    for (alpha = WG_C(0.1); alpha > WG_C(0.5) * WG_ALPHA; alpha *= WG_C(0.1)) {
        WG_NAME(wg_carried_descend)(stand, alpha, t);
        before = lack;
        lack = WG_SQRT(WG_NAME(wg_elastic_dot)(t, t) + WG_NAME(wg_elastic_dot)(t + 3, t + 3));
    }
    return lack > WG_UNCARRIED * load && lack > WG_C(0.5) * before ? lack : WG_C(0.0);
}

#undef WG_ALPHA
#undef WG_UNCARRIED
#endif
