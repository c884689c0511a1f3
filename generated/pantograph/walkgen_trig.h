/* walkgen_trig.h: sine, cosine and arctangent without branches or tables; walkgen_math.h explains the macros.
 *
 * sin and cos: x = n pi/2 + r. A sum with the magic number 1.5 * 2^(p-1) drops the fraction, which gives n; then n times the parts of
 * pi/2 are subtracted (Cody and Waite, Software Manual for the Elementary Functions, 1980; Muller, Elementary Functions, 3rd ed.
 * 2016, ch. 11). All parts but the last have so few bits that their products with n are exact. r stays a difference high - low, so
 * that its rounding does not reach the result. Both functions do all of it alike: inlined for one angle, they share it.
 * atan2: from the nearest of the directions 0, 45, .. 180 degrees, the angle is the arctangent of one quotient.
 * The polynomials are minimax (Remez, walkgen's tests/oracles/minimax.py), in Estrin's order.
 *
 * Range      |x| <= 1e5, in float 1e4; atan2 where the larger number lies in 1e-290 .. 1e300, in float 1e-30 .. 1e30. Beyond, for
 *            infinities and for NaN the C library answers. Special values are C99's (Annex F); sin(-0) is -0.
 * Error      at most, in units in the last place: sin and cos 0.85, atan2 1.65; with fused multiply-add sin and cos 0.80. In float
 *            measured on every angle, in double on some ten millions.
 * Rounding   to nearest, as C programs start with.
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_TRIG_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_TRIG_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_TRIG_F64
#define WG_LIBM(name) name
#define WG_FARTHEST WG_C(1e5)
#define WG_MAGIC WG_C(6755399441055744.0)
#define WG_LEAST_EXTENT WG_C(1e-290)
#define WG_GREATEST_EXTENT WG_C(1e300)
#define WG_EIGHTH WG_C(0.78539816339744828) /* pi/4 in 50 bits */
#define WG_EIGHTH_REST WG_C(3.061616997868383e-17)
#else
#define WALKGEN_TRIG_F32
#define WG_LIBM(name) name##f
#define WG_FARTHEST WG_C(1e4)
#define WG_MAGIC WG_C(12582912.0)
#define WG_LEAST_EXTENT WG_C(1e-30)
#define WG_GREATEST_EXTENT WG_C(1e30)
#define WG_EIGHTH WG_C(0.785398006) /* pi/4 in 21 bits */
#define WG_EIGHTH_REST WG_C(1.56958237e-7)
#endif

/* An angle less n quarter turns: high - low, where low is at most about a rounding of high. */
struct WG_NAME(wg_reduced) {
    WG_REAL n, high, low;
};

#if WG_REAL_BITS == 64
/* pi/2 in 36 + 36 + 53 bits; |n| < 2^16. */
WG_INLINE struct wg_reduced wg_reduce(double x) {
    const double n = WG_FMA(x, 0.63661977236758138, WG_MAGIC) - WG_MAGIC;
    const double rest = WG_FMA(n, -1.5707963267923333, x);
    const double high = WG_FMA(n, -2.5633441515839558e-12, rest);
    const double dropped = WG_FMA(n, -2.5633441515839558e-12, rest - high);
    const struct wg_reduced reduced = {n, high, WG_FMA(n, 1.0562999066987428e-23, -dropped)};
    return reduced;
}

/* (r - sin r) / r^3 by z = r^2; relative error of sin 2^-57.8 for |r| <= 0.7854. */
WG_INLINE double wg_sine_series(double z, double z2) {
    const double start = WG_FMA(z, -0.0083333333333218407, 0.1666666666666663);
    const double middle = WG_FMA(z, -2.7557313538625445e-6, 0.00019841269829358506);
    const double end = WG_FMA(z, -1.5895440412425314e-10, 2.5050734448150096e-8);
    return WG_FMA(z2, WG_FMA(z2, end, middle), start);
}

/* (cos r - 1 + r^2/2) / r^4; relative error of cos 2^-63.9. */
WG_INLINE double wg_cosine_series(double z, double z2) {
    const double start = WG_FMA(z, -0.0013888888888873342, 0.041666666666666595);
    const double middle = WG_FMA(z, -2.755731421703696e-7, 2.4801587289002079e-5);
    const double end = WG_FMA(z, -1.1358749148704411e-11, 2.0875705395231184e-9);
    return WG_FMA(z2, WG_FMA(z2, end, middle), start);
}

/* (r - atan r) / r^3; relative error of atan 2^-56.9 for |r| <= 1/2. */
WG_INLINE double wg_arctangent_series(double z) {
    const double z2 = z * z, z4 = z2 * z2;
    const double first = WG_FMA(z, -0.19999999999903106, 0.33333333333332982);
    const double second = WG_FMA(z, -0.11111110659608543, 0.14285714276385342);
    const double third = WG_FMA(z, -0.076920739212926956, 0.09090896244393766);
    const double fourth = WG_FMA(z, -0.058583021924568282, 0.066638109061915016);
    const double fifth = WG_FMA(z, -0.041865531557321534, 0.051220239044616304);
    const double sixth = WG_FMA(z, -0.010116791246824708, 0.02743544686817501);
    const double start = WG_FMA(z2, second, first), middle = WG_FMA(z2, fourth, third), end = WG_FMA(z2, sixth, fifth);
    return WG_FMA(z4, WG_FMA(z4, end, middle), start);
}
#else
/* pi/2 in 11 + 11 + 11 + 24 bits; |n| < 2^13. */
WG_INLINE struct wg_reduced_f32 wg_reduce_f32(float x) {
    const float n = WG_FMA(x, 0.636619772f, WG_MAGIC) - WG_MAGIC;
    const float first = WG_FMA(n, -1.5703125f, x);
    const float second = WG_FMA(n, -0.000483751297f, first);
    const float dropped = WG_FMA(n, -0.000483751297f, first - second);
    const float third = WG_FMA(n, 7.54953362e-8f, -dropped);
    const float high = second - third;
    const struct wg_reduced_f32 reduced = {n, high, WG_FMA(n, 2.56334407e-12f, third - (second - high))};
    return reduced;
}

/* (r - sin r) / r^3 by z = r^2; relative error of sin 2^-27.8 for |r| <= 0.7866. */
WG_INLINE float wg_sine_series_f32(float z, float z2) {
    return WG_FMA(z2, 0.000195176981f, WG_FMA(z, -0.00833218638f, 0.166666552f));
}

/* (cos r - 1 + r^2/2) / r^4; relative error of cos 2^-32.9. */
WG_INLINE float wg_cosine_series_f32(float z, float z2) {
    return WG_FMA(z2, 2.44323219e-5f, WG_FMA(z, -0.00138873095f, 0.0416666456f));
}

/* (r - atan r) / r^3; relative error of atan 2^-27.4 for |r| <= 1/2. */
WG_INLINE float wg_arctangent_series_f32(float z) {
    const float z2 = z * z;
    const float start = WG_FMA(z, -0.199941665f, 0.33333233f);
    const float end = WG_FMA(z2, 0.051244162f, WG_FMA(z, -0.101555221f, 0.141741738f));
    return WG_FMA(z2, end, start);
}
#endif

/* sin(high - low), |high| <= pi/4. Of -0, +0 is subtracted, which keeps its sign. */
WG_INLINE WG_REAL WG_NAME(wg_sine_near_0)(WG_REAL high, WG_REAL low) {
    const WG_REAL z = high * high;
    const WG_REAL cosine = WG_FMA(WG_C(-0.5), z, WG_C(1.0));
    return high - WG_FMA(z * high, WG_NAME(wg_sine_series)(z, z * z), low * cosine);
}

/* cos(high - low), |high| <= pi/4. */
WG_INLINE WG_REAL WG_NAME(wg_cosine_near_0)(WG_REAL high, WG_REAL low) {
    const WG_REAL z = high * high, z2 = z * z;
    const WG_REAL cosine = WG_FMA(WG_C(-0.5), z, WG_C(1.0));
    const WG_REAL dropped = WG_FMA(WG_C(-0.5), z, WG_C(1.0) - cosine);
    return cosine + (dropped + WG_FMA(z2, WG_NAME(wg_cosine_series)(z, z2), high * low));
}

/* The nearest multiple of 2 of a whole number; of an odd number, that of 4. */
WG_INLINE WG_REAL WG_NAME(wg_even)(WG_REAL n) { return (n + WG_C(2.0) * WG_MAGIC) - WG_C(2.0) * WG_MAGIC; }

/* cos(n pi/2) and -sin(n pi/2): 0, 1 or -1, for a selection without jumps; their products are exact. */
WG_INLINE WG_REAL WG_NAME(wg_quarters_cosine)(WG_REAL n) { return (n + WG_C(1.0)) - WG_NAME(wg_even)(n + WG_C(1.0)); }
WG_INLINE WG_REAL WG_NAME(wg_quarters_sine_negated)(WG_REAL n) { return WG_NAME(wg_even)(n) - n; }

/* sin x. */
WG_INLINE WG_REAL WG_NAME(wg_sin)(WG_REAL x) {
    const struct WG_NAME(wg_reduced) r = WG_NAME(wg_reduce)(x);
    const WG_REAL sine = WG_NAME(wg_sine_near_0)(r.high, r.low), cosine = WG_NAME(wg_cosine_near_0)(r.high, r.low);
    const WG_REAL answer = WG_NAME(wg_quarters_cosine)(r.n) * sine - WG_NAME(wg_quarters_sine_negated)(r.n) * cosine;
    return WG_LIKELY(WG_ABS(x) <= WG_FARTHEST) ? answer : WG_LIBM(sin)(x);
}

/* cos x. */
WG_INLINE WG_REAL WG_NAME(wg_cos)(WG_REAL x) {
    const struct WG_NAME(wg_reduced) r = WG_NAME(wg_reduce)(x);
    const WG_REAL sine = WG_NAME(wg_sine_near_0)(r.high, r.low), cosine = WG_NAME(wg_cosine_near_0)(r.high, r.low);
    const WG_REAL answer = WG_NAME(wg_quarters_cosine)(r.n) * cosine + WG_NAME(wg_quarters_sine_negated)(r.n) * sine;
    return WG_LIKELY(WG_ABS(x) <= WG_FARTHEST) ? answer : WG_LIBM(cos)(x);
}

/* The angle of (x, y). The direction (along, across) it is seen from is (1, 0), (1, 1) or (0, 1), mirrored where x < 0: the one that
 * keeps the tangent within 1/2, where the difference in it is exact (Sterbenz). */
WG_INLINE WG_REAL WG_NAME(wg_atan2)(WG_REAL y, WG_REAL x) {
    const WG_REAL ax = WG_ABS(x), ay = WG_ABS(y);
    const WG_REAL along = WG_C(0.5) + WG_LIBM(copysign)(WG_C(0.5), WG_FMA(WG_C(-0.5), ay, ax));
    const WG_REAL across = WG_C(0.5) + WG_LIBM(copysign)(WG_C(0.5), WG_FMA(WG_C(-0.5), ax, ay));
    const WG_REAL side = WG_LIBM(copysign)(WG_C(1.0), x);
    const WG_REAL extent = WG_FMA(ax, along, ay * across);
    const WG_REAL tangent = WG_FMA(ay * side, along, -(x * across)) / extent;
    const WG_REAL eighths = WG_FMA(side, across - along - WG_C(1.0), WG_C(2.0)); /* the direction's angle, 0 .. 4 times pi/4 */
    const WG_REAL start = eighths * WG_EIGHTH, sum = start + tangent, dropped = (start - sum) + tangent;
    const WG_REAL z = tangent * tangent;
    const WG_REAL bend = WG_FMA(-(tangent * z), WG_NAME(wg_arctangent_series)(z), eighths * WG_EIGHTH_REST);
    const WG_REAL answer = WG_LIBM(copysign)(sum + (dropped + bend), y);
    return WG_LIKELY(extent >= WG_LEAST_EXTENT && extent <= WG_GREATEST_EXTENT) ? answer : WG_LIBM(atan2)(y, x);
}

#undef WG_LIBM
#undef WG_FARTHEST
#undef WG_MAGIC
#undef WG_LEAST_EXTENT
#undef WG_GREATEST_EXTENT
#undef WG_EIGHTH
#undef WG_EIGHTH_REST
#endif
