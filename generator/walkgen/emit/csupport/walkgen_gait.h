/* walkgen_gait.h: when legs lift and are placed, and where feet are meanwhile; walkgen_math.h explains the macros.
 *
 * duty [k] and phase [k]: leg i is placed at phase[i] and lifted at phase[i] + duty[i], in periods. Its local phase is u = F(t/T - phase), F the
 * fractional part; it supports (state 0) while u < duty, else it is in transfer (state 1). Events closer than WG_GAIT_SLACK roundings of t/T
 * have happened, so the state at the time of an event is the state after it. Whatever t is: no loops but over the legs.
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_GAIT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_GAIT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_GAIT_F64
#else
#define WALKGEN_GAIT_F32
#endif
#define WG_GAIT_SLACK WG_C(4.0)

/* Local phase of a leg at x = t/T; NaN where that is not finite. */
static inline WG_REAL WG_NAME(wg_gait_local)(WG_REAL duty, WG_REAL phase, WG_REAL x) {
    const WG_REAL y = x - phase;
    const WG_REAL u = y - (WG_REAL)floor((double)y), slack = WG_GAIT_SLACK * WG_EPSILON * (WG_C(1.0) + WG_ABS(x));
    if (!isfinite(y)) {
        return WG_NAN;
    }
    return u >= WG_C(1.0) - slack ? WG_C(0.0) : u < duty && u >= duty - slack ? duty : u;
}

/* 0 supports, 1 in transfer, -1 where the phase is NaN. */
static inline int32_t WG_NAME(wg_gait_state)(WG_REAL duty, WG_REAL u) { return u < duty ? 0 : u >= duty ? 1 : -1; }

/* Local phases [k] in [0, 1). */
static inline void WG_NAME(wg_gait_phase)(const WG_REAL *WG_RESTRICT duty, const WG_REAL *WG_RESTRICT phase, int32_t k, WG_REAL period,
                                          WG_REAL t, WG_REAL *WG_RESTRICT u) {
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        u[leg] = WG_NAME(wg_gait_local)(duty[leg], phase[leg], t / period);
    }
}

/* States [k]. */
static inline void WG_NAME(wg_gait_states)(const WG_REAL *WG_RESTRICT duty, const WG_REAL *WG_RESTRICT phase, int32_t k, WG_REAL period,
                                           WG_REAL t, int32_t *WG_RESTRICT state) {
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        state[leg] = WG_NAME(wg_gait_state)(duty[leg], WG_NAME(wg_gait_local)(duty[leg], phase[leg], t / period));
    }
}

/* The first time after t at which a leg is lifted or placed, and what changes [k]: 1 lifted, -1 placed, 0 neither. NaN and zeros where t is
 * not finite. */
static inline void WG_NAME(wg_gait_next_event)(const WG_REAL *WG_RESTRICT duty, const WG_REAL *WG_RESTRICT phase, int32_t k, WG_REAL period,
                                               WG_REAL t, WG_REAL *WG_RESTRICT t_next, int32_t *WG_RESTRICT change) {
    WG_REAL rest = WG_C(1.0);
    int32_t leg, known = 1;
    for (leg = 0; leg < k; ++leg) {
        const WG_REAL u = WG_NAME(wg_gait_local)(duty[leg], phase[leg], t / period);
        const WG_REAL left = (u < duty[leg] ? duty[leg] : WG_C(1.0)) - u;
        known = known && isfinite(u);
        rest = left < rest ? left : rest;
    }
    *t_next = known ? t + rest * period : WG_NAN;
    for (leg = 0; leg < k; ++leg) {
        const WG_REAL before = WG_NAME(wg_gait_local)(duty[leg], phase[leg], t / period);
        const WG_REAL after = WG_NAME(wg_gait_local)(duty[leg], phase[leg], *t_next / period);
        change[leg] = WG_NAME(wg_gait_state)(duty[leg], after) - WG_NAME(wg_gait_state)(duty[leg], before);
    }
}

/* A foot at s in [0, 1] of its way from `start` to `end`, both at rest, which lasts 1/rate: 10 s^3 - 15 s^4 + 6 s^5 of the way, raised by
 * 64 s^3 (1 - s)^3, so that it is `lift` over the higher end half way. */
static inline void WG_NAME(wg_gait_step)(WG_REAL s, WG_REAL rate, WG_REAL lift, const WG_REAL *start, const WG_REAL *end, WG_REAL *p,
                                         WG_REAL *v, WG_REAL *a) {
    const WG_REAL r = WG_C(1.0) - s, sr = s * r;
    const WG_REAL share = s * s * s * (WG_C(10.0) - s * (WG_C(15.0) - WG_C(6.0) * s));
    const WG_REAL share_v = WG_C(30.0) * sr * sr * rate, share_a = WG_C(60.0) * sr * (r - s) * rate * rate;
    const WG_REAL top = lift + WG_C(0.5) * WG_ABS(end[2] - start[2]);
    int axis;
    for (axis = 0; axis < 3; ++axis) {
        const WG_REAL way = end[axis] - start[axis];
        p[axis] = start[axis] + way * share;
        v[axis] = way * share_v;
        a[axis] = way * share_a;
    }
    p[2] += top * WG_C(64.0) * sr * sr * sr;
    v[2] += top * WG_C(192.0) * sr * sr * (r - s) * rate;
    a[2] += top * WG_C(384.0) * sr * (WG_C(1.0) - WG_C(5.0) * sr) * rate * rate;
}

/* One leg at its local phase: at rest at `start` in support, else on its way to `end`. */
static inline void WG_NAME(wg_gait_foot)(WG_REAL u, WG_REAL duty, WG_REAL period, WG_REAL lift, const WG_REAL *start, const WG_REAL *end,
                                         WG_REAL *p, WG_REAL *v, WG_REAL *a) {
    const WG_REAL air = WG_C(1.0) - duty;
    if (u < duty) {
        int axis;
        for (axis = 0; axis < 3; ++axis) {
            p[axis] = start[axis];
            v[axis] = a[axis] = WG_C(0.0);
        }
        return;
    }
    WG_NAME(wg_gait_step)((u - duty) / air, WG_C(1.0) / (air * period), lift, start, end, p, v, a);
}

/* Feet that stand at `start` [k,3] and, in transfer, go to `end` [k,3]: p, v, a [k,3]. NaN in transfer where t is not finite. */
static inline void WG_NAME(wg_gait_transfers)(const WG_REAL *WG_RESTRICT duty, const WG_REAL *WG_RESTRICT phase, int32_t k, WG_REAL period,
                                              WG_REAL lift, WG_REAL t, const WG_REAL *WG_RESTRICT start, const WG_REAL *WG_RESTRICT end,
                                              WG_REAL *WG_RESTRICT p, WG_REAL *WG_RESTRICT v, WG_REAL *WG_RESTRICT a) {
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        const WG_REAL u = WG_NAME(wg_gait_local)(duty[leg], phase[leg], t / period);
        WG_NAME(wg_gait_foot)(u, duty[leg], period, lift, start + 3 * leg, end + 3 * leg, p + 3 * leg, v + 3 * leg, a + 3 * leg);
    }
}

/* A point at rest on the ground as the platform with this twist sees it `ago` after it was at `point`. */
static inline void WG_NAME(wg_gait_seen)(const WG_REAL *point, const WG_REAL *twist, WG_REAL ago, WG_REAL seen[3]) {
    const WG_REAL angle = twist[2] * ago, sine = WG_SIN(angle), cosine = WG_COS(angle);
    const int turns = angle < WG_C(0.0) || angle > WG_C(0.0);
    const WG_REAL along = turns ? sine / angle : WG_C(1.0) + WG_C(0.0) * angle;
    const WG_REAL rise = cosine > WG_C(0.0) ? sine * sine / (WG_C(1.0) + cosine) : WG_C(1.0) - cosine; /* 1 - cos without cancellation */
    const WG_REAL across = turns ? rise / angle : WG_C(0.0);
    const WG_REAL x = point[0] - ago * (along * twist[0] - across * twist[1]);
    const WG_REAL y = point[1] - ago * (across * twist[0] + along * twist[1]);
    seen[0] = cosine * x + sine * y;
    seen[1] = cosine * y - sine * x;
    seen[2] = point[2] + WG_C(0.0) * angle;
}

/* Feet in the frame of a platform that moves steadily over level ground with twist = (velocity along x and y, turning about z): p, v, a [k,3].
 * A foot passes its stance [k,3] in the middle of its support. */
static inline void WG_NAME(wg_gait_targets)(const WG_REAL *WG_RESTRICT duty, const WG_REAL *WG_RESTRICT phase, int32_t k, WG_REAL period,
                                            WG_REAL lift, const WG_REAL *WG_RESTRICT stance, WG_REAL t, const WG_REAL *WG_RESTRICT twist,
                                            WG_REAL *WG_RESTRICT p, WG_REAL *WG_RESTRICT v, WG_REAL *WG_RESTRICT a) {
    int32_t leg;
    for (leg = 0; leg < k; ++leg) {
        const WG_REAL u = WG_NAME(wg_gait_local)(duty[leg], phase[leg], t / period), passed = u - WG_C(0.5) * duty[leg];
        WG_REAL start[3], end[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, *at = p + 3 * leg, *rate = v + 3 * leg, *bend = a + 3 * leg, ground_x, ground_y;
        WG_NAME(wg_gait_seen)(stance + 3 * leg, twist, passed * period, start);
        if (!(u < duty[leg])) {
            WG_NAME(wg_gait_seen)(stance + 3 * leg, twist, (passed - WG_C(1.0)) * period, end);
        }
        WG_NAME(wg_gait_foot)(u, duty[leg], period, lift, start, end, at, rate, bend);
        ground_x = rate[0];
        ground_y = rate[1];
        rate[0] -= twist[0] - twist[2] * at[1];
        rate[1] -= twist[1] + twist[2] * at[0];
        bend[0] += twist[2] * (ground_y + rate[1]);
        bend[1] -= twist[2] * (ground_x + rate[0]);
    }
}

#undef WG_GAIT_SLACK
#endif
