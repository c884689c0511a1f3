/* walkgen_crossings.h: every value of a drive at which a function of it is 0, on each of two sides; walkgen_math.h explains the macros.
 *
 * Function and margin are looked at for WG_CROSSINGS_SAMPLES values of the drive, and their roots sought between each two of them. Where the
 * drive ceases to move anything, the end is found by bisection.
 */
#include "walkgen_crossing_search.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CROSSINGS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CROSSINGS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CROSSINGS_F64
#else
#define WALKGEN_CROSSINGS_F32
#endif
#ifndef WG_CROSSINGS_SAMPLES
#define WG_CROSSINGS_SAMPLES 256
#endif

/* The last point at which something moves between one and a drive at which nothing does. */
static inline struct WG_NAME(wg_crossing_point) WG_NAME(wg_crossing_end)(struct WG_NAME(wg_crossing_search) * search,
                                                                         struct WG_NAME(wg_crossing_point) moving, WG_REAL beyond) {
    int turn;
    for (turn = 0; turn < WG_CROSSINGS_HALVINGS; ++turn) {
        const WG_REAL middle = WG_C(0.5) * (moving.drive + beyond);
        const struct WG_NAME(wg_crossing_point) point = WG_NAME(wg_crossing_at)(search, middle);
        if (middle == moving.drive || middle == beyond) {
            break;
        }
        if (point.moves) {
            moving = point;
        } else {
            beyond = middle;
        }
    }
    return moving;
}

/* Roots from a point to where nothing moves, before another drive. */
static inline void WG_NAME(wg_crossing_last)(struct WG_NAME(wg_crossing_search) * search, struct WG_NAME(wg_crossing_point) from, WG_REAL beyond) {
    const struct WG_NAME(wg_crossing_point) end = WG_NAME(wg_crossing_end)(search, from, beyond);
    const WG_REAL way = end.drive - from.drive;
    int part;
    for (part = WG_CROSSINGS_PARTS - 1; part >= 0; --part) {
        const WG_REAL rest = (WG_REAL)part / (WG_REAL)WG_CROSSINGS_PARTS;
        const struct WG_NAME(wg_crossing_point) next = part ? WG_NAME(wg_crossing_at)(search, end.drive - rest * rest * way) : end;
        if (!next.moves) {
            return;
        }
        WG_NAME(wg_crossing_stretch)(search, way > WG_C(0.0) ? &from : &next, way > WG_C(0.0) ? &next : &from);
        from = next;
    }
    WG_NAME(wg_crossing_keep_end)(search, &end);
}

/* One step of the samples. */
static inline void WG_NAME(wg_crossing_step)(struct WG_NAME(wg_crossing_search) * search, const struct WG_NAME(wg_crossing_point) * low,
                                             const struct WG_NAME(wg_crossing_point) * high) {
    if (low->moves && high->moves) {
        WG_NAME(wg_crossing_stretch)(search, low, high);
    } else if (low->moves) {
        WG_NAME(wg_crossing_last)(search, *low, high->drive);
    } else if (high->moves) {
        WG_NAME(wg_crossing_last)(search, *high, low->drive);
    }
}

/* One side from end to end. */
static inline void WG_NAME(wg_crossings_of_side)(struct WG_NAME(wg_crossing_search) * search, WG_REAL start) {
    const struct WG_NAME(wg_crossing_point) first = WG_NAME(wg_crossing_at)(search, start);
    struct WG_NAME(wg_crossing_point) low = first, high;
    int i;
    for (i = 1; i <= WG_CROSSINGS_SAMPLES; ++i) {
        if (low.there && (!search->some.there || WG_NAME(wg_crossing_nearer)(&low, &search->some, WG_CROSSINGS_LEFT) == &low)) {
            search->some = low;
        }
        if (search->closed && i == WG_CROSSINGS_SAMPLES) {
            high = first;
            high.drive = start + (WG_REAL)i * search->step;
        } else {
            high = WG_NAME(wg_crossing_at)(search, start + (WG_REAL)i * search->step);
        }
        WG_NAME(wg_crossing_step)(search, &low, &high);
        low = high;
    }
}

/* What is searched, nothing found yet: whether it can be searched. */
static inline int WG_NAME(wg_crossings_begin)(struct WG_NAME(wg_crossing_search) * search, const WG_REAL bounds[2], const WG_REAL p[3]) {
    const WG_REAL width = bounds[1] - bounds[0];
    const int fine = WG_ABS(p[0]) + WG_ABS(p[1]) + WG_ABS(p[2]) <= WG_HUGE && width > WG_C(0.0) && width <= WG_HUGE;
    int j;
    search->step = width / (WG_REAL)WG_CROSSINGS_SAMPLES;
    search->count = search->some.there = search->some.free = 0;
    search->some.value[WG_CROSSINGS_LEFT] = WG_C(0.0);
    for (j = 0; j < WG_CROSSINGS_JOINTS; ++j) {
        search->some.q[j] = fine ? WG_C(0.0) : WG_NAN;
        search->point[2 + j] = p[j];
    }
    return fine;
}

/* All joint values [WG_CROSSINGS_ROOTS, 3], in order of the drive: OK, or SINGULAR where a joint is free; beyond the last UNREACHABLE with the
 * first again. `best` [3] and `found` are the first row and its status: where that is UNREACHABLE the sample that comes closest to a root, 0
 * where there is none. BAD_INPUT with NaN.
 *
 * bounds: the drive's [2]; p: the target [3]; sides: 1 or 2; closed: 1 where the drive is an angle and bounds are a turn apart. */
static inline void WG_NAME(wg_crossings)(const WG_REAL bounds[2], const WG_REAL p[3], WG_NAME(wg_crossing) function, const void *data, int sides,
                                         int closed, WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status, WG_REAL *WG_RESTRICT best,
                                         int32_t *WG_RESTRICT found) {
    struct WG_NAME(wg_crossing_search) search;
    int i, j, side, fine;
    search.function = function;
    search.data = data;
    search.closed = closed;
    fine = WG_NAME(wg_crossings_begin)(&search, bounds, p);
    for (side = 0; side < sides && fine; ++side) {
        search.point[1] = side ? -WG_C(1.0) : WG_C(1.0);
        WG_NAME(wg_crossings_of_side)(&search, bounds[0]);
    }
    for (i = 0; i < WG_CROSSINGS_ROOTS; ++i) {
        const struct WG_NAME(wg_crossing_point) *row = i < search.count ? &search.roots[i] : search.count ? &search.roots[0] : &search.some;
        for (j = 0; j < WG_CROSSINGS_JOINTS; ++j) {
            q[WG_CROSSINGS_JOINTS * i + j] = row->q[j];
        }
        status[i] = !fine ? WALKGEN_BAD_INPUT : i >= search.count ? WALKGEN_UNREACHABLE : row->free ? WALKGEN_SINGULAR : WALKGEN_OK;
    }
    for (j = 0; j < WG_CROSSINGS_JOINTS; ++j) {
        best[j] = q[j];
    }
    *found = status[0];
}

#endif
