/* walkgen_crossing_search.h: roots of a function of a drive between two values of the drive; walkgen_math.h explains the macros.
 *
 * The function is there where the drive moves something and a margin is not negative; at the margin's roots two sides of the function meet.
 * Where the sign of one changes between two values of the drive it has a root, found by Newton's steps inside a bracket; where it first tends to
 * 0 and then away, its nearest value is sought by bisection of its slope, unless there are two roots before and behind it.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CROSSING_SEARCH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CROSSING_SEARCH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CROSSING_SEARCH_F64
#define WG_CROSSINGS_MET WG_C(1e-12)
#define WG_CROSSINGS_CROSSED WG_C(1e-9)
#define WG_CROSSINGS_SAME WG_C(1e-9)
#else
#define WALKGEN_CROSSING_SEARCH_F32
#define WG_CROSSINGS_MET WG_C(1e-5)
#define WG_CROSSINGS_CROSSED WG_C(1e-4)
#define WG_CROSSINGS_SAME WG_C(1e-4)
#endif
#ifndef WG_CROSSINGS_ROOTS
#define WG_CROSSINGS_ROOTS 16
#define WG_CROSSINGS_JOINTS 3
#define WG_CROSSINGS_HALVINGS 100
#define WG_CROSSINGS_PARTS 6
#define WG_CROSSINGS_LEFT 0 /* the function, among its numbers */
#define WG_CROSSINGS_MARGIN 1
#endif

/* Of a point, which is the drive, the side (1 or -1) and the target: the function (m) and the margin, their slopes, the size of what the function
 * is a sum of, whether a joint is free, the joint values; NaN in the function where the margin is negative, in both where nothing moves. */
typedef void (*WG_NAME(wg_crossing))(const WG_REAL point[5], WG_REAL profile[9], const void *data);

/* At one drive: function and margin; whether something moves, and whether the function is there. */
struct WG_NAME(wg_crossing_point) {
    WG_REAL drive, value[2], slope[2], size, q[WG_CROSSINGS_JOINTS];
    int moves, there, free;
};

/* The function, the point at which it was asked last, the samples' distance, whether the drive turns round, and what has been found. */
struct WG_NAME(wg_crossing_search) {
    WG_NAME(wg_crossing) function;
    const void *data;
    WG_REAL point[5], step;
    struct WG_NAME(wg_crossing_point) roots[WG_CROSSINGS_ROOTS], some;
    int closed, count;
};

static inline struct WG_NAME(wg_crossing_point) WG_NAME(wg_crossing_at)(struct WG_NAME(wg_crossing_search) * search, WG_REAL drive) {
    struct WG_NAME(wg_crossing_point) found;
    WG_REAL profile[6 + WG_CROSSINGS_JOINTS];
    int i;
    search->point[0] = drive;
    search->function(search->point, profile, search->data);
    found.drive = drive;
    for (i = 0; i < 2; ++i) {
        found.value[i] = profile[i];
        found.slope[i] = profile[2 + i];
    }
    found.size = profile[4];
    found.free = profile[5] > WG_C(0.0);
    for (i = 0; i < WG_CROSSINGS_JOINTS; ++i) {
        found.q[i] = profile[6 + i];
    }
    found.moves = WG_ABS(profile[1]) <= WG_HUGE && WG_ABS(profile[3]) <= WG_HUGE;
    found.there = found.moves && profile[1] >= WG_C(0.0) && WG_ABS(profile[0]) <= WG_HUGE && WG_ABS(profile[2]) <= WG_HUGE && profile[4] <= WG_HUGE;
    if (found.moves && !found.there && profile[1] >= WG_C(0.0)) { /* the very end, where slopes are infinite, is beyond it */
        found.value[WG_CROSSINGS_MARGIN] = -WG_EPSILON * WG_EPSILON;
    }
    return found;
}

/* Whether two solutions are one: an angle counts without whole turns. */
static inline int WG_NAME(wg_crossings_are_one)(const struct WG_NAME(wg_crossing_point) * one, const struct WG_NAME(wg_crossing_point) * other) {
    int i, same = 1;
    for (i = 0; i < WG_CROSSINGS_JOINTS; ++i) {
        const WG_REAL away = WG_ABS(one->q[i] - other->q[i]);
        same = same && WG_MIN(away, WG_ABS(away - WG_C(2.0) * WG_PI)) <= WG_CROSSINGS_SAME;
    }
    return same;
}

/* Keep a point that is as near to 0 as `nothing` of its size, once, in order of the drives, the first WG_CROSSINGS_ROOTS of them. */
static inline void WG_NAME(wg_crossing_keep)(struct WG_NAME(wg_crossing_search) * search, struct WG_NAME(wg_crossing_point) point,
                                             WG_REAL nothing) {
    int i, place;
    if (!point.there || !(WG_ABS(point.value[WG_CROSSINGS_LEFT]) <= nothing * point.size)) {
        return;
    }
    point.drive = search->closed && point.drive > WG_PI ? point.drive - WG_C(2.0) * WG_PI : point.drive;
    for (i = 0; i < search->count; ++i) {
        if (WG_NAME(wg_crossings_are_one)(&search->roots[i], &point)) {
            return;
        }
    }
    for (place = search->count; place > 0 && search->roots[place - 1].drive > point.drive + WG_CROSSINGS_SAME; --place) {
        if (place < WG_CROSSINGS_ROOTS) {
            search->roots[place] = search->roots[place - 1];
        }
    }
    if (place < WG_CROSSINGS_ROOTS) {
        search->roots[place] = point;
        search->count += search->count < WG_CROSSINGS_ROOTS;
    }
}

/* Keep an end, where the function turns round or is no longer there, if it is a root. */
static inline void WG_NAME(wg_crossing_keep_end)(struct WG_NAME(wg_crossing_search) * search, const struct WG_NAME(wg_crossing_point) * end) {
    WG_NAME(wg_crossing_keep)(search, *end, WG_CROSSINGS_MET);
}

/* The one that is nearer to 0. */
static inline const struct WG_NAME(wg_crossing_point) * WG_NAME(wg_crossing_nearer)(const struct WG_NAME(wg_crossing_point) * low,
                                                                                    const struct WG_NAME(wg_crossing_point) * high, int which) {
    return WG_ABS(low->value[which]) < WG_ABS(high->value[which]) ? low : high;
}

/* Whether the sign changes between two points. */
static inline int WG_NAME(wg_crossing_between)(const struct WG_NAME(wg_crossing_point) * low, const struct WG_NAME(wg_crossing_point) * high,
                                               int which) {
    return (low->value[which] < WG_C(0.0)) != (high->value[which] < WG_C(0.0));
}

/* A root between two points of other signs: these become its neighbours. */
static inline void WG_NAME(wg_crossing_narrow)(struct WG_NAME(wg_crossing_search) * search, struct WG_NAME(wg_crossing_point) * low,
                                               struct WG_NAME(wg_crossing_point) * high, int which) {
    int turn;
    for (turn = 0; turn < WG_CROSSINGS_HALVINGS; ++turn) {
        const struct WG_NAME(wg_crossing_point) *near = WG_NAME(wg_crossing_nearer)(low, high, which);
        const WG_REAL middle = WG_C(0.5) * (low->drive + high->drive), newton = near->drive - near->value[which] / near->slope[which];
        const int inside = turn % 3 != 2 && newton > low->drive && newton < high->drive;
        struct WG_NAME(wg_crossing_point) point;
        if (!(middle > low->drive && middle < high->drive) || (which == WG_CROSSINGS_LEFT && (near->value[which] == WG_C(0.0) || newton == near->drive))) {
            break;
        }
        point = WG_NAME(wg_crossing_at)(search, inside ? newton : middle);
        if (which == WG_CROSSINGS_LEFT ? !point.there : !point.moves) {
            break;
        }
        if (WG_NAME(wg_crossing_between)(low, &point, which)) {
            *high = point;
        } else {
            *low = point;
        }
    }
}

/* The root between two points of other signs. */
static inline void WG_NAME(wg_crossing_root)(struct WG_NAME(wg_crossing_search) * search, struct WG_NAME(wg_crossing_point) low,
                                             struct WG_NAME(wg_crossing_point) high) {
    WG_NAME(wg_crossing_narrow)(search, &low, &high, WG_CROSSINGS_LEFT);
    WG_NAME(wg_crossing_keep)(search, *WG_NAME(wg_crossing_nearer)(&low, &high, WG_CROSSINGS_LEFT), WG_CROSSINGS_CROSSED);
}

/* Whether there may be a 0 between two points of one sign: the first leads to it, the second away from it, and fast enough. */
static inline int WG_NAME(wg_crossing_turns)(const struct WG_NAME(wg_crossing_point) * low, const struct WG_NAME(wg_crossing_point) * high,
                                             int which) {
    const WG_REAL width = WG_C(4.0) * (high->drive - low->drive), a = low->value[which], b = high->value[which];
    const WG_REAL slopes[2] = {low->slope[which], high->slope[which]};
    const int slow = WG_ABS(a) > width * WG_ABS(slopes[0]) && WG_ABS(b) > width * WG_ABS(slopes[1]);
    return a * slopes[0] <= WG_C(0.0) && b * slopes[1] >= WG_C(0.0) && !slow;
}

/* A point of the other sign between two of one sign, else the one that is nearest to 0: whether there is one. */
static inline int WG_NAME(wg_crossing_turn)(struct WG_NAME(wg_crossing_search) * search, struct WG_NAME(wg_crossing_point) low,
                                            struct WG_NAME(wg_crossing_point) high, int which, struct WG_NAME(wg_crossing_point) * found) {
    int turn;
    for (turn = 0; turn < WG_CROSSINGS_HALVINGS; ++turn) {
        const WG_REAL middle = WG_C(0.5) * (low.drive + high.drive);
        struct WG_NAME(wg_crossing_point) point;
        if (!(middle > low.drive && middle < high.drive) || !WG_NAME(wg_crossing_turns)(&low, &high, which)) {
            break;
        }
        point = WG_NAME(wg_crossing_at)(search, middle);
        if (which == WG_CROSSINGS_LEFT ? !point.there : !point.moves) {
            break;
        }
        if (WG_NAME(wg_crossing_between)(&low, &point, which)) {
            *found = point;
            return 1;
        }
        if (point.value[which] * point.slope[which] < WG_C(0.0)) {
            low = point;
        } else {
            high = point;
        }
    }
    *found = *WG_NAME(wg_crossing_nearer)(&low, &high, which);
    return 0;
}

/* Roots between two points between which the function turns round once at most. */
static inline void WG_NAME(wg_crossing_piece)(struct WG_NAME(wg_crossing_search) * search, const struct WG_NAME(wg_crossing_point) * low,
                                              const struct WG_NAME(wg_crossing_point) * high) {
    struct WG_NAME(wg_crossing_point) middle;
    if (WG_NAME(wg_crossing_between)(low, high, WG_CROSSINGS_LEFT)) {
        WG_NAME(wg_crossing_root)(search, *low, *high);
    } else if (WG_NAME(wg_crossing_turns)(low, high, WG_CROSSINGS_LEFT)) {
        if (WG_NAME(wg_crossing_turn)(search, *low, *high, WG_CROSSINGS_LEFT, &middle)) {
            WG_NAME(wg_crossing_root)(search, *low, middle);
            WG_NAME(wg_crossing_root)(search, middle, *high);
        } else {
            WG_NAME(wg_crossing_keep_end)(search, &middle);
        }
    }
}

/* Roots between two points: in two pieces where the slopes tell that the function turns round twice. */
static inline void WG_NAME(wg_crossing_pieces)(struct WG_NAME(wg_crossing_search) * search, const struct WG_NAME(wg_crossing_point) * low,
                                               const struct WG_NAME(wg_crossing_point) * high) {
    const WG_REAL rise = high->value[WG_CROSSINGS_LEFT] - low->value[WG_CROSSINGS_LEFT], slope = low->slope[WG_CROSSINGS_LEFT];
    if (slope * high->slope[WG_CROSSINGS_LEFT] > WG_C(0.0) && rise * slope < WG_C(0.0)) {
        const struct WG_NAME(wg_crossing_point) middle = WG_NAME(wg_crossing_at)(search, WG_C(0.5) * (low->drive + high->drive));
        if (middle.there) {
            WG_NAME(wg_crossing_piece)(search, low, &middle);
            WG_NAME(wg_crossing_piece)(search, &middle, high);
            return;
        }
    }
    WG_NAME(wg_crossing_piece)(search, low, high);
}

/* Roots between a point and an end, of the side or of all: in parts that become narrower as the function, a root of the way to the end, becomes
 * steeper. */
static inline void WG_NAME(wg_crossing_to_end)(struct WG_NAME(wg_crossing_search) * search, struct WG_NAME(wg_crossing_point) from,
                                               const struct WG_NAME(wg_crossing_point) * end) {
    const WG_REAL way = end->drive - from.drive;
    int part;
    for (part = WG_CROSSINGS_PARTS - 1; part >= 0; --part) {
        const WG_REAL rest = (WG_REAL)part / (WG_REAL)WG_CROSSINGS_PARTS;
        const struct WG_NAME(wg_crossing_point) next = part ? WG_NAME(wg_crossing_at)(search, end->drive - rest * rest * way) : *end;
        if (!from.there || !next.there) {
            return;
        }
        WG_NAME(wg_crossing_pieces)(search, way > WG_C(0.0) ? &from : &next, way > WG_C(0.0) ? &next : &from);
        from = next;
    }
    WG_NAME(wg_crossing_keep_end)(search, end);
}

/* Roots between two points of which one has a negative margin: up to where the margin is 0. */
static inline void WG_NAME(wg_crossing_edge)(struct WG_NAME(wg_crossing_search) * search, const struct WG_NAME(wg_crossing_point) * low,
                                             const struct WG_NAME(wg_crossing_point) * high) {
    struct WG_NAME(wg_crossing_point) before = *low, behind = *high;
    WG_NAME(wg_crossing_narrow)(search, &before, &behind, WG_CROSSINGS_MARGIN);
    if (low->value[WG_CROSSINGS_MARGIN] >= WG_C(0.0)) {
        WG_NAME(wg_crossing_to_end)(search, *low, &before);
    } else {
        WG_NAME(wg_crossing_to_end)(search, *high, &behind);
    }
}

/* Roots between two points at which something moves. */
static inline void WG_NAME(wg_crossing_stretch)(struct WG_NAME(wg_crossing_search) * search, const struct WG_NAME(wg_crossing_point) * low,
                                                const struct WG_NAME(wg_crossing_point) * high) {
    struct WG_NAME(wg_crossing_point) middle;
    if (WG_NAME(wg_crossing_between)(low, high, WG_CROSSINGS_MARGIN)) {
        WG_NAME(wg_crossing_edge)(search, low, high);
    } else if (WG_NAME(wg_crossing_turns)(low, high, WG_CROSSINGS_MARGIN) &&
               WG_NAME(wg_crossing_turn)(search, *low, *high, WG_CROSSINGS_MARGIN, &middle)) {
        WG_NAME(wg_crossing_edge)(search, low, &middle);
        WG_NAME(wg_crossing_edge)(search, &middle, high);
    } else if (low->there && high->there) {
        WG_NAME(wg_crossing_pieces)(search, low, high);
    }
}

#undef WG_CROSSINGS_MET
#undef WG_CROSSINGS_CROSSED
#undef WG_CROSSINGS_SAME
#endif
