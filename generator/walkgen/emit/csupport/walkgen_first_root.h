/* walkgen_first_root.h: the first root of a function from one end of an interval on, before it turns round; walkgen_math.h explains the
 * macros.
 *
 * Newton's method inside a bracket: its lower end lies before the root, where the function still tends to 0; its upper end lies behind the
 * root, or where the function has turned round. Where a step leaves the bracket, and every eighth time, the bracket is halved.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_FIRST_ROOT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_FIRST_ROOT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_FIRST_ROOT_F64
#define WG_ROOT_NOTHING WG_C(1e-12)
#else
#define WALKGEN_FIRST_ROOT_F32
#define WG_ROOT_NOTHING WG_C(1e-5)
#endif
#ifndef WG_ROOT_GIVEN
#define WG_ROOT_GIVEN 7
#define WG_ROOT_TURNS 120
#endif

/* Of a point, which is the unknown and what is given: the function, its slope by the unknown, and the size of what it is a sum of. */
typedef void (*WG_NAME(wg_residual))(const WG_REAL *point, WG_REAL residual[3], const void *data);

/* The function at one place; `ahead` is positive before the root, where the function's sign is that at the start. */
struct WG_NAME(wg_root_place) {
    WG_REAL at, value, slope;
    int ahead, falling, close;
};

/* What is searched: the function, the point at which it was asked last, the sign at the start. */
struct WG_NAME(wg_root_search) {
    WG_NAME(wg_residual) residual;
    const void *data;
    WG_REAL point[WG_ROOT_GIVEN + 1], sign;
};

static inline struct WG_NAME(wg_root_place) WG_NAME(wg_root_at)(struct WG_NAME(wg_root_search) * search, WG_REAL at) {
    struct WG_NAME(wg_root_place) place;
    WG_REAL residual[3];
    search->point[0] = at;
    search->residual(search->point, residual, search->data);
    place.at = at;
    place.value = residual[0];
    place.slope = residual[1];
    place.ahead = search->sign * residual[0] > WG_C(0.0);
    place.falling = search->sign * residual[1] < WG_C(0.0);
    place.close = WG_ABS(residual[0]) <= WG_ROOT_NOTHING * residual[2];
    return place;
}

/* From the start, whose value is not nothing, to the root. */
static inline int32_t WG_NAME(wg_root_search_from)(struct WG_NAME(wg_root_search) * search, struct WG_NAME(wg_root_place) here, WG_REAL high,
                                                   WG_REAL *root) {
    const WG_REAL low = here.at, least = WG_C(4.0) * WG_EPSILON * (WG_ABS(low) + WG_ABS(high));
    WG_REAL before = low, behind = high;
    int crossed = 0, turn;
    for (turn = 0; turn < WG_ROOT_TURNS; ++turn) {
        const WG_REAL step = here.value / here.slope, newton = here.at - step;
        const int beyond = !crossed && behind == high && newton >= high;
        WG_REAL next = turn % 8 != 7 && newton > before && newton < behind ? newton : WG_C(0.5) * (before + behind);
        if (turn && WG_ABS(step) <= least && (here.falling || here.close)) {
            *root = WG_MIN(WG_MAX(newton, low), high);
            return WALKGEN_OK;
        }
        if (behind - before <= least) {
            *root = here.at;
            return crossed || here.close ? WALKGEN_OK : here.at > low ? WALKGEN_SINGULAR : WALKGEN_UNREACHABLE;
        }
        next = beyond ? high : next;
        here = WG_NAME(wg_root_at)(search, next);
        if (here.ahead && here.falling) {
            if (!(next < high)) {
                *root = high;
                return here.close ? WALKGEN_OK : WALKGEN_UNREACHABLE;
            }
            before = next;
        } else {
            behind = next;
            crossed = !here.ahead;
        }
    }
    *root = here.at;
    return WALKGEN_NO_CONVERGENCE;
}

/* The first root in [bounds[0], bounds[1]] from the lower end on, before the function turns round.
 *
 * given        how many numbers there are besides the unknown, at most WG_ROOT_GIVEN
 * z            [given] these
 * bounds       [2] of the unknown
 * root         where the status is OK, else NaN
 * status       OK; UNREACHABLE: the function leads away from 0 at the start, or is not 0 before the end; SINGULAR: it turns round before 0;
 *              NO_CONVERGENCE; BAD_INPUT: something is not finite, or bounds are crossed
 */
static inline void WG_NAME(wg_first_root)(int32_t given, const WG_REAL *z, const WG_REAL bounds[2], WG_NAME(wg_residual) residual,
                                          const void *data, WG_REAL *root, int32_t *status) {
    struct WG_NAME(wg_root_search) search;
    struct WG_NAME(wg_root_place) start;
    WG_REAL found = WG_NAN;
    int32_t i;
    search.residual = residual;
    search.data = data;
    search.sign = WG_C(1.0);
    *root = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    if (!(given >= 0 && given <= WG_ROOT_GIVEN && bounds[0] < bounds[1] && bounds[1] - bounds[0] <= WG_HUGE)) {
        return;
    }
    for (i = 0; i < given; ++i) {
        search.point[i + 1] = z[i];
    }
    start = WG_NAME(wg_root_at)(&search, bounds[0]);
    if (!(WG_ABS(start.value) <= WG_HUGE && WG_ABS(start.slope) <= WG_HUGE)) {
        return;
    }
    if (start.close) {
        *root = bounds[0];
        *status = WALKGEN_OK;
        return;
    }
    search.sign = start.value > WG_C(0.0) ? WG_C(1.0) : -WG_C(1.0);
    start.ahead = 1;
    start.falling = search.sign * start.slope < WG_C(0.0);
    *status = WALKGEN_UNREACHABLE;
    if (start.falling || start.slope == WG_C(0.0)) {
        *status = WG_NAME(wg_root_search_from)(&search, start, bounds[1], &found);
        *root = *status == WALKGEN_OK ? found : WG_NAN;
    }
}

#undef WG_ROOT_NOTHING
#endif
