/* walkgen_power.h: powers of 2 that bring numbers near 1, without a call of the C library; walkgen_math.h explains the macros. */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_POWER_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_POWER_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_POWER_F64
#define WG_FRACTION 52
#define WG_BIAS 1023
#define WG_POWERS 1000
#define WG_ABOVE_SUBNORMAL WG_C(18014398509481984.0) /* 2^54 */
#else
#define WALKGEN_POWER_F32
#define WG_FRACTION 23
#define WG_BIAS 127
#define WG_POWERS 120
#define WG_ABOVE_SUBNORMAL WG_C(18014398509481984.0)
#endif

/* Exponent of the least power of 2 above a number that is greater than 0; what is infinite has the greatest, and a NaN any. */
static inline int32_t WG_NAME(wg_exponent)(WG_REAL value) {
    const int small = value < WG_TINY;
    const WG_UINT bits = WG_NAME(walkgen_to_bits)(small ? value * WG_ABOVE_SUBNORMAL : value);
    return (int32_t)((bits >> WG_FRACTION) & (2 * WG_BIAS + 1)) - (WG_BIAS - 1) - (small ? 54 : 0);
}

/* 2 to an exponent, kept in the range of numbers. */
static inline WG_REAL WG_NAME(wg_power)(int32_t exponent) {
    const int32_t kept = exponent > WG_POWERS ? WG_POWERS : exponent < -WG_POWERS ? -WG_POWERS : exponent;
    return WG_NAME(walkgen_of_bits)((WG_UINT)(kept + WG_BIAS) << WG_FRACTION);
}

#undef WG_FRACTION
#undef WG_BIAS
#undef WG_POWERS
#undef WG_ABOVE_SUBNORMAL
#endif
