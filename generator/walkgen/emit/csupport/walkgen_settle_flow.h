/* walkgen_settle_flow.h: the velocity with which a tripod slides on a terrain, slowly enough for inertia not to count; walkgen_math.h explains
 * the macros.
 *
 * Friction has a viscous part: T = -(mu N / |V| + c) V. For given normal forces N, the admissible twist t is where the convex
 *     -load . t + sum mu N sqrt(|V|^2 + e^2) + c / 2 sum |V|^2
 * is least (e: a speed too small to count); N is what balances load and friction, found in turns. c only scales t, not the path; so it is 1 in
 * the stance's units.
 */
#include "walkgen_slip.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SETTLE_FLOW_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SETTLE_FLOW_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SETTLE_FLOW_F64
#define WG_SLOW WG_C(1e-11)
#define WG_STILL WG_C(1e-7)
#define WG_SHARP WG_C(1e-11)
#else
#define WALKGEN_SETTLE_FLOW_F32
#define WG_SLOW WG_C(1e-6)
#define WG_STILL WG_C(1e-4)
#define WG_SHARP WG_C(1e-5)
#endif

/* The convex function's value at tau, with its slope and second derivatives in rows [3][4], as Newton's system. */
static inline WG_REAL WG_NAME(wg_settle_cost)(const struct WG_NAME(wg_tripod) * slip, const WG_REAL mu[3], const WG_REAL power[3],
                                              const WG_REAL tau[3], WG_REAL slow, WG_REAL rows[8][9]) {
    WG_REAL V[3], along[3], sum = -WG_NAME(wg_dot)(power, tau);
    int foot, i, j;
    for (i = 0; i < 3; ++i) {
        rows[i][0] = rows[i][1] = rows[i][2] = WG_C(0.0);
        rows[i][3] = power[i];
    }
    for (foot = 0; foot < 3; ++foot) {
        const WG_REAL most = mu[foot] * slip->N[foot];
        WG_REAL length, share;
        WG_NAME(wg_slip_velocity)(slip, foot, tau, V);
        length = WG_SQRT(WG_NAME(wg_dot)(V, V) + slow * slow);
        share = most / length;
        sum += most * length + WG_C(0.5) * WG_NAME(wg_dot)(V, V);
        for (i = 0; i < 3; ++i) {
            along[i] = WG_NAME(wg_dot)(slip->speed[foot][i], V);
            rows[i][3] -= (share + WG_C(1.0)) * along[i];
        }
        for (i = 0; i < 3; ++i) {
            for (j = 0; j < 3; ++j) {
                rows[i][j] += (share + WG_C(1.0)) * WG_NAME(wg_dot)(slip->speed[foot][i], slip->speed[foot][j]) -
                              share * (along[i] / length) * (along[j] / length);
            }
        }
    }
    return sum;
}

/* tau of the least cost, from the present one: Newton with halved steps, where the cost, near 1, can be seen to fall. */
static inline void WG_NAME(wg_settle_slide)(const WG_REAL mu[3], const WG_REAL power[3], WG_REAL slow, struct WG_NAME(wg_tripod) * slip) {
    WG_REAL rows[8][9], unused[8][9], slope[3], tried[3], value, next, falls, factor;
    int turn, half, i;
    for (turn = 0; turn < 50; ++turn) {
        value = WG_NAME(wg_settle_cost)(slip, mu, power, slip->tau, slow, rows);
        for (i = 0; i < 3; ++i) {
            slope[i] = rows[i][3];
        }
        falls = WG_NAME(wg_dot)(slope, slope);
        if (falls <= WG_SHARP * WG_SHARP || !WG_NAME(wg_slip_eliminate)(3, rows)) {
            return;
        }
        factor = WG_C(1.0);
        falls = slope[0] * rows[0][3] + slope[1] * rows[1][3] + slope[2] * rows[2][3];
        for (half = 0; half < 40; ++half) {
            if (half > 0 && factor * falls <= WG_C(0.01) * WG_EPSILON) {
                return;
            }
            for (i = 0; i < 3; ++i) {
                tried[i] = slip->tau[i] + factor * rows[i][3];
            }
            next = WG_NAME(wg_settle_cost)(slip, mu, power, tried, slow, unused);
            if (next <= value) {
                break;
            }
            factor *= WG_C(0.5);
        }
        if (half == 40) {
            return;
        }
        for (i = 0; i < 3; ++i) {
            slip->tau[i] = tried[i];
        }
    }
}

/* Normal forces that balance the load and the friction of the present twist; the greatest change of one. */
static inline WG_REAL WG_NAME(wg_settle_press)(const WG_REAL mu[3], WG_REAL slow, struct WG_NAME(wg_tripod) * slip) {
    struct WG_NAME(wg_stance) pushed = slip->stance;
    WG_REAL V[3], wrench[6], left, N[3], change = WG_C(0.0);
    int i, foot;
    for (foot = 0; foot < 3; ++foot) {
        WG_REAL share;
        WG_NAME(wg_slip_velocity)(slip, foot, slip->tau, V);
        share = WG_C(1.0) + mu[foot] * slip->N[foot] / WG_SQRT(WG_NAME(wg_dot)(V, V) + slow * slow);
        WG_NAME(wg_stance_push)(&slip->stance, foot, V, wrench);
        for (i = 0; i < 6; ++i) {
            pushed.load[i] -= share * wrench[i];
        }
    }
    if (!WG_NAME(wg_normal_forces)(&pushed, slip->normals, N, &left)) {
        return WG_INFINITY;
    }
    for (foot = 0; foot < 3; ++foot) {
        const WG_REAL next = WG_MAX(N[foot], WG_C(0.0));
        change = WG_MAX(change, WG_ABS(next - slip->N[foot]));
        slip->N[foot] = next;
        slip->T[foot] = N[foot];
    }
    return change;
}

/* The flow at a stance read into slip: 1 while it slides, 0 where it sticks, -1 where a foot lifts off. */
static inline int WG_NAME(wg_settle_flow)(const WG_REAL mu[3], struct WG_NAME(wg_tripod) * slip) {
    WG_REAL power[3], V[3], slow = WG_C(0.1), fastest = WG_C(0.0), left, last = WG_INFINITY;
    int i, turn;
    if (!WG_NAME(wg_normal_forces)(&slip->stance, slip->normals, slip->N, &left)) {
        return -1;
    }
    for (i = 0; i < 3; ++i) {
        power[i] = WG_NAME(wg_stance_product)(slip->B[i], slip->stance.load);
        slip->N[i] = WG_MAX(slip->N[i], WG_C(0.0));
        slip->tau[i] = WG_C(0.0);
    }
    for (turn = 0; turn < 40; ++turn) {
        for (; slow > WG_SLOW; slow = WG_MAX(WG_C(0.1) * slow, WG_SLOW)) {
            WG_NAME(wg_settle_slide)(mu, power, slow, slip);
        }
        WG_NAME(wg_settle_slide)(mu, power, slow, slip);
        left = WG_NAME(wg_settle_press)(mu, slow, slip);
        if (left <= WG_SHARP || (turn > 8 && left <= WG_C(100.0) * WG_SHARP && left >= last)) {
            break;
        }
        last = left;
    }
    for (i = 0; i < 3; ++i) {
        WG_NAME(wg_slip_velocity)(slip, i, slip->tau, V);
        fastest = WG_MAX(fastest, WG_NAME(wg_norm)(V));
    }
    if (slip->T[0] < -WG_STILL || slip->T[1] < -WG_STILL || slip->T[2] < -WG_STILL) {
        return -1;
    }
    for (i = 0; i < 3 && fastest > WG_STILL; ++i) {
        slip->tau[i] /= fastest;
    }
    return fastest > WG_STILL;
}

#undef WG_SLOW
#undef WG_STILL
#undef WG_SHARP
#endif
