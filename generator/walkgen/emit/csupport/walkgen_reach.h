/* walkgen_reach.h: joint values of chains of up to 16 joints for a position or a pose of the foot, within joint limits where that can be;
 * walkgen_math.h explains the macros.
 *
 * Bounded, whatever the input. A descent takes at most 60 steps, 300 once it is within a thousandth of the reach. One search starts from
 * the seed, from at most 8 rows of a closed form, from 32 points, four of which become at most 8 rows each, and from 8 points around the
 * best: at most 77 descents. There is a second search without limits where the first one fails, and 1800 steps at the end where both do.
 * So at most 48 000 steps; from a seed near a solution 4 to 6, and some 60 where the seed is anywhere.
 */
#include "walkgen_search.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_REACH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_REACH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_REACH_F64
#define WG_LOST WG_C(1e-9)
#else
#define WALKGEN_REACH_F32
#define WG_LOST WG_C(1e-5)
#endif

/* Whether the Jacobian has lost rank, by Gram and Schmidt with the longest columns first. */
static inline int WG_NAME(wg_rank_lost)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_arm_state) * at) {
    const int most = arm->n < arm->rows ? arm->n : arm->rows;
    WG_REAL column[WG_MOST_JOINTS][6], first = WG_C(0.0);
    int i, j, k;
    for (j = 0; j < arm->n; ++j) {
        for (i = 0; i < 6; ++i) {
            column[j][i] = i < arm->rows ? at->column[j][i] : WG_C(0.0);
        }
    }
    for (k = 0; k < most; ++k) {
        WG_REAL longest = WG_C(-1.0), pivot[6];
        int chosen = 0;
        for (j = 0; j < arm->n; ++j) {
            const WG_REAL square = WG_NAME(wg_along)(6, column[j], column[j]);
            chosen = square > longest ? j : chosen;
            longest = WG_MAX(longest, square);
        }
        longest = WG_SQRT(longest);
        first = k == 0 ? longest : first;
        if (!(longest > WG_LOST * first)) {
            return 1;
        }
        for (i = 0; i < 6; ++i) {
            pivot[i] = column[chosen][i] / longest;
        }
        for (j = 0; j < arm->n; ++j) {
            const WG_REAL share = WG_NAME(wg_along)(6, column[j], pivot);
            for (i = 0; i < 6; ++i) {
                column[j][i] -= share * pivot[i];
            }
        }
    }
    return 0;
}

/* The solution near a seed: within the limits, or else without them; or else where the arm comes closest. */
static inline void WG_NAME(wg_inverse_near)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *seed, const WG_REAL *limits, WG_REAL *q,
                                            int32_t *status) {
    struct WG_NAME(wg_serial) back;
    struct WG_NAME(wg_search) search;
    struct WG_NAME(wg_box) bounds;
    int32_t state;
    int j, fine = WG_NAME(wg_read_limits)(arm, limits, &bounds), bounded;
    fine = fine && WG_NAME(wg_read_seed)(arm, &bounds, seed, search.seed);
    if (!fine) {
        WG_NAME(wg_no_row)(arm->n, q, status);
        return;
    }
    WG_NAME(wg_serial_reversed)(arm, &back);
    search.arm = arm;
    search.back = &back;
    bounded = WG_NAME(wg_bounding)(arm, &bounds, &search.box);
    WG_NAME(wg_search_box)(&search, !bounded);
    for (j = 0; j < arm->n && !search.reached; ++j) {
        search.box.low[j] = -WG_INFINITY;
        search.box.high[j] = WG_INFINITY;
    }
    if (!search.reached && bounded) {
        WG_NAME(wg_search_box)(&search, 1);
    }
    state = search.reached ? WALKGEN_OK : WALKGEN_UNREACHABLE;
    if (!search.reached && !(search.best.gap < WG_INFINITY && WG_NAME(wg_come_to_rest)(arm, &search.box, &search.best))) {
        state = WALKGEN_NO_CONVERGENCE;
    }
    if (WG_NAME(wg_serial_reaches)(arm, &search.best)) {
        state = WG_NAME(wg_rank_lost)(arm, &search.best) ? WALKGEN_SINGULAR : WALKGEN_OK;
    }
    WG_NAME(wg_write_arm)(arm, &bounds, search.seed, &search.best, state, q, status);
}

/* Joint values [n] near a seed [n] that bring the foot to p, within the limits [n, 2] (infinite where there are none) if that can be: OK;
 * SINGULAR where the Jacobian has lost rank; where the foot does not get there, UNREACHABLE at a q of rest, the best found, or
 * NO_CONVERGENCE on the way to it; BAD_INPUT and NaN where an input is not finite or the limits are none. Angles are in (-pi, pi], or
 * another turn where limits ask for it. geometry [6 n + 3] as of wg_inverse_general, 1 <= n <= 16. */
static inline void WG_NAME(wg_inverse_reach)(const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT p,
                                             const WG_REAL *WG_RESTRICT seed, const WG_REAL *WG_RESTRICT limits, int32_t sequence,
                                             WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_serial) arm;
    if (WG_NAME(wg_serial_read)(geometry, p, sequence, &arm)) {
        WG_NAME(wg_inverse_near)(&arm, seed, limits, q, status);
    } else {
        WG_NAME(wg_no_row)(WG_NAME(wg_joints_of)(sequence), q, status);
    }
}

/* The same for a pose: T [4, 4], a rigid transform; the foot's rotation at q = 0 follows its position: geometry [6 n + 12]. What comes
 * closest is the least sum of the squared distance and the squared angle times a quarter of the reach. */
static inline void WG_NAME(wg_inverse_pose)(const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT T,
                                            const WG_REAL *WG_RESTRICT seed, const WG_REAL *WG_RESTRICT limits, int32_t sequence,
                                            WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_serial) arm;
    if (WG_NAME(wg_serial_read_pose)(geometry, T, sequence, &arm)) {
        WG_NAME(wg_inverse_near)(&arm, seed, limits, q, status);
    } else {
        WG_NAME(wg_no_row)(WG_NAME(wg_joints_of)(sequence), q, status);
    }
}

#undef WG_LOST
#endif
