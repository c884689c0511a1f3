/* walkgen_trig_kernel.h: the steps of walkgen_trig.h, written once for single numbers and for vectors of them; it alone includes this.
 *
 *     WG_T WG_TN(x)                   the type, a number or a vector, and names for it
 *     WG_TC(0.5) WG_TK(WG_MAGIC)      a literal and a macro's number, in every lane
 *     WG_TFMA WG_TABS WG_TCOPYSIGN    as WG_FMA, WG_ABS and the C library's copysign, lane by lane
 *     WG_TLESS(a, b)                  all bits of WG_TBITS where a < b, else none
 *     WG_TBITS                        as many unsigned integers of as many bits; WG_TN(walkgen_to_bits) and WG_TN(walkgen_of_bits) lead there and back
 */
#if defined(WG_T)
#if WG_REAL_BITS == 64
/* x less n quarter turns, |n| < 2^16: pi/2 in 36 + 36 + 53 bits. `last` is n. */
WG_INLINE WG_T WG_TN(wg_rest)(WG_T x, WG_T n, WG_T last) {
    const WG_T coarse = WG_TFMA(n, WG_TC(-1.5707963267923333), x);
    const WG_T fine = WG_TFMA(n, WG_TC(-2.5633441515839558e-12), coarse);
    return WG_TFMA(last, WG_TC(-1.0562999066987428e-23), fine);
}

/* (sin r - r) / r^3 by z = r^2; relative error of sin 2^-57.8 for |r| <= 0.7854. */
WG_INLINE WG_T WG_TN(wg_sine_series)(WG_T z) {
    const WG_T z2 = z * z;
    const WG_T start = WG_TFMA(z, WG_TC(0.0083333333333218407), WG_TC(-0.1666666666666663));
    const WG_T middle = WG_TFMA(z, WG_TC(2.7557313538625445e-6), WG_TC(-0.00019841269829358506));
    const WG_T end = WG_TFMA(z, WG_TC(1.5895440412425314e-10), WG_TC(-2.5050734448150096e-8));
    return WG_TFMA(z2, WG_TFMA(z2, end, middle), start);
}

/* (cos r - 1) / r^2; error of cos 2^-54.1. */
WG_INLINE WG_T WG_TN(wg_cosine_series)(WG_T z) {
    const WG_T z2 = z * z;
    const WG_T start = WG_TFMA(z, WG_TC(0.041666666666503593), WG_TC(-0.49999999999999484));
    const WG_T middle = WG_TFMA(z, WG_TC(2.4801579023431895e-5), WG_TC(-0.001388888887175142));
    const WG_T end = WG_TFMA(z, WG_TC(2.063363754210201e-9), WG_TC(-2.7555297303094491e-7));
    return WG_TFMA(z2, WG_TFMA(z2, end, middle), start);
}

/* (r - atan r) / r^3; relative error of atan 2^-56.9 for |r| <= 1/2. */
WG_INLINE WG_T WG_TN(wg_arctangent_series)(WG_T z) {
    const WG_T z2 = z * z, z4 = z2 * z2;
    const WG_T first = WG_TFMA(z, WG_TC(-0.19999999999903106), WG_TC(0.33333333333332982));
    const WG_T second = WG_TFMA(z, WG_TC(-0.11111110659608543), WG_TC(0.14285714276385342));
    const WG_T third = WG_TFMA(z, WG_TC(-0.076920739212926956), WG_TC(0.09090896244393766));
    const WG_T fourth = WG_TFMA(z, WG_TC(-0.058583021924568282), WG_TC(0.066638109061915016));
    const WG_T fifth = WG_TFMA(z, WG_TC(-0.041865531557321534), WG_TC(0.051220239044616304));
    const WG_T sixth = WG_TFMA(z, WG_TC(-0.010116791246824708), WG_TC(0.02743544686817501));
    const WG_T start = WG_TFMA(z2, second, first), middle = WG_TFMA(z2, fourth, third), end = WG_TFMA(z2, sixth, fifth);
    return WG_TFMA(z4, WG_TFMA(z4, end, middle), start);
}
#else
/* x less n quarter turns, |n| < 2^13: pi/2 in 24 + 24 + 24 bits, since with one rounding the first difference is exact (its bits are not finer
 * than those of 2^-24), or in 11 + 11 + 11 + 24. `last` is n. */
WG_INLINE WG_T WG_TN(wg_rest)(WG_T x, WG_T n, WG_T last) {
#if defined(WALKGEN_FAST_FMAF)
    const WG_T coarse = WG_TFMA(n, WG_TC(-1.57079625), x), fine = WG_TFMA(n, WG_TC(-7.54978942e-8), coarse);
    return WG_TFMA(last, WG_TC(-5.39030295e-15), fine);
#else
    const WG_T coarse = WG_TFMA(n, WG_TC(-0.000483751297), WG_TFMA(n, WG_TC(-1.5703125), x));
    const WG_T fine = WG_TFMA(n, WG_TC(-7.54953362e-8), coarse);
    return WG_TFMA(last, WG_TC(-2.56334407e-12), fine);
#endif
}

/* (sin r - r) / r^3 by z = r^2; relative error of sin 2^-27.8 for |r| <= 0.7866. */
WG_INLINE WG_T WG_TN(wg_sine_series)(WG_T z) {
    return WG_TFMA(z, WG_TFMA(z, WG_TC(-0.000195176981), WG_TC(0.00833218638)), WG_TC(-0.166666552));
}

/* (cos r - 1) / r^2; error of cos 2^-24.8. */
WG_INLINE WG_T WG_TN(wg_cosine_series)(WG_T z) {
    return WG_TFMA(z, WG_TFMA(z, WG_TC(-0.00135959324), WG_TC(0.0416561589)), WG_TC(-0.499998927));
}

/* (r - atan r) / r^3; relative error of atan 2^-27.4 for |r| <= 1/2. */
WG_INLINE WG_T WG_TN(wg_arctangent_series)(WG_T z) {
    const WG_T z2 = z * z;
    const WG_T start = WG_TFMA(z, WG_TC(-0.199941665), WG_TC(0.33333233));
    const WG_T end = WG_TFMA(z2, WG_TC(0.051244162), WG_TFMA(z, WG_TC(-0.101555221), WG_TC(0.141741738)));
    return WG_TFMA(z2, end, start);
}
#endif

/* x 2/pi and the magic number: their sum has n, the nearest number of quarter turns, in its last bits. */
WG_INLINE WG_T WG_TN(wg_quarters)(WG_T x) {
    return WG_TFMA(x, WG_TK(WG_QUARTERS), WG_TK(WG_MAGIC));
}

/* Sine and cosine of the rest r after those quarter turns: exchanged in one of two of them, negated in one of two halves. r^3 + 0 is 0 where r is
 * -0, so that the sine keeps r's sign. */
WG_INLINE void WG_TN(wg_sincos_after)(WG_T quarters, WG_T r, WG_T *sine, WG_T *cosine) {
    const WG_TBITS n = WG_TN(walkgen_to_bits)(quarters);
    const WG_T z = r * r;
    const WG_T sine_of_r = WG_TFMA(WG_TFMA(z, r, WG_TC(0.0)), WG_TN(wg_sine_series)(z), r);
    const WG_T cosine_of_r = WG_TFMA(z, WG_TN(wg_cosine_series)(z), WG_TC(1.0));
    const WG_TBITS odd = 0 - (n & 1), half = (n << (WG_REAL_BITS - 2)) & WG_SIGN;
    const WG_TBITS s = WG_TN(walkgen_to_bits)(sine_of_r) ^ (odd & WG_SIGN), c = WG_TN(walkgen_to_bits)(cosine_of_r);
    const WG_TBITS exchange = (s ^ c) & odd;
    *sine = WG_TN(walkgen_of_bits)(s ^ exchange ^ half);
    *cosine = WG_TN(walkgen_of_bits)(c ^ exchange ^ half);
}

/* sin x and cos x, |x| <= WG_FARTHEST. */
WG_INLINE void WG_TN(wg_sincos_near)(WG_T x, WG_T *sine, WG_T *cosine) {
    const WG_T quarters = WG_TN(wg_quarters)(x), n = quarters - WG_TK(WG_MAGIC);
    WG_TN(wg_sincos_after)(quarters, WG_TN(wg_rest)(x, n, n), sine, cosine);
}

/* A number where the mask's bits are 1, else 0. */
WG_INLINE WG_T WG_TN(wg_where)(WG_TBITS mask, WG_T x) { return WG_TN(walkgen_of_bits)(WG_TN(walkgen_to_bits)(x) & mask); }

/* The angle of (x, y). The direction (along, across) it is seen from is (1, 0), (1, 1) or (0, 1), mirrored where x < 0: the one that
 * keeps the tangent within 1/2, where the difference in it is exact (Sterbenz). The answer holds where the extent is neither 0 nor infinite;
 * in a `lane` it is NaN elsewhere: 0 divides, and a difference that is free is no number. */
WG_INLINE WG_T WG_TN(wg_atan2_near)(WG_T y, WG_T x, WG_T *extent, int lane) {
    const WG_T ax = WG_TABS(x), ay = WG_TABS(y);
    const WG_TBITS along = WG_TLESS(ay, ax + ax), across = WG_TLESS(ax, ay + ay), side = WG_TN(walkgen_to_bits)(x) & WG_SIGN;
    const WG_T beside = WG_TN(wg_where)(along, ay) - WG_TN(wg_where)(across, ax);
    const WG_T eighths_less_2 = WG_TN(wg_where)(along, WG_TC(-1.0)) - WG_TN(wg_where)(~across, WG_TC(1.0)); /* the direction's angle */
    const WG_T eighths = WG_TC(2.0) + WG_TN(walkgen_of_bits)(WG_TN(walkgen_to_bits)(eighths_less_2) ^ side);
    *extent = WG_TN(wg_where)(along, ax) + WG_TN(wg_where)(across, ay);
    {
        const WG_T tangent = WG_TN(walkgen_of_bits)(WG_TN(walkgen_to_bits)(beside / *extent) ^ side), z = tangent * tangent;
        const WG_T rest = lane ? WG_TFMA(eighths, WG_TK(WG_EIGHTH_REST), *extent - *extent) : eighths * WG_TK(WG_EIGHTH_REST);
        const WG_T bend = WG_TFMA(-(tangent * z), WG_TN(wg_arctangent_series)(z), rest);
        return WG_TCOPYSIGN(WG_TFMA(eighths, WG_TK(WG_EIGHTH), tangent + bend), y);
    }
}
#endif
