/* walkgen_shadow_margin.h: how far a point is from the border of a region of walkgen_shadow.h; walkgen_math.h explains the macros. */
#include "walkgen_shadow.h"
#include "walkgen_support.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SHADOW_MARGIN_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SHADOW_MARGIN_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SHADOW_MARGIN_F64
#define WG_SHARP WG_C(1e-11)
#define WG_FAIR WG_C(1e-7)
#define WG_ROUND WG_C(2e-3)
#else
#define WALKGEN_SHADOW_MARGIN_F32
#define WG_SHARP WG_C(1e-5)
#define WG_FAIR WG_C(2e-3)
#define WG_ROUND WG_C(4e-3)
#endif
#ifndef WALKGEN_MAX_PROBES
#define WALKGEN_MAX_PROBES 128
#endif

/* The way from a point out of the polygon of points, a unit vector, and how far that is, negative from outside. */
static inline WG_REAL WG_NAME(wg_shadow_out)(const struct WG_NAME(wg_shadow) * shadow, const WG_REAL from[2], WG_REAL out[2]) {
    WG_REAL least = WG_INFINITY, near = WG_INFINITY, normal[2], back[2], away[2] = {WG_C(0.0), WG_C(0.0)};
    int i;
    out[0] = WG_C(1.0);
    out[1] = WG_C(0.0);
    for (i = 0; i < shadow->count; ++i) {
        const WG_REAL *a = shadow->point[i], *b = shadow->point[(i + 1) % shadow->count];
        const WG_REAL length = WG_NAME(wg_shadow_side)(shadow, i, normal), far = WG_NAME(wg_support_apart)(a, b, from, back);
        const WG_REAL inside = normal[0] * (a[0] - from[0]) + normal[1] * (a[1] - from[1]);
        if (length > WG_SHARP && inside < least) {
            least = inside;
            out[0] = normal[0];
            out[1] = normal[1];
        }
        if (far < near) {
            near = far;
            away[0] = -back[0];
            away[1] = -back[1];
        }
    }
    if (least >= WG_C(0.0) && least <= WG_HUGE) {
        return least;
    }
    if (near > WG_SHARP) {
        out[0] = away[0];
        out[1] = away[1];
    }
    return -near;
}

/* One of the directions known. */
static inline struct WG_NAME(wg_seen) WG_NAME(wg_shadow_known)(const struct WG_NAME(wg_shadow) * shadow, int i) {
    struct WG_NAME(wg_seen) seen;
    seen.direction[0] = shadow->direction[i][0];
    seen.direction[1] = shadow->direction[i][1];
    seen.point[0] = shadow->point[i][0];
    seen.point[1] = shadow->point[i][1];
    seen.reach = shadow->reach[i];
    seen.open = shadow->open[i];
    return seen;
}

/* How far a point is from the line that the region does not cross. */
static inline WG_REAL WG_NAME(wg_seen_bound)(const struct WG_NAME(wg_seen) * seen, const WG_REAL from[2]) {
    return seen->reach - seen->direction[0] * from[0] - seen->direction[1] * from[1];
}

/* The slope of that by the direction's angle. */
static inline WG_REAL WG_NAME(wg_seen_slope)(const struct WG_NAME(wg_seen) * seen, const WG_REAL from[2]) {
    return seen->direction[0] * (seen->point[1] - from[1]) - seen->direction[1] * (seen->point[0] - from[0]);
}

/* The least bound between two directions where bounds fall and rise again, by the normal of their points, into `best`; how many probes of
 * so many it took. */
static inline int WG_NAME(wg_shadow_between)(struct WG_NAME(wg_seen) before, struct WG_NAME(wg_seen) after, const WG_REAL from[2],
                                             int probes, struct WG_NAME(wg_shadow) * shadow, struct WG_NAME(wg_seen) * best) {
    int spent = 0;
    while (spent < probes && WG_NAME(wg_seen_slope)(&before, from) < -WG_FAIR && WG_NAME(wg_seen_slope)(&after, from) > WG_FAIR) {
        struct WG_NAME(wg_seen) found;
        WG_REAL normal[2];
        const WG_REAL length = WG_NAME(wg_shadow_normal)(before.point, after.point, normal);
        const WG_REAL low = normal[0] * (before.point[0] - from[0]) + normal[1] * (before.point[1] - from[1]);
        if (!(length > WG_SHARP && low < WG_NAME(wg_seen_bound)(best, from) - WG_SHARP) ||
            !WG_NAME(wg_shadow_probe)(normal, shadow, &found)) {
            break;
        }
        ++spent;
        *best = WG_NAME(wg_seen_bound)(&found, from) < WG_NAME(wg_seen_bound)(best, from) ? found : *best;
        if (WG_NAME(wg_seen_slope)(&found, from) < WG_C(0.0)) {
            before = found;
        } else {
            after = found;
        }
    }
    return spent;
}

/* The signed distance of a point from the region's border, positive inside, and the way out [2]: the least of reach - u . from over all
 * directions u. The polygon of points proves it to rounding, but where the border is round about the point, as under forces by which
 * feet slip, whatever their direction: there only to 2e-3 of it, though the value is the least that falling and rising bounds lead to, to
 * rounding. Infinite where the way out is open. */
WG_CALLED int32_t WG_NAME(wg_shadow_margin)(const WG_REAL from[2], WG_REAL *margin, WG_REAL out[2], struct WG_NAME(wg_shadow) * shadow) {
    WG_REAL next[2], least = WG_C(0.0);
    struct WG_NAME(wg_seen) best = WG_NAME(wg_shadow_known)(shadow, 0);
    int turn, i, sharp = 0, probes = WALKGEN_MAX_PROBES;
    for (turn = 0; turn <= WALKGEN_MAX_DIRECTIONS; ++turn) {
        least = WG_NAME(wg_shadow_out)(shadow, from, next);
        for (i = 0; i < shadow->count; ++i) {
            const struct WG_NAME(wg_seen) seen = WG_NAME(wg_shadow_known)(shadow, i);
            best = WG_NAME(wg_seen_bound)(&seen, from) < WG_NAME(wg_seen_bound)(&best, from) ? seen : best;
        }
        *margin = WG_NAME(wg_seen_bound)(&best, from);
        sharp = *margin - least <= WG_SHARP * (WG_C(1.0) + WG_ABS(least));
        if (sharp || !WG_NAME(wg_shadow_look)(next, shadow)) {
            break;
        }
    }
    if (!(*margin - least <= WG_FAIR * (WG_C(1.0) + WG_ABS(least)) + WG_ROUND * WG_ABS(*margin))) {
        return WALKGEN_NO_CONVERGENCE;
    }
    for (i = 0; i < shadow->count && !sharp; ++i) {
        probes -= WG_NAME(wg_shadow_between)(WG_NAME(wg_shadow_known)(shadow, i), WG_NAME(wg_shadow_known)(shadow, (i + 1) % shadow->count),
                                             from, probes, shadow, &best);
    }
    out[0] = best.open ? WG_C(0.0) : best.direction[0];
    out[1] = best.open ? WG_C(0.0) : best.direction[1];
    *margin = best.open ? WG_INFINITY : WG_NAME(wg_seen_bound)(&best, from);
    return WALKGEN_OK;
}

#undef WG_SHARP
#undef WG_FAIR
#undef WG_ROUND
#endif
