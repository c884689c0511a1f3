/* walkgen_curve.h: where a curve of one drive meets a point, or comes closest to it; walkgen_math.h explains the macros.
 *
 * The squared distance is looked at for WG_CURVE_SAMPLES values of the drive. Between two of them where its slope turns positive is a least one,
 * found by Gauss's and Newton's steps inside a bracket that shrinks; where the curve ends, because a linkage no longer assembles, the end is
 * found by bisection. A sample that is as near to the point as the curve goes on in a step is tried without a bracket: the curve may turn round
 * there.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CURVE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CURVE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CURVE_F64
#define WG_CURVE_MET WG_C(1e-12)
#define WG_CURVE_SAME WG_C(1e-9)
#else
#define WALKGEN_CURVE_F32
#define WG_CURVE_MET WG_C(1e-5)
#define WG_CURVE_SAME WG_C(1e-4)
#endif
#ifndef WG_CURVE_SAMPLES
#define WG_CURVE_SAMPLES 256
#define WG_CURVE_COARSE 8 /* every eighth sample tells the size of the curve */
#define WG_CURVE_ROOTS 8
#define WG_CURVE_HALVINGS 100
#define WG_CURVE_STEPS 12
#endif

/* A point of the curve and its slopes by the drive: NaN where there is none. */
typedef void (*WG_NAME(wg_curve))(const WG_REAL drive[1], WG_REAL profile[6], const void *data);

/* At one drive: the squared distance from the aim, half its slope, the squared speed, the sizes of both; `there` where the curve is. */
struct WG_NAME(wg_curve_point) {
    WG_REAL drive, square, slope, speed, size;
    int there;
};

/* The curve, the aim, their size, how far apart the samples are, whether the drive turns round, and what has been found. */
struct WG_NAME(wg_curve_search) {
    WG_NAME(wg_curve) curve;
    const void *data;
    const WG_REAL *aim;
    WG_REAL size, step, roots[WG_CURVE_ROOTS];
    struct WG_NAME(wg_curve_point) best;
    int closed, count;
};

/* The point at a drive. */
static inline struct WG_NAME(wg_curve_point) WG_NAME(wg_curve_at)(const struct WG_NAME(wg_curve_search) * search, WG_REAL drive) {
    struct WG_NAME(wg_curve_point) point = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), 0};
    WG_REAL profile[6];
    int i;
    search->curve(&drive, profile, search->data);
    point.drive = drive;
    for (i = 0; i < 3; ++i) {
        const WG_REAL gap = profile[i] - search->aim[i], along = profile[3 + i];
        point.square += gap * gap;
        point.slope += gap * along;
        point.speed += along * along;
        point.size += WG_ABS(profile[i]) + WG_ABS(search->aim[i]);
    }
    point.there = point.square <= WG_HUGE && WG_ABS(point.slope) <= WG_HUGE && point.speed <= WG_HUGE;
    return point;
}

/* Whether the curve meets the aim there. */
static inline int WG_NAME(wg_curve_meets)(const struct WG_NAME(wg_curve_search) * search, const struct WG_NAME(wg_curve_point) * point) {
    const WG_REAL least = WG_CURVE_MET * WG_MAX(search->size, point->size);
    return point->there && point->square <= least * least;
}

/* The drive of a closed curve in (-pi, pi]. */
static inline WG_REAL WG_NAME(wg_curve_wrapped)(const struct WG_NAME(wg_curve_search) * search, WG_REAL drive) {
    return search->closed && drive > WG_PI ? drive - WG_C(2.0) * WG_PI : drive;
}

/* Keep a point: the nearest of all, and every one that meets the aim, in order of the drives, the first WG_CURVE_ROOTS of them. */
static inline void WG_NAME(wg_curve_keep)(struct WG_NAME(wg_curve_search) * search, const struct WG_NAME(wg_curve_point) * point) {
    const WG_REAL drive = WG_NAME(wg_curve_wrapped)(search, point->drive), turn = search->closed ? WG_C(2.0) * WG_PI : WG_C(0.0);
    int i, place;
    if (point->there && (!search->best.there || point->square < search->best.square)) {
        search->best = *point;
    }
    if (!WG_NAME(wg_curve_meets)(search, point)) {
        return;
    }
    for (i = 0; i < search->count; ++i) {
        const WG_REAL away = WG_ABS(search->roots[i] - drive);
        if (WG_MIN(away, WG_ABS(away - turn)) <= WG_CURVE_SAME) {
            return;
        }
    }
    for (place = search->count; place > 0 && search->roots[place - 1] > drive; --place) {
        if (place < WG_CURVE_ROOTS) {
            search->roots[place] = search->roots[place - 1];
        }
    }
    if (place < WG_CURVE_ROOTS) {
        search->roots[place] = drive;
        search->count += search->count < WG_CURVE_ROOTS;
    }
}

/* The nearest point between two where the distance first falls and then grows. */
static inline struct WG_NAME(wg_curve_point) WG_NAME(wg_curve_narrowed)(const struct WG_NAME(wg_curve_search) * search,
                                                                        struct WG_NAME(wg_curve_point) low,
                                                                        struct WG_NAME(wg_curve_point) high) {
    int turn;
    for (turn = 0; turn < WG_CURVE_HALVINGS; ++turn) {
        const struct WG_NAME(wg_curve_point) near = low.square < high.square ? low : high;
        const WG_REAL middle = WG_C(0.5) * (low.drive + high.drive), newton = near.drive - near.slope / near.speed;
        const int inside = turn % 2 == 0 && newton > low.drive && newton < high.drive;
        const int settled = WG_ABS(newton - near.drive) <= WG_EPSILON * WG_ABS(near.drive);
        struct WG_NAME(wg_curve_point) point;
        if (settled || !(middle > low.drive && middle < high.drive)) {
            break;
        }
        point = WG_NAME(wg_curve_at)(search, inside ? newton : middle);
        if (!point.there) {
            break;
        }
        if (point.slope > WG_C(0.0)) {
            high = point;
        } else {
            low = point;
        }
    }
    return low.square < high.square ? low : high;
}

/* Gauss's and Newton's steps from a point as long as they come nearer. */
static inline struct WG_NAME(wg_curve_point) WG_NAME(wg_curve_polished)(const struct WG_NAME(wg_curve_search) * search,
                                                                        struct WG_NAME(wg_curve_point) point) {
    int turn;
    for (turn = 0; turn < WG_CURVE_STEPS; ++turn) {
        const struct WG_NAME(wg_curve_point) next = WG_NAME(wg_curve_at)(search, point.drive - point.slope / point.speed);
        if (!next.there || !(next.square < point.square)) {
            break;
        }
        point = next;
    }
    return point;
}

/* The last point of the curve between one that is there and one that is not. */
static inline struct WG_NAME(wg_curve_point) WG_NAME(wg_curve_end)(const struct WG_NAME(wg_curve_search) * search,
                                                                   struct WG_NAME(wg_curve_point) there, WG_REAL beyond) {
    int turn;
    for (turn = 0; turn < WG_CURVE_HALVINGS; ++turn) {
        const WG_REAL middle = WG_C(0.5) * (there.drive + beyond);
        const struct WG_NAME(wg_curve_point) point = WG_NAME(wg_curve_at)(search, middle);
        if (middle == there.drive || middle == beyond) {
            break;
        }
        if (point.there) {
            there = point;
        } else {
            beyond = middle;
        }
    }
    return there;
}

/* What lies between two points of the curve. */
static inline void WG_NAME(wg_curve_between)(struct WG_NAME(wg_curve_search) * search, const struct WG_NAME(wg_curve_point) * low,
                                             const struct WG_NAME(wg_curve_point) * high) {
    const struct WG_NAME(wg_curve_point) *near = low->square < high->square ? low : high;
    const WG_REAL reach = WG_C(4.0) * search->step * search->step * WG_MAX(low->speed, high->speed);
    struct WG_NAME(wg_curve_point) found = *near;
    if (low->slope <= WG_C(0.0) && high->slope > WG_C(0.0)) {
        found = WG_NAME(wg_curve_narrowed)(search, *low, *high);
    } else if (near->square <= reach && near->speed > WG_C(0.0)) {
        found = WG_NAME(wg_curve_polished)(search, *near);
        if (!(WG_ABS(found.drive - near->drive) <= search->step)) {
            found = *near;
        }
    }
    WG_NAME(wg_curve_keep)(search, &found);
}

/* One step of the samples, with the ends of the curve in it. */
static inline void WG_NAME(wg_curve_step)(struct WG_NAME(wg_curve_search) * search, const struct WG_NAME(wg_curve_point) * low,
                                          const struct WG_NAME(wg_curve_point) * high) {
    struct WG_NAME(wg_curve_point) end;
    if (low->there && high->there) {
        WG_NAME(wg_curve_between)(search, low, high);
    } else if (low->there) {
        end = WG_NAME(wg_curve_end)(search, *low, high->drive);
        WG_NAME(wg_curve_between)(search, low, &end);
    } else if (high->there) {
        end = WG_NAME(wg_curve_end)(search, *high, low->drive);
        WG_NAME(wg_curve_between)(search, &end, high);
    }
}

/* Drives in order at which a curve meets a point: OK; beyond the last UNREACHABLE with the first again, or with the nearest of all where
 * there is none, NaN where the curve is nowhere; BAD_INPUT with NaN.
 *
 * bounds: the drive's [2]; aim: the point [3]; closed: 1 where the drive is an angle and bounds are a turn apart. */
static inline void WG_NAME(wg_curve_roots)(const WG_REAL bounds[2], const WG_REAL aim[3], WG_NAME(wg_curve) curve, const void *data, int closed,
                                           WG_REAL drives[WG_CURVE_ROOTS], int32_t status[WG_CURVE_ROOTS]) {
    struct WG_NAME(wg_curve_search) search;
    struct WG_NAME(wg_curve_point) first, low, high;
    const WG_REAL width = bounds[1] - bounds[0];
    const int fine = WG_ABS(aim[0]) + WG_ABS(aim[1]) + WG_ABS(aim[2]) <= WG_HUGE && width > WG_C(0.0) && width <= WG_HUGE;
    WG_REAL rest = WG_NAN;
    int i;
    search.curve = curve;
    search.data = data;
    search.aim = aim;
    search.step = width / (WG_REAL)WG_CURVE_SAMPLES;
    search.closed = closed;
    search.count = 0;
    search.size = WG_C(0.0);
    if (fine) {
        for (i = 0; i < WG_CURVE_SAMPLES; i += WG_CURVE_COARSE) {
            low = WG_NAME(wg_curve_at)(&search, bounds[0] + (WG_REAL)i * search.step);
            search.size = low.there ? WG_MAX(search.size, low.size) : search.size;
        }
        first = WG_NAME(wg_curve_at)(&search, bounds[0]);
        search.best = first;
        low = first;
        for (i = 1; i <= WG_CURVE_SAMPLES; ++i) {
            if (closed && i == WG_CURVE_SAMPLES) {
                high = first;
                high.drive = bounds[1];
            } else {
                high = WG_NAME(wg_curve_at)(&search, bounds[0] + (WG_REAL)i * search.step);
            }
            WG_NAME(wg_curve_step)(&search, &low, &high);
            low = high;
        }
        rest = search.count ? search.roots[0] : search.best.there ? WG_NAME(wg_curve_wrapped)(&search, search.best.drive) : WG_NAN;
    }
    for (i = 0; i < WG_CURVE_ROOTS; ++i) {
        drives[i] = i < search.count ? search.roots[i] : rest;
        status[i] = !fine ? WALKGEN_BAD_INPUT : i < search.count ? WALKGEN_OK : WALKGEN_UNREACHABLE;
    }
}

#undef WG_CURVE_MET
#undef WG_CURVE_SAME
#endif
