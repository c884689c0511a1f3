/* walkgen_within.h: joint values within limits that bring a foot closest to a target; walkgen_math.h explains the macros.
 *
 * Bounded: for up to three joints descents from the guess and from the 16 lowest valleys of a grid of at most 1000 points, for more joints
 * from the guess and 32 points spread over the limits. Each has at most 300 steps, and 1800 to come to rest: at most 69 300 in all.
 */
#include "walkgen_search.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_WITHIN_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_WITHIN_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_WITHIN_F64
#else
#define WALKGEN_WITHIN_F32
#endif
#ifndef WG_GRID_POINTS
#define WG_GRID_POINTS 1000
#define WG_VALLEYS 16
#endif

/* A regular grid over the joints, `along` points for each, and how far the foot is in each. */
struct WG_NAME(wg_grid) {
    int along, points;
    WG_REAL low[3], step[3], gap[WG_GRID_POINTS];
};

static inline void WG_NAME(wg_grid_values)(const struct WG_NAME(wg_grid) * grid, int n, int index, WG_REAL *q) {
    int j;
    for (j = 0; j < n; ++j, index /= grid->along) {
        q[j] = grid->low[j] + (WG_REAL)(index % grid->along) * grid->step[j];
    }
}

/* The grid over the box; where a joint has no bound, over a turn or over lengths twice the reach. */
static inline void WG_NAME(wg_survey)(const struct WG_NAME(wg_search) * search, struct WG_NAME(wg_grid) * grid) {
    const struct WG_NAME(wg_serial) *arm = search->arm;
    struct WG_NAME(wg_arm_state) at;
    int i, j;
    grid->along = arm->n == 3 ? 10 : arm->n == 2 ? 24 : 64;
    grid->points = 1;
    for (j = 0; j < arm->n; ++j) {
        const WG_REAL most = arm->slides[j] ? WG_C(2.0) * arm->reach : WG_PI;
        const WG_REAL low = WG_MIN(WG_MAX(search->box.low[j], -most), search->box.high[j]);
        const WG_REAL high = WG_MAX(WG_MIN(search->box.high[j], most), low);
        const int held = search->box.low[j] >= -WG_HUGE && search->box.high[j] <= WG_HUGE && !arm->slides[j];
        grid->low[j] = held ? search->box.low[j] : low;
        grid->step[j] = ((held ? search->box.high[j] : high) - grid->low[j]) / (WG_REAL)(grid->along - 1);
        grid->points *= grid->along;
    }
    for (i = 0; i < grid->points; ++i) {
        WG_NAME(wg_grid_values)(grid, arm->n, i, at.q);
        WG_NAME(wg_serial_at)(arm, &at);
        grid->gap[i] = at.gap;
    }
}

/* Whether no neighbour along a joint is lower. */
static inline int WG_NAME(wg_is_valley)(const struct WG_NAME(wg_grid) * grid, int index) {
    int stride, lowest = 1;
    for (stride = 1; stride < grid->points; stride *= grid->along) {
        const int place = index / stride % grid->along;
        lowest = lowest && !(place > 0 && grid->gap[index - stride] < grid->gap[index]);
        lowest = lowest && !(place < grid->along - 1 && grid->gap[index + stride] < grid->gap[index]);
    }
    return lowest;
}

/* The lowest valleys, lowest first: their number. */
static inline int WG_NAME(wg_valleys)(const struct WG_NAME(wg_grid) * grid, int valleys[WG_VALLEYS]) {
    int i, k, kept = 0;
    for (i = 0; i < grid->points; ++i) {
        if (!(grid->gap[i] < WG_INFINITY) || !WG_NAME(wg_is_valley)(grid, i) || (kept == WG_VALLEYS && !(grid->gap[i] < grid->gap[valleys[kept - 1]]))) {
            continue;
        }
        kept = kept < WG_VALLEYS ? kept + 1 : kept;
        for (k = kept - 1; k > 0 && grid->gap[i] < grid->gap[valleys[k - 1]]; --k) {
            valleys[k] = valleys[k - 1];
        }
        valleys[k] = i;
    }
    return kept;
}

/* Descend from q to rest and keep what is closest; whether that is at rest. */
static inline int WG_NAME(wg_attempt_rest)(struct WG_NAME(wg_search) * search, const WG_REAL *q, int rests) {
    const struct WG_NAME(wg_arm_state) before = search->best;
    struct WG_NAME(wg_arm_state) found;
    int rested;
    search->best.gap = WG_INFINITY;
    WG_NAME(wg_attempt)(search, q);
    if (!(search->best.gap < WG_INFINITY)) { /* there is no foot */
        search->best = before;
        return rests;
    }
    found = search->best;
    rested = search->reached || WG_NAME(wg_come_to_rest)(search->arm, &search->box, &found);
    search->reached = WG_NAME(wg_serial_reaches)(search->arm, &found);
    search->best = found.gap < before.gap ? found : before;
    return found.gap < before.gap ? rested : rests;
}

/* From valleys of a grid, for up to three joints, until the target is reached: whether the best is at rest. */
static inline int WG_NAME(wg_seek_valleys)(struct WG_NAME(wg_search) * search, int rests) {
    struct WG_NAME(wg_grid) grid;
    WG_REAL q[WG_MOST_JOINTS];
    int valleys[WG_VALLEYS], k, count;
    WG_NAME(wg_survey)(search, &grid);
    count = WG_NAME(wg_valleys)(&grid, valleys);
    for (k = 0; k < count && !search->reached; ++k) {
        WG_NAME(wg_grid_values)(&grid, search->arm->n, valleys[k], q);
        rests = WG_NAME(wg_attempt_rest)(search, q, rests);
    }
    return rests;
}

/* From the guess, then from valleys of a grid or from spread starts, until the target is reached: whether the best is at rest. */
static inline int WG_NAME(wg_seek_within)(struct WG_NAME(wg_search) * search) {
    WG_REAL q[WG_MOST_JOINTS];
    int k, rests;
    WG_NAME(wg_search_anew)(search);
    rests = WG_NAME(wg_attempt_rest)(search, search->seed, 0);
    if (search->arm->n <= 3 && !search->reached) {
        return WG_NAME(wg_seek_valleys)(search, rests);
    }
    for (k = 1; k <= WG_SPREAD_STARTS && !search->reached; ++k) {
        WG_NAME(wg_spread_start)(search, search->seed, WG_MIN(WG_C(0.125) * (WG_REAL)k, WG_C(1.0)), k, q);
        rests = WG_NAME(wg_attempt_rest)(search, q, rests);
    }
    return rests;
}

/* Within the limits [n, 2] closest to the arm's target, from a guess in q. */
static inline void WG_NAME(wg_closest)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *limits, WG_REAL *q, int32_t *status) {
    struct WG_NAME(wg_search) search;
    struct WG_NAME(wg_box) bounds;
    int32_t state = WALKGEN_NO_CONVERGENCE;
    int j;
    if (!WG_NAME(wg_read_limits)(arm, limits, &bounds) || !WG_NAME(wg_read_seed)(arm, &bounds, q, search.seed)) {
        WG_NAME(wg_no_row)(arm->n, q, status);
        return;
    }
    search.arm = search.back = arm;
    (void)WG_NAME(wg_bounding)(arm, &bounds, &search.box);
    if (WG_NAME(wg_seek_within)(&search)) {
        state = WG_NAME(wg_serial_reaches)(arm, &search.best) ? WALKGEN_OK : WALKGEN_UNREACHABLE;
    }
    WG_NAME(wg_write_arm)(arm, &bounds, search.seed, &search.best, state, q, status);
    for (j = 0; j < arm->n; ++j) { /* roundings */
        q[j] = *status == WALKGEN_BAD_INPUT ? q[j] : WG_MIN(WG_MAX(q[j], limits[2 * j]), limits[2 * j + 1]);
    }
}

/* Where the status is UNREACHABLE, q [n] becomes the joint values within the limits [n, 2] that bring the foot closest to p, from a guess:
 * OK where it gets there, UNREACHABLE at rest, NO_CONVERGENCE on the way; BAD_INPUT and NaN where an input is not finite or the limits
 * are none. Any other status leaves both alone. geometry [6 n + 3] as of wg_inverse_general, 1 <= n <= 16. */
static inline void WG_NAME(wg_closest_within)(const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT p,
                                              const WG_REAL *WG_RESTRICT limits, int32_t sequence, WG_REAL *WG_RESTRICT q,
                                              int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_serial) arm;
    if (*status == WALKGEN_UNREACHABLE) {
        if (WG_NAME(wg_serial_read)(geometry, p, sequence, &arm)) {
            WG_NAME(wg_closest)(&arm, limits, q, status);
        } else {
            WG_NAME(wg_no_row)(WG_NAME(wg_joints_of)(sequence), q, status);
        }
    }
}

#endif
