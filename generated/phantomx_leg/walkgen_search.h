/* walkgen_search.h: the solution of a chain near a seed, sought from several starts; walkgen_math.h explains the macros. */
#include "walkgen_limits.h"
#include "walkgen_starts.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SEARCH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SEARCH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SEARCH_F64
#define WG_LIBM(name) name
#else
#define WALKGEN_SEARCH_F32
#define WG_LIBM(name) name##f
#endif
#ifndef WG_SPREAD_STARTS
#define WG_SPREAD_STARTS 32
#define WG_CLOSE_STARTS 8
#endif

/* What is sought: the arm, also seen from its foot; and the best found so far: reached and near the seed, or else closest. */
struct WG_NAME(wg_search) {
    const struct WG_NAME(wg_serial) * arm, *back;
    struct WG_NAME(wg_box) box;
    WG_REAL seed[WG_MOST_JOINTS], apart;
    int reached;
    struct WG_NAME(wg_arm_state) best;
};

/* Before the first attempt: the seed, infinitely far from the target. */
static inline void WG_NAME(wg_search_anew)(struct WG_NAME(wg_search) * search) {
    int i, j;
    search->reached = 0;
    search->best.gap = WG_INFINITY;
    for (i = 0; i < 6; ++i) {
        search->best.error[i] = WG_INFINITY;
        for (j = 0; j < search->arm->n; ++j) {
            search->best.edge[j] = 0;
            search->best.q[j] = search->seed[j];
            search->best.column[j][i] = search->best.turning[j][i % 3] = WG_C(0.0);
        }
    }
}

/* Greatest and squared difference of joint values to the seed, modulo full turns. */
static inline WG_REAL WG_NAME(wg_from_seed)(const struct WG_NAME(wg_search) * search, const WG_REAL *q, WG_REAL *square) {
    WG_REAL most = WG_C(0.0);
    int j;
    *square = WG_C(0.0);
    for (j = 0; j < search->arm->n; ++j) {
        const WG_REAL gap = q[j] - search->seed[j];
        const WG_REAL short_way = search->arm->slides[j] ? gap : WG_LIBM(remainder)(gap, WG_C(2.0) * WG_PI);
        *square += short_way * short_way;
        most = WG_MAX(most, WG_ABS(short_way));
    }
    return most;
}

/* Descend from q, brought into the box, and keep what is better than before. */
static inline void WG_NAME(wg_attempt)(struct WG_NAME(wg_search) * search, const WG_REAL *q) {
    const struct WG_NAME(wg_serial) *arm = search->arm;
    struct WG_NAME(wg_arm_state) at;
    WG_REAL apart;
    int j, reached;
    for (j = 0; j < arm->n; ++j) {
        const WG_REAL low = search->box.low[j], high = search->box.high[j];
        at.q[j] = WG_MIN(WG_MAX(WG_NAME(wg_fitted)(arm->slides[j], q[j], low, high, search->seed[j]), low), high);
    }
    reached = WG_NAME(wg_boxed_descent)(arm, &search->box, &at);
    (void)WG_NAME(wg_from_seed)(search, at.q, &apart);
    if (reached > search->reached || (reached == search->reached && (reached ? apart < search->apart : !(at.gap >= search->best.gap)))) {
        search->best = at;
        search->apart = apart;
        search->reached = reached;
    }
}

/* Start number k of a sequence that spreads over the box, or over a part of it around a centre: multiples of square roots of primes. */
static inline void WG_NAME(wg_spread_start)(const struct WG_NAME(wg_search) * search, const WG_REAL *centre, WG_REAL part_of_box, int k,
                                            WG_REAL *q) {
    static const WG_REAL roots[WG_MOST_JOINTS] = {
        WG_C(0.41421356), WG_C(0.73205081), WG_C(0.23606798), WG_C(0.64575131), WG_C(0.31662479), WG_C(0.60555128),
        WG_C(0.12310563), WG_C(0.35889894), WG_C(0.79583152), WG_C(0.38516481), WG_C(0.56776436), WG_C(0.08276253),
        WG_C(0.40312424), WG_C(0.55743852), WG_C(0.85565460), WG_C(0.28010989)};
    const WG_REAL most = WG_C(16.0) * search->arm->reach;
    int j;
    for (j = 0; j < search->arm->n; ++j) {
        const WG_REAL low = search->box.low[j], high = search->box.high[j], part = (WG_REAL)k * roots[j];
        const WG_REAL share = part - WG_LIBM(floor)(part) - WG_C(0.5);
        WG_REAL away = share * (search->arm->slides[j] ? WG_C(2.0) * search->arm->reach : WG_C(2.0) * WG_PI);
        if (high - low <= WG_HUGE) {
            away = low + (WG_C(0.5) + share) * (high - low) - centre[j];
        }
        q[j] = centre[j] + part_of_box * away;
        q[j] = search->arm->slides[j] ? WG_MIN(WG_MAX(q[j], -most), most) : q[j];
    }
}

/* Attempts from closed forms, one after the other in both directions, until one reaches the target; from all of them if `all`. */
static inline void WG_NAME(wg_attempt_rows)(struct WG_NAME(wg_search) * search, int backward, int all, const WG_REAL *q) {
    struct WG_NAME(wg_rows) rows;
    int i;
    if (backward) {
        WG_NAME(wg_backward_rows)(search->back, q, &rows);
    } else {
        WG_NAME(wg_forward_rows)(search->arm, q, &rows);
    }
    for (i = 0; i < rows.count && (all || !search->reached); ++i) {
        WG_NAME(wg_attempt)(search, rows.q[i]);
    }
}

/* Search in the box: from the seed; from all rows of a closed form that has all solutions, unless the seed's is near; and from spread
 * starts, one in eight turned into rows of a closed form (not `hopeful`: only where no closed form has all). Near the target, where a
 * singular pose can hold the arm back, from starts around the best so far. */
static inline void WG_NAME(wg_search_box)(struct WG_NAME(wg_search) * search, int hopeful) {
    const int forward = WG_NAME(wg_all_in_rows)(search->arm), backward = !forward && WG_NAME(wg_all_in_rows)(search->back);
    WG_REAL q[WG_MOST_JOINTS], unused;
    int k;
    WG_NAME(wg_search_anew)(search);
    WG_NAME(wg_attempt)(search, search->seed);
    if (search->reached && WG_NAME(wg_from_seed)(search, search->best.q, &unused) <= WG_C(0.5)) {
        return;
    }
    if (forward || backward) {
        WG_NAME(wg_attempt_rows)(search, backward, 1, search->seed);
    }
    for (k = 1; k <= WG_SPREAD_STARTS && !search->reached && (hopeful || !(forward || backward)); ++k) {
        WG_NAME(wg_spread_start)(search, search->seed, WG_MIN(WG_C(0.125) * (WG_REAL)k, WG_C(1.0)), k, q);
        if (k % 8 == 0 && !search->arm->motion) {
            WG_NAME(wg_attempt_rows)(search, k % 16 == 0, 0, q);
        } else {
            WG_NAME(wg_attempt)(search, q);
        }
    }
    for (k = 1; k <= WG_CLOSE_STARTS && !search->reached && search->best.gap < WG_C(1e-3) * search->arm->reach; ++k) {
        WG_NAME(wg_spread_start)(search, search->best.q, WG_C(0.03), k, q);
        WG_NAME(wg_attempt)(search, q);
    }
}

#undef WG_LIBM
#endif
