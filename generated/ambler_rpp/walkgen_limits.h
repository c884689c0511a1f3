/* walkgen_limits.h: joint limits and joint values of a chain as they come in and go out; walkgen_math.h explains the macros.
 *
 * Lengths are in the caller's scale outside, in the chain's inside. Angles may turn fully: they do where limits ask for it.
 */
#include "walkgen_boxed.h"
#include "walkgen_inverse_general.h"
#include "walkgen_rows.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_LIMITS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_LIMITS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_LIMITS_F64
#define WG_LIBM(name) name
#else
#define WALKGEN_LIMITS_F32
#define WG_LIBM(name) name##f
#endif

/* An angle less full turns, in (-pi, pi] if the bounds allow that, else nearest the seed between them if they allow that. */
static inline WG_REAL WG_NAME(wg_fitted)(int slides, WG_REAL q, WG_REAL low, WG_REAL high, WG_REAL seed) {
    const WG_REAL turn = WG_C(2.0) * WG_PI, wrapped = WG_NAME(wg_in_range)(slides, slides ? q : WG_LIBM(remainder)(q, turn));
    WG_REAL fitted = seed + WG_LIBM(remainder)(wrapped - seed, turn);
    if (slides || (wrapped >= low && wrapped <= high)) {
        return wrapped;
    }
    if (fitted < low) {
        fitted += turn * WG_LIBM(ceil)((low - fitted) / turn);
    } else if (fitted > high) {
        fitted -= turn * WG_LIBM(ceil)((fitted - high) / turn);
    }
    if (fitted >= low && fitted <= high) {
        return fitted;
    }
    return q >= low && q <= high ? q : wrapped;
}

/* Limits [n, 2] in the arm's scale; whether they are any. */
static inline int WG_NAME(wg_read_limits)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *limits, struct WG_NAME(wg_box) * box) {
    int j, fine = 1;
    for (j = 0; j < arm->n; ++j) {
        const WG_REAL low = limits[2 * j], high = limits[2 * j + 1];
        fine = fine && low <= high && low <= WG_HUGE && high >= -WG_HUGE;
        box->low[j] = arm->slides[j] ? WG_LIBM(ldexp)(low, -arm->size) : low;
        box->high[j] = arm->slides[j] ? WG_LIBM(ldexp)(high, -arm->size) : high;
    }
    return fine;
}

/* Start values in the arm's scale, in the range of angles and of lengths that matter; whether they are numbers. */
static inline int WG_NAME(wg_read_seed)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * limits, const WG_REAL *q,
                                        WG_REAL *seed) {
    const WG_REAL most = WG_C(16.0) * arm->reach;
    int j, fine = 1;
    for (j = 0; j < arm->n; ++j) {
        const WG_REAL slid = WG_MIN(WG_MAX(WG_LIBM(ldexp)(q[j], -arm->size), -most), most);
        fine = fine && isfinite(q[j]);
        seed[j] = arm->slides[j] ? slid : WG_NAME(wg_fitted)(0, q[j], limits->low[j], limits->high[j], WG_C(0.0));
    }
    return fine;
}

/* The limits that hold an angle back: less than a full turn apart. */
static inline int WG_NAME(wg_bounding)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * limits,
                                       struct WG_NAME(wg_box) * box) {
    int j, any = 0;
    for (j = 0; j < arm->n; ++j) {
        const int held = arm->slides[j] || limits->high[j] - limits->low[j] < WG_C(2.0) * WG_PI;
        box->low[j] = held ? limits->low[j] : -WG_INFINITY;
        box->high[j] = held ? limits->high[j] : WG_INFINITY;
        any |= box->low[j] >= -WG_HUGE || box->high[j] <= WG_HUGE;
    }
    return any;
}

/* q and status in the caller's scale. */
static inline void WG_NAME(wg_write_arm)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * limits,
                                         const WG_REAL *seed, const struct WG_NAME(wg_arm_state) * at, int32_t state, WG_REAL *q,
                                         int32_t *status) {
    int j, fine = isfinite(at->gap) || (arm->motion && at->gap > WG_C(0.0)); /* a foot that is nowhere */
    for (j = 0; j < arm->n; ++j) {
        const WG_REAL value = WG_NAME(wg_fitted)(arm->slides[j], at->q[j], limits->low[j], limits->high[j], seed[j]);
        q[j] = arm->slides[j] ? WG_LIBM(ldexp)(value, arm->size) : value;
        fine = fine && isfinite(q[j]);
    }
    *status = fine ? state : WALKGEN_BAD_INPUT;
    for (j = 0; j < arm->n && !fine; ++j) {
        q[j] = WG_NAN;
    }
}

#undef WG_LIBM
#endif
