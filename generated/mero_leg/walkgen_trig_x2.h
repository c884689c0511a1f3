/* walkgen_trig_x2.h: four sines and cosines, or four arctangents, in two vectors of two doubles; walkgen_trig.h alone includes this,
 * where WG_TOGETHER is 2. Lane by lane the bits of a single number. A vector never crosses a function that is not inlined.
 */
#if defined(WG_FARTHEST)
typedef double wg_x2 __attribute__((vector_size(16)));
typedef uint64_t wg_bits_x2 __attribute__((vector_size(16)));
#define WG_T wg_x2
#define WG_TBITS wg_bits_x2
#define WG_TN(x) x##_x2
#define WG_TC(x) wg_both(x)
#define WG_TK(x) wg_both(x)
#define WG_TFMA(a, b, c) ((a) * (b) + (c))
#define WG_TLESS(a, b) ((WG_TBITS)((a) < (b)))
#define WG_TABS(x) wg_abs_x2(x)
#define WG_TCOPYSIGN(x, sign) wg_copysign_x2(x, sign)
#define WG_BOTH(mask) (__builtin_ia32_movmskpd((wg_x2)(mask)) == 3)

WG_INLINE wg_x2 wg_both(double x) {
    const wg_x2 both = {x, x};
    return both;
}

WG_INLINE wg_x2 wg_abs_x2(wg_x2 x) { return (wg_x2)((wg_bits_x2)x & ~WG_SIGN); }

WG_INLINE wg_x2 wg_copysign_x2(wg_x2 x, wg_x2 sign) { return (wg_x2)(((wg_bits_x2)x & ~WG_SIGN) | ((wg_bits_x2)sign & WG_SIGN)); }

WG_INLINE wg_bits_x2 walkgen_to_bits_x2(wg_x2 x) { return (wg_bits_x2)x; }

WG_INLINE wg_x2 walkgen_of_bits_x2(wg_bits_x2 bits) { return (wg_x2)bits; }

#include "walkgen_trig_kernel.h"

/* Whether all angles lie within the range of the polynomials. */
WG_INLINE int wg_angles_within(double x0, double x1, double x2, double x3) {
    const wg_x2 first = {x0, x1}, second = {x2, x3};
    return WG_BOTH((WG_TABS(first) <= WG_TK(WG_FARTHEST)) & (WG_TABS(second) <= WG_TK(WG_FARTHEST)));
}

/* Four sines, then cosines, of angles of which one is beyond the range. They come by memory: compilers that keep numbers in registers over
 * a call save these first on every way. */
WG_CALLED void wg_sincos_far(double x0, double x1, double x2, double x3, struct wg_turned *turned) {
    struct wg_sine_cosine turn = wg_sincos_called(x0);
    turned->sine0 = turn.sine, turned->cosine0 = turn.cosine;
    turn = wg_sincos_called(x1);
    turned->sine1 = turn.sine, turned->cosine1 = turn.cosine;
    turn = wg_sincos_called(x2);
    turned->sine2 = turn.sine, turned->cosine2 = turn.cosine;
    turn = wg_sincos_called(x3);
    turned->sine3 = turn.sine, turned->cosine3 = turn.cosine;
}

WG_INLINE struct wg_turned wg_sincos_together(double x0, double x1, double x2, double x3) {
    const wg_x2 first = {x0, x1}, second = {x2, x3};
    wg_x2 s, c, s2, c2;
    wg_sincos_near_x2(first, &s, &c);
    wg_sincos_near_x2(second, &s2, &c2);
    if (WG_LIKELY(wg_angles_within(x0, x1, x2, x3))) {
        const struct wg_turned turned = {s[0], s[1], s2[0], s2[1], c[0], c[1], c2[0], c2[1]};
        return turned;
    } else {
        struct wg_turned far;
        wg_sincos_far(x0, x1, x2, x3, &far);
        return far;
    }
}

/* Whether all points lie within the range. */
WG_INLINE int wg_points_within(double y0, double x0, double y1, double x1, double y2, double x2, double y3, double x3) {
    const wg_x2 first_y = {y0, y1}, first_x = {x0, x1}, second_y = {y2, y3}, second_x = {x2, x3};
    wg_x2 first, second;
    (void)wg_atan2_near_x2(first_y, first_x, &first, 0);
    (void)wg_atan2_near_x2(second_y, second_x, &second, 0);
    return WG_BOTH((first > WG_TC(0.0)) & (first <= WG_TK(WG_GREATEST)) & (second > WG_TC(0.0)) & (second <= WG_TK(WG_GREATEST)));
}

/* Angles of points of which one is beyond the range; by memory, as above. */
WG_CALLED void wg_atan2_far(double y0, double x0, double y1, double x1, double y2, double x2, double y3, double x3, struct wg_angles *angles) {
    angles->angle0 = wg_atan2_called(y0, x0), angles->angle1 = wg_atan2_called(y1, x1);
    angles->angle2 = wg_atan2_called(y2, x2), angles->angle3 = wg_atan2_called(y3, x3);
}

WG_INLINE struct wg_angles wg_atan2_together(double y0, double x0, double y1, double x1, double y2, double x2, double y3, double x3) {
    const wg_x2 first_y = {y0, y1}, first_x = {x0, x1}, second_y = {y2, y3}, second_x = {x2, x3};
    wg_x2 first, second;
    const wg_x2 a = wg_atan2_near_x2(first_y, first_x, &first, 0), b = wg_atan2_near_x2(second_y, second_x, &second, 0);
    if (WG_LIKELY(wg_points_within(y0, x0, y1, x1, y2, x2, y3, x3))) {
        const struct wg_angles angles = {a[0], a[1], b[0], b[1]};
        return angles;
    } else {
        struct wg_angles far;
        wg_atan2_far(y0, x0, y1, x1, y2, x2, y3, x3, &far);
        return far;
    }
}

#undef WG_T
#undef WG_TBITS
#undef WG_TN
#undef WG_TC
#undef WG_TK
#undef WG_TFMA
#undef WG_TABS
#undef WG_TLESS
#undef WG_TCOPYSIGN
#undef WG_BOTH
#endif
