/* walkgen_trig_x4.h: four sines and cosines, or four arctangents, in one vector; walkgen_trig.h alone includes this, where WG_TOGETHER is 4.
 * Lane by lane the bits of a single number. A vector never crosses a function that is not inlined.
 */
#if defined(WG_FARTHEST)
#if WG_REAL_BITS == 64
typedef double wg_x4 __attribute__((vector_size(32)));
typedef uint64_t wg_bits_x4 __attribute__((vector_size(32)));
#define WG_T wg_x4
#define WG_TN(x) x##_x4
#define WG_TBITS wg_bits_x4
#define WG_MOST_SIGNIFICANT(mask) __builtin_ia32_movmskpd256((wg_x4)(mask))
#if defined(WALKGEN_FAST_FMA) && defined(WALKGEN_ELEMENTWISE)
#define WG_TFMA(a, b, c) __builtin_elementwise_fma(a, b, c)
#elif defined(WALKGEN_FAST_FMA)
#define WG_TFMA(a, b, c) __builtin_ia32_vfmaddpd256(a, b, c)
#else
#define WG_TFMA(a, b, c) ((a) * (b) + (c))
#endif
#else
typedef float wg_x4_f32 __attribute__((vector_size(16)));
typedef uint32_t wg_bits_x4_f32 __attribute__((vector_size(16)));
#define WG_T wg_x4_f32
#define WG_TN(x) x##_x4_f32
#define WG_TBITS wg_bits_x4_f32
#define WG_MOST_SIGNIFICANT(mask) __builtin_ia32_movmskps((wg_x4_f32)(mask))
#if defined(WALKGEN_FAST_FMAF) && defined(WALKGEN_ELEMENTWISE)
#define WG_TFMA(a, b, c) __builtin_elementwise_fma(a, b, c)
#elif defined(WALKGEN_FAST_FMAF)
#define WG_TFMA(a, b, c) __builtin_ia32_vfmaddps(a, b, c)
#else
#define WG_TFMA(a, b, c) ((a) * (b) + (c))
#endif
#endif
#define WG_TC(x) WG_TN(wg_all)(WG_C(x))
#define WG_TK(x) WG_TN(wg_all)(x)
#define WG_TLESS(a, b) ((WG_TBITS)((a) < (b)))
#define WG_TABS(x) WG_TN(wg_abs)(x)
#define WG_TCOPYSIGN(x, sign) WG_TN(wg_copysign)(x, sign)

WG_INLINE WG_T WG_TN(wg_all)(WG_REAL x) {
    const WG_T all = {x, x, x, x};
    return all;
}

WG_INLINE WG_T WG_TN(wg_abs)(WG_T x) { return (WG_T)((WG_TBITS)x & ~WG_SIGN); }

WG_INLINE WG_T WG_TN(wg_copysign)(WG_T x, WG_T sign) {
    return (WG_T)(((WG_TBITS)x & ~WG_SIGN) | ((WG_TBITS)sign & WG_SIGN));
}

WG_INLINE WG_TBITS WG_TN(walkgen_to_bits)(WG_T x) { return (WG_TBITS)x; }

WG_INLINE WG_T WG_TN(walkgen_of_bits)(WG_TBITS bits) { return (WG_T)bits; }

#include "walkgen_trig_kernel.h"

/* Whether all angles lie within the range of the polynomials. */
WG_INLINE int WG_NAME(wg_angles_within)(WG_REAL x0, WG_REAL x1, WG_REAL x2, WG_REAL x3) {
    const WG_T x = {x0, x1, x2, x3};
    return WG_MOST_SIGNIFICANT(WG_TABS(x) <= WG_TK(WG_FARTHEST)) == 15;
}

WG_INLINE struct WG_NAME(wg_turned) WG_NAME(wg_sincos_together)(WG_REAL x0, WG_REAL x1, WG_REAL x2, WG_REAL x3) {
    const WG_T x = {x0, x1, x2, x3};
    WG_T s, c;
    WG_TN(wg_sincos_near)(x, &s, &c);
    if (WG_LIKELY(WG_NAME(wg_angles_within)(x0, x1, x2, x3))) {
        const struct WG_NAME(wg_turned) turned = {s[0], s[1], s[2], s[3], c[0], c[1], c[2], c[3]};
        return turned;
    } else {
        const struct WG_NAME(wg_sine_cosine) a = WG_NAME(wg_sincos_called)(x0), b = WG_NAME(wg_sincos_called)(x1),
                                             d = WG_NAME(wg_sincos_called)(x2), e = WG_NAME(wg_sincos_called)(x3);
        const struct WG_NAME(wg_turned) turned = {a.sine, b.sine, d.sine, e.sine, a.cosine, b.cosine, d.cosine, e.cosine};
        return turned;
    }
}

/* Whether all points lie within the range. */
WG_INLINE int WG_NAME(wg_points_within)(WG_REAL y0, WG_REAL x0, WG_REAL y1, WG_REAL x1, WG_REAL y2, WG_REAL x2, WG_REAL y3, WG_REAL x3) {
    const WG_T y = {y0, y1, y2, y3}, x = {x0, x1, x2, x3};
    WG_T extent;
    (void)WG_TN(wg_atan2_near)(y, x, &extent, 0);
    return WG_MOST_SIGNIFICANT((extent > WG_TC(0.0)) & (extent <= WG_TK(WG_GREATEST))) == 15;
}

WG_INLINE struct WG_NAME(wg_angles) WG_NAME(wg_atan2_together)(WG_REAL y0, WG_REAL x0, WG_REAL y1, WG_REAL x1, WG_REAL y2, WG_REAL x2,
                                                              WG_REAL y3, WG_REAL x3) {
    const WG_T y = {y0, y1, y2, y3}, x = {x0, x1, x2, x3};
    WG_T extent;
    const WG_T a = WG_TN(wg_atan2_near)(y, x, &extent, 0);
    if (WG_LIKELY(WG_NAME(wg_points_within)(y0, x0, y1, x1, y2, x2, y3, x3))) {
        const struct WG_NAME(wg_angles) angles = {a[0], a[1], a[2], a[3]};
        return angles;
    } else {
        const struct WG_NAME(wg_angles) angles = {WG_NAME(wg_atan2_called)(y0, x0), WG_NAME(wg_atan2_called)(y1, x1),
                                                  WG_NAME(wg_atan2_called)(y2, x2), WG_NAME(wg_atan2_called)(y3, x3)};
        return angles;
    }
}

#undef WG_T
#undef WG_TN
#undef WG_TC
#undef WG_TK
#undef WG_TFMA
#undef WG_TABS
#undef WG_TLESS
#undef WG_TCOPYSIGN
#undef WG_TBITS
#undef WG_MOST_SIGNIFICANT
#endif
