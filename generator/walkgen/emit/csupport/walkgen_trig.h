/* walkgen_trig.h: sine, cosine and arctangent without branches or tables; walkgen_math.h explains the macros.
 *
 * sin and cos: x = n pi/2 + r with n by the magic number 1.5 * 2^(p-1), whose sum with a small number drops the fraction, and r by
 * subtracting n times the parts of pi/2 (Cody and Waite, Software Manual for the Elementary Functions, 1980; Muller, Elementary
 * Functions, 3rd ed. 2016, ch. 11). Parts but the last have so few bits that their products with n are exact. r stays a difference
 * high - low, so that its rounding does not reach the result. Both functions do all of it alike: a compiler that inlines the two for
 * one angle keeps one copy.
 * atan2: the angle from the nearest of the directions 0, 45, .. 180 degrees is the arctangent of one quotient.
 * The polynomials are minimax (tests/oracles/minimax.py of walkgen), evaluated by Estrin's scheme.
 *
 * Special values are C99's (Annex F). Arguments outside the ranges below, infinities and NaN go to the C library.
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_TRIG_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_TRIG_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_TRIG_F64
#define WG_LIBM(name) name
#define WG_FARTHEST WG_C(1e5) /* beyond it, the parts of pi/2 times n are not exact */
#define WG_ROUND_TO_1 WG_C(6755399441055744.0)
#define WG_LEAST_EXTENT WG_C(1e-290)
#define WG_GREATEST_EXTENT WG_C(1e300)
#define WG_EIGHTH WG_C(0.78539816339744828) /* pi/4 in 50 bits, and its rest */
#define WG_EIGHTH_REST WG_C(3.061616997868383e-17)
#else
#define WALKGEN_TRIG_F32
#define WG_LIBM(name) name##f
#define WG_FARTHEST WG_C(1e3)
#define WG_ROUND_TO_1 WG_C(12582912.0)
#define WG_LEAST_EXTENT WG_C(1e-30)
#define WG_GREATEST_EXTENT WG_C(1e30)
#define WG_EIGHTH WG_C(0.785398006) /* pi/4 in 21 bits, and its rest */
#define WG_EIGHTH_REST WG_C(1.56958237e-7)
#endif

/* An angle without its n quarter turns: high - low, where low is at most a rounding of high. */
struct WG_NAME(wg_reduced) {
    WG_REAL n, high, low;
};

#if WG_REAL_BITS == 64
/* pi/2 in 36 + 36 + 53 bits, n below 2^16. */
WG_INLINE struct wg_reduced wg_reduce(double x) {
    const double n = WG_FMA(x, 0.63661977236758138, WG_ROUND_TO_1) - WG_ROUND_TO_1;
    const double rest = WG_FMA(-n, 1.5707963267923333, x);
    const double high = WG_FMA(-n, 2.5633441515839558e-12, rest);
    const double dropped = WG_FMA(-n, 2.5633441515839558e-12, rest - high);
    const struct wg_reduced reduced = {n, high, WG_FMA(n, 1.0562999066987428e-23, -dropped)};
    return reduced;
}

/* (r - sin r) / r^3 and (cos r - 1 + r^2/2) / r^4, relative errors of sin and cos 2^-57.9 and 2^-63.9 for |r| <= 0.7854. */
WG_INLINE double wg_sine_series(double z, double z2) {
    const double low = WG_FMA(z, -0.0083333333333218407, 0.1666666666666663);
    const double middle = WG_FMA(z, -2.7557313538625445e-6, 0.00019841269829358506);
    const double high = WG_FMA(z, -1.5895440412425314e-10, 2.5050734448150096e-8);
    return WG_FMA(z2, WG_FMA(z2, high, middle), low);
}
WG_INLINE double wg_cosine_series(double z, double z2) {
    const double low = WG_FMA(z, -0.0013888888888873342, 0.041666666666666595);
    const double middle = WG_FMA(z, -2.755731421703696e-7, 2.4801587289002079e-5);
    const double high = WG_FMA(z, -1.1358749148704411e-11, 2.0875705395231184e-9);
    return WG_FMA(z2, WG_FMA(z2, high, middle), low);
}

/* (r - atan r) / r^3, relative error of atan 2^-56.3 for |r| <= 1/2. */
WG_INLINE double wg_arctangent_series(double z) {
    const double z2 = z * z, z4 = z2 * z2;
    const double low = WG_FMA(z2, WG_FMA(z, -0.11111110659608543, 0.14285714276385342), WG_FMA(z, -0.19999999999903106, 0.3333333333333298));
    const double middle = WG_FMA(z2, WG_FMA(z, -0.05858302192456828, 0.06663810906191502), WG_FMA(z, -0.07692073921292696, 0.09090896244393766));
    const double high = WG_FMA(z2, WG_FMA(z, -0.010116791246824708, 0.02743544686817501), WG_FMA(z, -0.041865531557321534, 0.051220239044616304));
    return WG_FMA(z4, WG_FMA(z4, high, middle), low);
}
#else
/* pi/2 in 14 + 14 + 14 + 24 bits, n below 2^10. */
WG_INLINE struct wg_reduced_f32 wg_reduce_f32(float x) {
    const float n = WG_FMA(x, 0.636619772f, WG_ROUND_TO_1) - WG_ROUND_TO_1;
    const float first = WG_FMA(-n, 1.57067871f, x);
    const float second = WG_FMA(-n, 0.000117614865f, first);
    const float dropped = WG_FMA(-n, 0.000117614865f, first - second);
    const float third = WG_FMA(n, 9.92031346e-10f, -dropped);
    const float high = second - third;
    const struct wg_reduced_f32 reduced = {n, high, WG_FMA(n, 6.22337197e-14f, third - (second - high))};
    return reduced;
}

/* As above; relative errors 2^-27.9, 2^-33.0 and 2^-27.5. */
WG_INLINE float wg_sine_series_f32(float z, float z2) {
    return WG_FMA(z2, 0.000195180939f, WG_FMA(z, -0.00833218824f, 0.166666552f));
}
WG_INLINE float wg_cosine_series_f32(float z, float z2) {
    return WG_FMA(z2, 2.44323273e-5f, WG_FMA(z, -0.00138873095f, 0.0416666456f));
}
WG_INLINE float wg_arctangent_series_f32(float z) {
    const float z2 = z * z;
    return WG_FMA(z2, WG_FMA(z2, 0.051244162f, WG_FMA(z, -0.101555221f, 0.141741738f)), WG_FMA(z, -0.199941665f, 0.33333233f));
}
#endif

/* sin(high - low), |high| <= pi/4; the sign of -0 survives because what is subtracted is +0 there. */
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

/* cos(n pi/2) and -sin(n pi/2), each 0, 1 or -1; a sum with the doubled magic number rounds to a multiple of 2, between two to one of 4. */
WG_INLINE WG_REAL WG_NAME(wg_quarter_cosine)(WG_REAL n) {
    const WG_REAL next = n + WG_C(1.0);
    return next - ((next + WG_C(2.0) * WG_ROUND_TO_1) - WG_C(2.0) * WG_ROUND_TO_1);
}
WG_INLINE WG_REAL WG_NAME(wg_quarter_sine)(WG_REAL n) {
    return ((n + WG_C(2.0) * WG_ROUND_TO_1) - WG_C(2.0) * WG_ROUND_TO_1) - n;
}

/* sin x. */
WG_INLINE WG_REAL WG_NAME(wg_sin)(WG_REAL x) {
    const struct WG_NAME(wg_reduced) r = WG_NAME(wg_reduce)(x);
    const WG_REAL sine = WG_NAME(wg_sine_near_0)(r.high, r.low), cosine = WG_NAME(wg_cosine_near_0)(r.high, r.low);
    const WG_REAL answer = WG_NAME(wg_quarter_cosine)(r.n) * sine - WG_NAME(wg_quarter_sine)(r.n) * cosine;
    return WG_LIKELY(WG_ABS(x) <= WG_FARTHEST) ? answer : WG_LIBM(sin)(x);
}

/* cos x. */
WG_INLINE WG_REAL WG_NAME(wg_cos)(WG_REAL x) {
    const struct WG_NAME(wg_reduced) r = WG_NAME(wg_reduce)(x);
    const WG_REAL sine = WG_NAME(wg_sine_near_0)(r.high, r.low), cosine = WG_NAME(wg_cosine_near_0)(r.high, r.low);
    const WG_REAL answer = WG_NAME(wg_quarter_cosine)(r.n) * cosine + WG_NAME(wg_quarter_sine)(r.n) * sine;
    return WG_LIKELY(WG_ABS(x) <= WG_FARTHEST) ? answer : WG_LIBM(cos)(x);
}

/* The angle of (x, y). Seen from the nearest of the directions (along, across) = (1, 0), (1, 1), (0, 1) and their mirror images in x < 0,
 * the tangent is at most 1/2; the difference in it is exact wherever it matters (Sterbenz). */
WG_INLINE WG_REAL WG_NAME(wg_atan2)(WG_REAL y, WG_REAL x) {
    const WG_REAL ax = WG_ABS(x), ay = WG_ABS(y);
    const WG_REAL along = WG_C(0.5) + WG_LIBM(copysign)(WG_C(0.5), WG_FMA(WG_C(-0.5), ay, ax));
    const WG_REAL across = WG_C(0.5) + WG_LIBM(copysign)(WG_C(0.5), WG_FMA(WG_C(-0.5), ax, ay));
    const WG_REAL side = WG_LIBM(copysign)(WG_C(1.0), x);
    const WG_REAL extent = WG_FMA(ax, along, ay * across);
    const WG_REAL tangent = WG_FMA(ay * side, along, -(x * across)) / extent;
    const WG_REAL eighths = WG_FMA(side, across - along - WG_C(1.0), WG_C(2.0));
    const WG_REAL start = eighths * WG_EIGHTH, sum = start + tangent, dropped = (start - sum) + tangent;
    const WG_REAL z = tangent * tangent;
    const WG_REAL bend = WG_FMA(-(tangent * z), WG_NAME(wg_arctangent_series)(z), eighths * WG_EIGHTH_REST);
    const WG_REAL answer = WG_LIBM(copysign)(sum + (dropped + bend), y);
    return WG_LIKELY(extent >= WG_LEAST_EXTENT && extent <= WG_GREATEST_EXTENT) ? answer : WG_LIBM(atan2)(y, x);
}

#undef WG_LIBM
#undef WG_FARTHEST
#undef WG_ROUND_TO_1
#undef WG_LEAST_EXTENT
#undef WG_GREATEST_EXTENT
#undef WG_EIGHTH
#undef WG_EIGHTH_REST
#endif
