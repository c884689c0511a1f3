/* walkgen_slip_search.h: the equations of a tripod that begins to slip, and their solution; walkgen_math.h explains the macros.
 *
 * All feet slide, by a twist (v, w) along the ground: n . V = 0 at every foot, V = v + w x p. Friction is mu N against V:
 *     sum N (n - mu V / |V|) [1; p x] + load = 0
 * Admissible twists are spanned by three, t = sum of tau_j B_j; with |tau| = 1 these are 7 equations for N, tau and mu. Along B the normal
 * forces do no work: for given N, tau is where sum N |V| is least for the load's power 1, a convex problem, whose minimum is where Newton
 * on all equations starts from. A foot may stay where it is, with friction less than mu N, and the robot turns about it: then the equations
 * have its friction instead of tau.
 */
#include "walkgen_contact_vertical.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SLIP_SEARCH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SLIP_SEARCH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SLIP_SEARCH_F64
#define WG_FAIR WG_C(1e-12)
#define WG_SMALL WG_C(1e-9)
#else
#define WALKGEN_SLIP_SEARCH_F32
#define WG_FAIR WG_C(1e-5)
#define WG_SMALL WG_C(1e-5)
#endif

/* The tripod: wrenches of unit normal forces, admissible twists, by rows; velocities of foot i by B_j, and the unknowns. `held`: the foot
 * that stays, or -1; T its friction. */
struct WG_NAME(wg_tripod) {
    struct WG_NAME(wg_stance) stance;
    const WG_REAL *normals;
    WG_REAL press[3][6], B[3][6], speed[3][3][3], N[3], tau[3], mu, T[3];
    int held;
};

/* Velocity of a foot. */
static inline void WG_NAME(wg_slip_velocity)(const struct WG_NAME(wg_tripod) * slip, int foot, const WG_REAL tau[3], WG_REAL V[3]) {
    int i;
    for (i = 0; i < 3; ++i) {
        V[i] = tau[0] * slip->speed[foot][0][i] + tau[1] * slip->speed[foot][1][i] + tau[2] * slip->speed[foot][2][i];
    }
}

/* A linear system of n <= 8 equations, rows [n][n + 1], solved in place by elimination with pivots: whether it has a
 * solution, in column n. */
static inline int WG_NAME(wg_slip_eliminate)(int n, WG_REAL rows[8][9]) {
    int i, j, c, pivot;
    for (c = 0; c < n; ++c) {
        pivot = c;
        for (i = c + 1; i < n; ++i) {
            pivot = WG_ABS(rows[i][c]) > WG_ABS(rows[pivot][c]) ? i : pivot;
        }
        if (!(WG_ABS(rows[pivot][c]) > WG_TINY && WG_ABS(rows[pivot][c]) <= WG_HUGE)) {
            return 0;
        }
        for (j = c; j <= n; ++j) {
            const WG_REAL other = rows[c][j];
            rows[c][j] = rows[pivot][j];
            rows[pivot][j] = other;
        }
        for (i = 0; i < n; ++i) {
            const WG_REAL share = i == c ? WG_C(0.0) : rows[i][c] / rows[c][c];
            for (j = c; j <= n && i != c; ++j) {
                rows[i][j] -= share * rows[c][j];
            }
        }
    }
    for (c = 0; c < n; ++c) {
        rows[c][n] /= rows[c][c];
    }
    return 1;
}

/* The sum of N sqrt(|V|^2 + blunt^2) at tau. */
static inline WG_REAL WG_NAME(wg_slip_rubbed)(const struct WG_NAME(wg_tripod) * slip, const WG_REAL tau[3], WG_REAL blunt) {
    WG_REAL sum = WG_C(0.0), V[3];
    int foot;
    for (foot = 0; foot < 3; ++foot) {
        WG_NAME(wg_slip_velocity)(slip, foot, tau, V);
        sum += slip->N[foot] * WG_SQRT(WG_NAME(wg_dot)(V, V) + blunt * blunt);
    }
    return sum;
}

/* The equations of its least value for power 1, rows [4][5], at the present tau; the sum there. */
static inline WG_REAL WG_NAME(wg_slip_slopes)(const struct WG_NAME(wg_tripod) * slip, const WG_REAL power[3], WG_REAL blunt,
                                              WG_REAL rows[8][9]) {
    WG_REAL sum = WG_C(0.0), V[3], along[3], length;
    int i, j, foot;
    for (i = 0; i < 3; ++i) {
        rows[3][i] = rows[i][3] = power[i];
        rows[i][4] = WG_C(0.0);
        for (j = 0; j < 3; ++j) {
            rows[i][j] = WG_C(0.0);
        }
    }
    rows[3][3] = WG_C(0.0);
    rows[3][4] = WG_C(1.0) - WG_NAME(wg_dot)(power, slip->tau);
    for (foot = 0; foot < 3; ++foot) {
        WG_NAME(wg_slip_velocity)(slip, foot, slip->tau, V);
        length = WG_SQRT(WG_NAME(wg_dot)(V, V) + blunt * blunt);
        sum += slip->N[foot] * length;
        for (i = 0; i < 3; ++i) {
            along[i] = WG_NAME(wg_dot)(slip->speed[foot][i], V) / length;
            rows[i][4] -= slip->N[foot] * along[i];
        }
        for (i = 0; i < 3; ++i) {
            for (j = 0; j < 3; ++j) {
                rows[i][j] +=
                    slip->N[foot] / length * (WG_NAME(wg_dot)(slip->speed[foot][i], slip->speed[foot][j]) - along[i] * along[j]);
            }
        }
    }
    return sum;
}

/* tau with the least sum of N |V| for power 1, smoothed: sqrt(|V|^2 + blunt^2), Newton with halved steps from the present tau. */
static inline void WG_NAME(wg_slip_ease)(struct WG_NAME(wg_tripod) * slip, const WG_REAL power[3], WG_REAL blunt) {
    WG_REAL rows[8][9], tried[3], value, sum, factor;
    int turn, i, half;
    for (turn = 0; turn < 40; ++turn) {
        value = WG_NAME(wg_slip_slopes)(slip, power, blunt, rows);
        if (!WG_NAME(wg_slip_eliminate)(4, rows)) {
            return;
        }
        factor = WG_C(2.0);
        sum = WG_INFINITY;
        for (half = 0; half < 30 && !(sum <= value); ++half) {
            factor *= WG_C(0.5);
            for (i = 0; i < 3; ++i) {
                tried[i] = slip->tau[i] + factor * rows[i][4];
            }
            sum = WG_NAME(wg_slip_rubbed)(slip, tried, blunt);
        }
        if (!(sum <= value)) {
            return;
        }
        for (i = 0; i < 3; ++i) {
            slip->tau[i] = tried[i];
        }
        if (value - sum <= WG_SMALL * WG_C(1e-3) * value) {
            return;
        }
    }
}

/* Columns 3 to 5 of the balance's rows for a foot that stays: friction by components, one too many: across n it is bound to 0. */
static inline void WG_NAME(wg_slip_staying)(const struct WG_NAME(wg_tripod) * slip, int foot, WG_REAL rows[8][9]) {
    WG_REAL wrench[6];
    int i, j;
    for (j = 0; j < 3; ++j) {
        WG_REAL axis[3] = {WG_INDICATOR(j == 0), WG_INDICATOR(j == 1), WG_INDICATOR(j == 2)};
        WG_NAME(wg_stance_push)(&slip->stance, foot, axis, wrench);
        for (i = 0; i < 6; ++i) {
            rows[i][3 + j] = wrench[i];
            rows[i][7] -= slip->T[j] * wrench[i];
        }
    }
}

/* The same for a foot that slides where none stays; the unit vector of its velocity. */
static inline void WG_NAME(wg_slip_sliding)(const struct WG_NAME(wg_tripod) * slip, int foot, WG_REAL rows[8][9], WG_REAL unit[3]) {
    WG_REAL V[3], force[3], wrench[6], length;
    int i, j;
    WG_NAME(wg_slip_velocity)(slip, foot, slip->tau, V);
    length = WG_MAX(WG_NAME(wg_norm)(V), WG_TINY);
    WG_NAME(wg_add)(V, WG_C(1.0) / length - WG_C(1.0), V, unit);
    for (j = 0; j < 3 && slip->held < 0; ++j) {
        const WG_REAL along = WG_NAME(wg_dot)(unit, slip->speed[foot][j]);
        for (i = 0; i < 3; ++i) {
            force[i] = -slip->mu * slip->N[foot] / length * (slip->speed[foot][j][i] - along * unit[i]);
        }
        WG_NAME(wg_stance_push)(&slip->stance, foot, force, wrench);
        for (i = 0; i < 6; ++i) {
            rows[i][3 + j] += wrench[i];
        }
    }
}

/* What the forces leave unbalanced [6], with derivatives to N, tau and mu, or to N, the held foot's friction and mu, in rows [6][9]; the
 * longest part of it. */
static inline WG_REAL WG_NAME(wg_slip_balance)(const struct WG_NAME(wg_tripod) * slip, WG_REAL rows[8][9]) {
    WG_REAL wrench[6], worst = WG_C(0.0);
    int foot, i, j;
    for (i = 0; i < 6; ++i) {
        for (j = 0; j < 7; ++j) {
            rows[i][j] = WG_C(0.0);
        }
        rows[i][7] = -slip->stance.load[i];
    }
    for (foot = 0; foot < 3; ++foot) {
        WG_REAL unit[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)};
        if (foot == slip->held) {
            WG_NAME(wg_slip_staying)(slip, foot, rows);
        } else {
            WG_NAME(wg_slip_sliding)(slip, foot, rows, unit);
        }
        WG_NAME(wg_stance_push)(&slip->stance, foot, unit, wrench);
        for (i = 0; i < 6; ++i) {
            rows[i][6] -= slip->N[foot] * wrench[i];
            rows[i][foot] = slip->press[foot][i] - slip->mu * wrench[i];
            rows[i][7] -= slip->N[foot] * rows[i][foot];
        }
    }
    for (i = 0; i < 6; ++i) {
        worst = WG_MAX(worst, WG_ABS(rows[i][7]));
    }
    return worst;
}

/* Newton on balance and the unknowns' norm: whether it ends in balance. */
static inline int WG_NAME(wg_slip_newton)(struct WG_NAME(wg_tripod) * slip) {
    WG_REAL rows[8][9], worst, least = WG_INFINITY;
    int turn, i, idle = 0;
    for (turn = 0; turn < 40; ++turn) {
        worst = WG_NAME(wg_slip_balance)(slip, rows);
        if (!(worst <= WG_HUGE)) {
            return 0;
        }
        idle = worst < WG_C(0.5) * least ? 0 : idle + 1;
        least = WG_MIN(least, worst);
        if ((worst <= WG_FAIR && idle > 0) || idle > 12) {
            break;
        }
        for (i = 0; i < 7; ++i) {
            rows[6][i] = WG_C(0.0);
        }
        rows[6][7] = WG_C(0.0);
        for (i = 0; i < 3; ++i) {
            rows[6][3 + i] = slip->held < 0 ? slip->tau[i] : slip->normals[3 * slip->held + i];
            rows[6][7] -= slip->held < 0 ? WG_C(0.0) : slip->normals[3 * slip->held + i] * slip->T[i];
        }
        if (!WG_NAME(wg_slip_eliminate)(7, rows)) {
            return 0;
        }
        for (i = 0; i < 3; ++i) {
            slip->N[i] += rows[i][7];
            if (slip->held < 0) {
                slip->tau[i] += rows[3 + i][7];
            } else {
                slip->T[i] += rows[3 + i][7];
            }
        }
        slip->mu += rows[6][7];
        worst = WG_NAME(wg_norm)(slip->tau);
        for (i = 0; i < 3; ++i) {
            slip->tau[i] /= worst;
        }
    }
    return WG_NAME(wg_slip_balance)(slip, rows) <= WG_C(10.0) * WG_FAIR;
}

/* Whether what was found is a slip: feet press, friction resists the twist, a held foot's friction is within its cone. */
static inline int WG_NAME(wg_slip_holds)(const struct WG_NAME(wg_tripod) * slip, const WG_REAL power[3]) {
    int i, fine = slip->mu > WG_C(0.0) && slip->mu <= WG_HUGE && WG_NAME(wg_dot)(power, slip->tau) > WG_C(0.0);
    for (i = 0; i < 3; ++i) {
        fine &= slip->N[i] >= -WG_SMALL;
    }
    if (slip->held >= 0) {
        fine &= WG_NAME(wg_norm)(slip->T) <= slip->mu * slip->N[slip->held] * (WG_C(1.0) + WG_SMALL) + WG_SMALL;
    }
    return fine;
}

/* tau of the twist that leaves a foot where it is, the way the load drives it; whether there is one. */
static inline int WG_NAME(wg_slip_about)(int foot, const WG_REAL power[3], struct WG_NAME(wg_tripod) * slip) {
    WG_REAL first[3], second[3], longest = WG_C(0.0), tau[3], across[3];
    int i, j, c;
    for (i = 0; i < 3; ++i) { /* speed' has rank 2: the longest product of two of its rows */
        for (j = i + 1; j < 3; ++j) {
            for (c = 0; c < 3; ++c) {
                first[c] = slip->speed[foot][c][i];
                second[c] = slip->speed[foot][c][j];
            }
            WG_NAME(wg_cross)(first, second, across);
            if (WG_NAME(wg_norm)(across) > longest) {
                longest = WG_NAME(wg_norm)(across);
                WG_NAME(wg_add)(across, WG_C(1.0) / longest - WG_C(1.0), across, tau);
            }
        }
    }
    if (!(longest > WG_SMALL)) {
        return 0;
    }
    WG_NAME(wg_add)(tau, WG_NAME(wg_dot)(tau, power) < WG_C(0.0) ? WG_C(-2.0) : WG_C(0.0), tau, slip->tau);
    return 1;
}

#undef WG_FAIR
#undef WG_SMALL
#endif
