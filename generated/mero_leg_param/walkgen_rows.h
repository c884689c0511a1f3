/* walkgen_rows.h: one row chosen among all solutions of an inverse: by a seed, or by the joint limits; walkgen_math.h explains the macros.
 *
 * Rows that reach the target (OK, SINGULAR, DUPLICATE) go before rows that do not; BAD_INPUT rows are none. Differences of revolute joints
 * are taken modulo full turns. One pass over the rows, no iteration.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ROWS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ROWS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ROWS_F64
#define WG_LIBM(name) name
#define WG_SLACK WG_C(1e-12)
#else
#define WALKGEN_ROWS_F32
#define WG_LIBM(name) name##f
#define WG_SLACK (WG_C(8.0) * WG_EPSILON)
#endif

/* Number of joints of a sequence: binary digits after the leading 1. */
static inline int WG_NAME(wg_joints_of)(int32_t sequence) {
    int n;
    for (n = 0; sequence >> (n + 1) > 0; ++n) {
    }
    return n;
}

/* A difference of two angles less the nearest number of full turns; the C library's beyond a thousand turns. */
static inline WG_REAL WG_NAME(wg_short_way)(WG_REAL gap) {
    const WG_REAL magic = WG_REAL_BITS == 64 ? WG_C(6755399441055744.0) : WG_C(12582912.0); /* adding it rounds to an integer */
    const WG_REAL turns = (gap * WG_C(0.15915494309189535) + magic) - magic;
    return WG_LIKELY(WG_ABS(gap) < WG_C(6283.0)) ? gap - turns * (WG_C(2.0) * WG_PI) : WG_LIBM(remainder)(gap, WG_C(2.0) * WG_PI);
}

/* 2 for a row that reaches its target, 1 for one that does not, 0 for none. */
static inline int WG_NAME(wg_row_rank)(const WG_REAL *row, int32_t state, int n) {
    int j, finite = state != WALKGEN_BAD_INPUT;
    for (j = 0; j < n; ++j) {
        finite = finite && isfinite(row[j]);
    }
    return finite + (finite && (state == WALKGEN_OK || state == WALKGEN_SINGULAR || state == WALKGEN_DUPLICATE));
}

/* The status of a row that is chosen. */
static inline int32_t WG_NAME(wg_row_status)(int32_t state) { return state == WALKGEN_DUPLICATE ? WALKGEN_OK : state; }

/* NaN and BAD_INPUT. */
static inline void WG_NAME(wg_no_row)(int n, WG_REAL *q, int32_t *status) {
    int j;
    for (j = 0; j < n; ++j) {
        q[j] = WG_NAN;
    }
    *status = WALKGEN_BAD_INPUT;
}

/* The row with the least sum of squared differences to the seed, and its status (OK for DUPLICATE); where none reaches the target, the
 * nearest of the others; BAD_INPUT and NaN where the seed is not finite or there is no row. rows [slots, n], states [slots], seed [n]. */
static inline void WG_NAME(wg_nearest_row)(const WG_REAL *WG_RESTRICT rows, const int32_t *WG_RESTRICT states,
                                           const WG_REAL *WG_RESTRICT seed, int32_t sequence, int32_t slots, WG_REAL *WG_RESTRICT q,
                                           int32_t *WG_RESTRICT status) {
    const int n = WG_NAME(wg_joints_of)(sequence);
    WG_REAL least = WG_C(0.0);
    int i, j, chosen = -1, best = 0, fine = 1;
    for (j = 0; j < n; ++j) {
        fine = fine && isfinite(seed[j]);
    }
    for (i = 0; i < slots && fine; ++i) {
        const int rank = WG_NAME(wg_row_rank)(rows + n * i, states[i], n);
        WG_REAL sum = WG_C(0.0);
        for (j = 0; j < n; ++j) {
            const int slides = (sequence >> (n - 1 - j)) % 2 == 1;
            const WG_REAL gap = rows[n * i + j] - seed[j];
            const WG_REAL short_way = slides ? gap : WG_NAME(wg_short_way)(gap);
            sum += short_way * short_way;
        }
        if (rank > best || (rank == best && rank > 0 && sum < least)) {
            chosen = i;
            best = rank;
            least = sum;
        }
    }
    if (chosen < 0) {
        WG_NAME(wg_no_row)(n, q, status);
        return;
    }
    for (j = 0; j < n; ++j) {
        q[j] = rows[n * chosen + j];
    }
    *status = WG_NAME(wg_row_status)(states[chosen]);
}

/* A joint value, turned fully as often as that brings it nearest the middle of the limits, or into the one there is; then clamped.
 * `excess` is how far it was clamped; `share` its distance from the middle over the half range: pi and 0 where that is not finite, and
 * nothing for a sliding joint. */
static inline WG_REAL WG_NAME(wg_admitted)(int slides, WG_REAL q, WG_REAL low, WG_REAL high, WG_REAL *excess, WG_REAL *share) {
    const WG_REAL turn = WG_C(2.0) * WG_PI, half = WG_C(0.5) * high - WG_C(0.5) * low, middle = low + half;
    const int bounded = isfinite(low) && isfinite(high);
    WG_REAL value = q, inside;
    if (!slides && bounded) {
        value = middle + WG_LIBM(remainder)(q - middle, turn);
    } else if (!slides && q < low) {
        value = q + turn * WG_LIBM(ceil)((low - q) / turn);
    } else if (!slides && q > high) {
        value = q - turn * WG_LIBM(ceil)((q - high) / turn);
    }
    inside = WG_MIN(WG_MAX(value, low), high);
    *excess = WG_ABS(value - inside);
    if (*excess <= WG_SLACK * (slides ? WG_ABS(inside) : WG_MAX(WG_C(1.0), WG_ABS(inside)))) {
        *excess = WG_C(0.0);
    }
    *share = bounded ? (half > WG_C(0.0) ? (inside - middle) / half : WG_C(0.0)) : slides ? WG_C(0.0) : inside / WG_PI;
    return inside;
}

/* How far a row is from fitting the limits (sum of squares), and how far from their middle. */
static inline WG_REAL WG_NAME(wg_row_excess)(const WG_REAL *row, const WG_REAL *limits, int32_t sequence, WG_REAL *distance) {
    const int n = WG_NAME(wg_joints_of)(sequence);
    WG_REAL excess, share, sum = WG_C(0.0);
    int j;
    *distance = WG_C(0.0);
    for (j = 0; j < n; ++j) {
        (void)WG_NAME(wg_admitted)((sequence >> (n - 1 - j)) % 2 == 1, row[j], limits[2 * j], limits[2 * j + 1], &excess, &share);
        sum += excess * excess;
        sum = excess > WG_C(0.0) ? WG_MAX(sum, WG_TINY) : sum;
        *distance += share * share;
    }
    return sum;
}

/* Of the rows that reach the target and, full turns added, fit the limits: the one nearest the middle of the limits (distances over half
 * ranges; over pi for a revolute joint without both limits), within the limits, with its status (OK for DUPLICATE). Where there is none:
 * UNREACHABLE and the row that comes nearest to that, clamped. BAD_INPUT and NaN where there is no row or the limits are none.
 * rows [slots, n], states [slots], limits [n, 2], infinite where there is none. */
static inline void WG_NAME(wg_admissible_row)(const WG_REAL *WG_RESTRICT rows, const int32_t *WG_RESTRICT states,
                                              const WG_REAL *WG_RESTRICT limits, int32_t sequence, int32_t slots, WG_REAL *WG_RESTRICT q,
                                              int32_t *WG_RESTRICT status) {
    const int n = WG_NAME(wg_joints_of)(sequence);
    WG_REAL excess, distance, least_excess = WG_C(0.0), least = WG_C(0.0), unused;
    int i, j, chosen = -1, best = 0, fine = 1;
    for (j = 0; j < n; ++j) {
        fine = fine && limits[2 * j] <= limits[2 * j + 1] && limits[2 * j] <= WG_HUGE && limits[2 * j + 1] >= -WG_HUGE;
    }
    for (i = 0; i < slots && fine; ++i) {
        const int rank = WG_NAME(wg_row_rank)(rows + n * i, states[i], n);
        const int same = rank == best && rank > 0;
        excess = WG_NAME(wg_row_excess)(rows + n * i, limits, sequence, &distance);
        if (rank > best || (same && (excess < least_excess || (excess == least_excess && distance < least)))) {
            chosen = i;
            best = rank;
            least_excess = excess;
            least = distance;
        }
    }
    if (chosen < 0) {
        WG_NAME(wg_no_row)(n, q, status);
        return;
    }
    for (j = 0; j < n; ++j) {
        const int slides = (sequence >> (n - 1 - j)) % 2 == 1;
        q[j] = WG_NAME(wg_admitted)(slides, rows[n * chosen + j], limits[2 * j], limits[2 * j + 1], &excess, &unused);
    }
    *status = WALKGEN_UNREACHABLE;
    if (best == 2 && !(least_excess > WG_C(0.0))) {
        *status = WG_NAME(wg_row_status)(states[chosen]);
    }
}

#undef WG_SLACK
#undef WG_LIBM
#endif
