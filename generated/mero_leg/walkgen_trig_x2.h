/* walkgen_trig_x2.h: two sines and cosines in one vector of doubles; walkgen_trig.h alone includes this, where
 * WALKGEN_PAIRS is defined. Lane by lane the bits of a single number. A vector never crosses a function that is not inlined.
 * Arctangents are faster one by one.
 */
#if defined(WG_FARTHEST) && WG_REAL_BITS == 64
typedef double wg_x2 __attribute__((vector_size(16)));
typedef int64_t wg_bits_x2 __attribute__((vector_size(16)));
#define WG_T wg_x2
#define WG_TN(x) x##_x2
#define WG_TC(x) wg_both(x)
#define WG_TK(x) wg_both(x)
#define WG_TFMA(a, b, c) ((a) * (b) + (c))
#define WG_TABS(x) wg_abs_x2(x)
#define WG_TCOPYSIGN(x, sign) wg_copysign_x2(x, sign)
#define WG_BOTH(mask) (__builtin_ia32_movmskpd((wg_x2)(mask)) == 3)

WG_INLINE wg_x2 wg_both(double x) {
    const wg_x2 both = {x, x};
    return both;
}

WG_INLINE wg_x2 wg_abs_x2(wg_x2 x) { return (wg_x2)((wg_bits_x2)x & ~INT64_MIN); }

WG_INLINE wg_x2 wg_copysign_x2(wg_x2 x, wg_x2 sign) { return (wg_x2)(((wg_bits_x2)x & ~INT64_MIN) | ((wg_bits_x2)sign & INT64_MIN)); }

#include "walkgen_trig_kernel.h"

/* Whether both angles lie within the range of the polynomials. */
WG_INLINE int wg_pair_within(double x0, double x1) {
    const wg_x2 x = {x0, x1};
    return WG_BOTH(WG_TABS(x) <= WG_TK(WG_FARTHEST));
}

/* Sines and cosines of two angles. */
struct wg_turned_x2 {
    double sine0, sine1, cosine0, cosine1;
};

WG_INLINE struct wg_turned_x2 wg_sincos_pair(double x0, double x1) {
    const wg_x2 x = {x0, x1};
    wg_x2 s, c;
    wg_sincos_near_x2(x, &s, &c);
    if (WG_LIKELY(wg_pair_within(x0, x1))) {
        const struct wg_turned_x2 turned = {s[0], s[1], c[0], c[1]};
        return turned;
    } else {
        const struct wg_turned_x2 turned = {wg_sin_alone(x0), wg_sin_alone(x1), wg_cos_alone(x0), wg_cos_alone(x1)};
        return turned;
    }
}

#undef WG_T
#undef WG_TN
#undef WG_TC
#undef WG_TK
#undef WG_TFMA
#undef WG_TABS
#undef WG_TCOPYSIGN
#undef WG_BOTH
#endif
