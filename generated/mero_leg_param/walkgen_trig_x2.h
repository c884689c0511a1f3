/* walkgen_trig_x2.h: two sines and cosines in one vector of doubles, and a third beside; walkgen_trig.h alone includes this, where
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

/* Three sines, then cosines, of angles of which one is beyond the range. They come by memory: compilers that keep numbers in registers over
 * a call save these first on every way. */
WG_CALLED void wg_sincos_far(double x0, double x1, double x2, double far[6]) {
    far[0] = wg_sin(x0), far[1] = wg_sin(x1), far[2] = wg_sin(x2);
    far[3] = wg_cos(x0), far[4] = wg_cos(x1), far[5] = wg_cos(x2);
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
        double far[6];
        wg_sincos_far(x0, x1, x0, far);
        {
            const struct wg_turned_x2 turned = {far[0], far[1], far[3], far[4]};
            return turned;
        }
    }
}

/* Sines and cosines of three angles, the third alone. */
struct wg_turned_x3 {
    double sine0, sine1, sine2, cosine0, cosine1, cosine2;
};

WG_INLINE struct wg_turned_x3 wg_sincos_three(double x0, double x1, double x2) {
    const wg_x2 x = {x0, x1};
    wg_x2 s, c;
    double s2, c2;
    wg_sincos_near_x2(x, &s, &c);
    wg_sincos_near(x2, &s2, &c2);
    if (WG_LIKELY(wg_pair_within(x0, x1) && wg_angle_within(x2))) {
        const struct wg_turned_x3 turned = {s[0], s[1], s2, c[0], c[1], c2};
        return turned;
    } else {
        double far[6];
        wg_sincos_far(x0, x1, x2, far);
        {
            const struct wg_turned_x3 turned = {far[0], far[1], far[2], far[3], far[4], far[5]};
            return turned;
        }
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
