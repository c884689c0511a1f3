/* walkgen_trig.h: sine, cosine and arctangent without branches or tables, of one number or of four at once; walkgen_math.h explains the macros.
 *
 * sin and cos: x = n pi/2 + r. A sum with the magic number 1.5 * 2^(p-1) drops the fraction and leaves n in its last bits; then n times the
 * parts of pi/2 are subtracted (Cody and Waite, Software Manual for the Elementary Functions, 1980; Muller, Elementary Functions, 3rd ed.
 * 2016, ch. 11), of which only the last differences are rounded. Both functions do all of it alike: inlined for one angle, they share it.
 * atan2: from the nearest of the directions 0, 45, .. 180 degrees, the angle is the arctangent of one quotient.
 * Choices are masks over bits, not jumps. The polynomials are minimax (Remez, walkgen's tests/oracles/minimax.py), in Estrin's order.
 *
 * Range      |x| <= 1e5, in float 1e4; atan2 where the numbers are not both 0 and their sum is finite. Beyond, for infinities and for NaN
 *            the C library answers. Special values are C99's (Annex F); sin(-0) is -0.
 * Error      at most, in units in the last place: sin and cos 1.75 with fused multiply-add, without it 2, there in float beyond |x| = 100 2.5;
 *            atan2 1.6. In float measured on every angle, in double on some ten millions. Sums that keep what r's rounding drops would
 *            bring sin and cos to 0.85, for a fifth of the time of a block of rows.
 * Together   where vectors of four are one instruction (WG_TOGETHER), WG_SINCOS_3 and its like evaluate all their angles in one;
 *            where those of two are, in pairs; each lane does what a single number does: the same bits.
 * Rounding   to nearest, as C programs start with.
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_TRIG_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_TRIG_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_TRIG_F64
#define WG_SIGN (UINT64_C(1) << 63)
#define WG_LIBM(name) name
#define WG_FARTHEST WG_C(1e5)
#define WG_OVERFLOWING WG_C(1.7976931348623158e+303) /* times the farthest angle still finite, times the next one not */
#define WG_QUARTERS WG_C(0.63661977236758138) /* 2/pi */
#define WG_MAGIC WG_C(6755399441055744.0)
#define WG_GREATEST WG_C(1.7976931348623157e+308)
#define WG_EIGHTH WG_C(0.78539816339744828) /* pi/4 in 50 bits */
#define WG_EIGHTH_REST WG_C(3.061616997868383e-17)
#else
#define WALKGEN_TRIG_F32
#define WG_SIGN (UINT32_C(1) << 31)
#define WG_LIBM(name) name##f
#define WG_FARTHEST WG_C(1e4)
#define WG_OVERFLOWING WG_C(3.4028233e+34)
#define WG_QUARTERS WG_C(0.636619772) /* 2/pi */
#define WG_MAGIC WG_C(12582912.0)
#define WG_GREATEST WG_C(3.40282347e+38)
#define WG_EIGHTH WG_C(0.785398006) /* pi/4 in 21 bits */
#define WG_EIGHTH_REST WG_C(1.56958237e-7)
#endif

#define WG_T WG_REAL
#define WG_TBITS WG_UINT
#define WG_TN(x) WG_NAME(x)
#define WG_TC(x) WG_C(x)
#define WG_TK(x) x
#define WG_TFMA(a, b, c) WG_FMA(a, b, c)
#define WG_TABS(x) WG_ABS(x)
#define WG_TLESS(a, b) (0 - (WG_UINT)((a) < (b)))
#define WG_TCOPYSIGN(x, sign) WG_LIBM(copysign)(x, sign)
#include "walkgen_trig_kernel.h"
#undef WG_T
#undef WG_TBITS
#undef WG_TN
#undef WG_TC
#undef WG_TK
#undef WG_TFMA
#undef WG_TABS
#undef WG_TLESS
#undef WG_TCOPYSIGN

/* sin x. */
WG_INLINE WG_REAL WG_NAME(wg_sin)(WG_REAL x) {
    WG_REAL sine, cosine;
    WG_NAME(wg_sincos_near)(x, &sine, &cosine);
    return WG_LIKELY(WG_ABS(x) <= WG_FARTHEST) ? sine : WG_LIBM(sin)(x);
}

/* cos x. */
WG_INLINE WG_REAL WG_NAME(wg_cos)(WG_REAL x) {
    WG_REAL sine, cosine;
    WG_NAME(wg_sincos_near)(x, &sine, &cosine);
    return WG_LIKELY(WG_ABS(x) <= WG_FARTHEST) ? cosine : WG_LIBM(cos)(x);
}

/* Both, in one call. */
struct WG_NAME(wg_sine_cosine) {
    WG_REAL sine, cosine;
};

WG_CALLED struct WG_NAME(wg_sine_cosine) WG_NAME(wg_sincos_called)(WG_REAL x) {
    const struct WG_NAME(wg_sine_cosine) turn = {WG_NAME(wg_sin)(x), WG_NAME(wg_cos)(x)};
    return turn;
}

/* The angle of (x, y). */
WG_INLINE WG_REAL WG_NAME(wg_atan2)(WG_REAL y, WG_REAL x) {
    WG_REAL extent;
    const WG_REAL answer = WG_NAME(wg_atan2_near)(y, x, &extent, 0);
    return WG_LIKELY(extent > WG_C(0.0) && extent <= WG_GREATEST) ? answer : WG_LIBM(atan2)(y, x);
}

/* The same in one call. */
WG_CALLED WG_REAL WG_NAME(wg_atan2_called)(WG_REAL y, WG_REAL x) { return WG_NAME(wg_atan2)(y, x); }

/* The same without the way to the C library: NaN beyond the range (walkgen_lanes.h), where the product overflows and n is no number in the
 * last of its products. Processors subtract and multiply beside each other; comparing and choosing would wait for the same units. */
WG_INLINE void WG_NAME(wg_sincos_lane)(WG_REAL x, WG_REAL *sine, WG_REAL *cosine) {
    const WG_REAL far = x * WG_OVERFLOWING, quarters = WG_NAME(wg_quarters)(x), n = quarters - WG_MAGIC;
    WG_NAME(wg_sincos_after)(quarters, WG_NAME(wg_rest)(x, n, n + (far - far)), sine, cosine);
}

WG_INLINE WG_REAL WG_NAME(wg_sin_lane)(WG_REAL x) {
    WG_REAL sine, cosine;
    WG_NAME(wg_sincos_lane)(x, &sine, &cosine);
    return sine;
}

WG_INLINE WG_REAL WG_NAME(wg_cos_lane)(WG_REAL x) {
    WG_REAL sine, cosine;
    WG_NAME(wg_sincos_lane)(x, &sine, &cosine);
    return cosine;
}

WG_INLINE WG_REAL WG_NAME(wg_atan2_lane)(WG_REAL y, WG_REAL x) {
    WG_REAL extent;
    return WG_NAME(wg_atan2_near)(y, x, &extent, 1);
}

/* Sines and cosines of four angles. */
struct WG_NAME(wg_turned) {
    WG_REAL sine0, sine1, sine2, sine3, cosine0, cosine1, cosine2, cosine3;
};

/* Angles of four points. */
struct WG_NAME(wg_angles) {
    WG_REAL angle0, angle1, angle2, angle3;
};

#if WG_TOGETHER == 4
#include "walkgen_trig_x4.h"
#elif WG_TOGETHER == 2
#include "walkgen_trig_x2.h"
#endif

#undef WG_LIBM
#undef WG_SIGN
#undef WG_FARTHEST
#undef WG_OVERFLOWING
#undef WG_QUARTERS
#undef WG_MAGIC
#undef WG_GREATEST
#undef WG_EIGHTH
#undef WG_EIGHTH_REST
#endif
