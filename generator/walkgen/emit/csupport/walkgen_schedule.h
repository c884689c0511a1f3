/* walkgen_schedule.h: when legs lift and are placed in a list of events, and where feet are meanwhile; walkgen_math.h explains the macros.
 *
 * Leg i's events are times[first[i]], ..., times[first[i + 1] - 1], in order; each changes its state, which is lifted[i] (1 in transfer) before
 * the first one. What the last one leaves lasts for ever. The state at the time of an event is the state after it. first and lifted are whole
 * numbers. Searches halve the list, so no call takes more than k log2(n) steps.
 */
#include "walkgen_gait.h"
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SCHEDULE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SCHEDULE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SCHEDULE_F64
#else
#define WALKGEN_SCHEDULE_F32
#endif

/* How many of a leg's events are at t or before; 0 where t is NaN. */
static inline int32_t WG_NAME(wg_schedule_passed)(const WG_REAL *times, const WG_REAL *first, int32_t leg, WG_REAL t) {
    int32_t low = (int32_t)first[leg], high = (int32_t)first[leg + 1];
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (times[middle] <= t) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low - (int32_t)first[leg];
}

/* Times of a leg's last event up to t and next one after it; NaN where there is none, and where t is not finite. */
static inline void WG_NAME(wg_schedule_around)(const WG_REAL *times, const WG_REAL *first, int32_t leg, WG_REAL t, WG_REAL *last,
                                               WG_REAL *next) {
    const int32_t from = (int32_t)first[leg], count = (int32_t)first[leg + 1] - from;
    const int32_t passed = WG_NAME(wg_schedule_passed)(times, first, leg, t);
    *last = isfinite(t) && passed > 0 ? times[from + passed - 1] : WG_NAN;
    *next = isfinite(t) && passed < count ? times[from + passed] : WG_NAN;
}

/* 0 supports, 1 in transfer, -1 where t is not finite. */
static inline int32_t WG_NAME(wg_schedule_state)(const WG_REAL *times, const WG_REAL *first, const WG_REAL *lifted, int32_t leg, WG_REAL t) {
    return isfinite(t) ? ((int32_t)lifted[leg] + WG_NAME(wg_schedule_passed)(times, first, leg, t)) % 2 : -1;
}

/* States [k]. */
static inline void WG_NAME(wg_schedule_states)(const WG_REAL *WG_RESTRICT times, const WG_REAL *WG_RESTRICT first,
                                               const WG_REAL *WG_RESTRICT lifted, int32_t k, WG_REAL t, int32_t *WG_RESTRICT state) {
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        state[leg] = WG_NAME(wg_schedule_state)(times, first, lifted, leg, t);
    }
}

/* The share of its support or transfer that each leg has behind it [k], in [0, 1); NaN where that has no start or no end. */
static inline void WG_NAME(wg_schedule_phase)(const WG_REAL *WG_RESTRICT times, const WG_REAL *WG_RESTRICT first, int32_t k, WG_REAL t,
                                              WG_REAL *WG_RESTRICT u) {
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        WG_REAL last, next;
        WG_NAME(wg_schedule_around)(times, first, leg, t, &last, &next);
        u[leg] = (t - last) / (next - last);
    }
}

/* The first time after t at which legs change, and which do [k]: 1 lifted, -1 placed, 0 neither. NaN and zeros after the last event, and where
 * t is not finite. */
static inline void WG_NAME(wg_schedule_next_event)(const WG_REAL *WG_RESTRICT times, const WG_REAL *WG_RESTRICT first,
                                                   const WG_REAL *WG_RESTRICT lifted, int32_t k, WG_REAL t, WG_REAL *WG_RESTRICT t_next,
                                                   int32_t *WG_RESTRICT change) {
    WG_REAL nearest = WG_NAN;
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        WG_REAL last, next;
        WG_NAME(wg_schedule_around)(times, first, leg, t, &last, &next);
        nearest = nearest <= next || !isfinite(next) ? nearest : next;
    }
    *t_next = nearest;
    for (leg = 0; leg < k; ++leg) {
        const int32_t after = WG_NAME(wg_schedule_state)(times, first, lifted, leg, nearest);
        change[leg] = after < 0 ? 0 : after - WG_NAME(wg_schedule_state)(times, first, lifted, leg, t);
    }
}

/* Feet that stand at `start` [k,3] and, in transfer, go to `end` [k,3]: p, v, a [k,3], by wg_gait_step. NaN for a transfer that has no start or no
 * end, and where t is not finite. */
static inline void WG_NAME(wg_schedule_transfers)(const WG_REAL *WG_RESTRICT times, const WG_REAL *WG_RESTRICT first,
                                                  const WG_REAL *WG_RESTRICT lifted, int32_t k, WG_REAL lift, WG_REAL t,
                                                  const WG_REAL *WG_RESTRICT start, const WG_REAL *WG_RESTRICT end, WG_REAL *WG_RESTRICT p,
                                                  WG_REAL *WG_RESTRICT v, WG_REAL *WG_RESTRICT a) {
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        const int stands = WG_NAME(wg_schedule_state)(times, first, lifted, leg, t) == 0;
        const WG_REAL *from = start + 3 * leg, *to = stands ? from : end + 3 * leg;
        WG_REAL last, next, share, rate;
        WG_NAME(wg_schedule_around)(times, first, leg, t, &last, &next);
        share = stands ? WG_C(0.0) : (t - last) / (next - last);
        rate = stands ? WG_C(0.0) : WG_C(1.0) / (next - last);
        WG_NAME(wg_gait_step)(share, rate, lift, from, to, p + 3 * leg, v + 3 * leg, a + 3 * leg);
    }
}

#endif
