/* walkgen_together.h: several sines and cosines, or arctangents, in one statement; included by the precision's header, and again by
 * walkgen_lanes.h, where each lane has an angle of its own and they come one after another.
 */
/* Several sines and cosines, or arctangents, at once: each angle with the two variables, each point (y, x) with the one, that are set. */
#undef WG_SINCOS_2
#undef WG_SINCOS_3
#undef WG_SINCOS_4
#undef WG_MANY_SINCOS_2
#undef WG_MANY_SINCOS_3
#undef WG_MANY_SINCOS_4
#undef WG_REST_SINCOS_2
#undef WG_REST_SINCOS_3
#undef WG_REST_SINCOS_4
#undef WG_REST_ATAN2_2
#undef WG_REST_ATAN2_3
#undef WG_REST_ATAN2_4
#undef WG_ATAN2_2
#undef WG_ATAN2_3
#undef WG_ATAN2_4
#if WG_TOGETHER > 1 && !(defined(WALKGEN_ROWS) && WALKGEN_ROWS == 2)
#define WG_SINCOS_2(a0, s0, c0, a1, s1, c1) \
    do { \
        const struct WG_NAME(wg_turned) wg_turned = WG_NAME(wg_sincos_together)(a0, a1, a0, a1); \
        s0 = wg_turned.sine0, c0 = wg_turned.cosine0, s1 = wg_turned.sine1, c1 = wg_turned.cosine1; \
    } while (0)
#define WG_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) \
    do { \
        const struct WG_NAME(wg_turned) wg_turned = WG_NAME(wg_sincos_together)(a0, a1, a2, a0); \
        s0 = wg_turned.sine0, c0 = wg_turned.cosine0, s1 = wg_turned.sine1, c1 = wg_turned.cosine1, s2 = wg_turned.sine2, c2 = wg_turned.cosine2; \
    } while (0)
#define WG_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) \
    do { \
        const struct WG_NAME(wg_turned) wg_turned = WG_NAME(wg_sincos_together)(a0, a1, a2, a3); \
        s0 = wg_turned.sine0, c0 = wg_turned.cosine0, s1 = wg_turned.sine1, c1 = wg_turned.cosine1; \
        s2 = wg_turned.sine2, c2 = wg_turned.cosine2, s3 = wg_turned.sine3, c3 = wg_turned.cosine3; \
    } while (0)
#define WG_ATAN2_2(y0, x0, r0, y1, x1, r1) \
    do { \
        const struct WG_NAME(wg_angles) wg_angles = WG_NAME(wg_atan2_together)(y0, x0, y1, x1, y0, x0, y1, x1); \
        r0 = wg_angles.angle0, r1 = wg_angles.angle1; \
    } while (0)
#define WG_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2) \
    do { \
        const struct WG_NAME(wg_angles) wg_angles = WG_NAME(wg_atan2_together)(y0, x0, y1, x1, y2, x2, y0, x0); \
        r0 = wg_angles.angle0, r1 = wg_angles.angle1, r2 = wg_angles.angle2; \
    } while (0)
#define WG_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3) \
    do { \
        const struct WG_NAME(wg_angles) wg_angles = WG_NAME(wg_atan2_together)(y0, x0, y1, x1, y2, x2, y3, x3); \
        r0 = wg_angles.angle0, r1 = wg_angles.angle1, r2 = wg_angles.angle2, r3 = wg_angles.angle3; \
    } while (0)
#elif defined(__OPTIMIZE_SIZE__)
#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SINES_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SINES_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SINES_F64
#else
#define WALKGEN_SINES_F32
#endif
/* Where size counts, one call for all: sines, then cosines. */
WG_CALLED void WG_NAME(wg_sines_2)(WG_REAL a0, WG_REAL a1, WG_REAL *turned) {
    turned[0] = WG_SIN(a0), turned[4] = WG_COS(a0);
    turned[1] = WG_SIN(a1), turned[5] = WG_COS(a1);
}
WG_CALLED void WG_NAME(wg_sines_3)(WG_REAL a0, WG_REAL a1, WG_REAL a2, WG_REAL *turned) {
    WG_NAME(wg_sines_2)(a0, a1, turned);
    turned[2] = WG_SIN(a2), turned[6] = WG_COS(a2);
}
WG_CALLED void WG_NAME(wg_sines_4)(WG_REAL a0, WG_REAL a1, WG_REAL a2, WG_REAL a3, WG_REAL *turned) {
    WG_NAME(wg_sines_3)(a0, a1, a2, turned);
    turned[3] = WG_SIN(a3), turned[7] = WG_COS(a3);
}
#endif
#define WG_SINCOS_2(a0, s0, c0, a1, s1, c1) \
    do { \
        WG_REAL wg_turned[8]; \
        WG_NAME(wg_sines_2)(a0, a1, wg_turned); \
        s0 = wg_turned[0], c0 = wg_turned[4], s1 = wg_turned[1], c1 = wg_turned[5]; \
    } while (0)
#define WG_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) \
    do { \
        WG_REAL wg_turned[8]; \
        WG_NAME(wg_sines_3)(a0, a1, a2, wg_turned); \
        s0 = wg_turned[0], c0 = wg_turned[4], s1 = wg_turned[1], c1 = wg_turned[5], s2 = wg_turned[2], c2 = wg_turned[6]; \
    } while (0)
#define WG_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) \
    do { \
        WG_REAL wg_turned[8]; \
        WG_NAME(wg_sines_4)(a0, a1, a2, a3, wg_turned); \
        s0 = wg_turned[0], c0 = wg_turned[4], s1 = wg_turned[1], c1 = wg_turned[5]; \
        s2 = wg_turned[2], c2 = wg_turned[6], s3 = wg_turned[3], c3 = wg_turned[7]; \
    } while (0)
#elif defined(WALKGEN_LIBM)
/* The first last: what turns all the others is needed last, and less is kept over the calls. */
#define WG_SINCOS_2(a0, s0, c0, a1, s1, c1) WG_SINCOS_EACH_2(a1, s1, c1, a0, s0, c0)
#define WG_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) WG_SINCOS_EACH_3(a2, s2, c2, a1, s1, c1, a0, s0, c0)
#define WG_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) WG_SINCOS_EACH_4(a3, s3, c3, a2, s2, c2, a1, s1, c1, a0, s0, c0)
#else
#define WG_SINCOS_2(a0, s0, c0, a1, s1, c1) WG_SINCOS_EACH_2(a0, s0, c0, a1, s1, c1)
#define WG_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) WG_SINCOS_EACH_3(a0, s0, c0, a1, s1, c1, a2, s2, c2)
#define WG_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) WG_SINCOS_EACH_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3)
#endif

#if !defined(WG_ATAN2_2)
#define WG_ATAN2_2(y0, x0, r0, y1, x1, r1) WG_ATAN2_EACH_2(y0, x0, r0, y1, x1, r1)
#define WG_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2) WG_ATAN2_EACH_3(y0, x0, r0, y1, x1, r1, y2, x2, r2)
#define WG_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3) WG_ATAN2_EACH_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3)
#endif

#if !defined(WG_SINCOS_EACH_1)
/* One after another. */
#if defined(WALKGEN_SINCOS)
#define WG_SINCOS_EACH_1(a, s, c) WG_LIB_SINCOS(a, &(s), &(c))
#else
#define WG_SINCOS_EACH_1(a, s, c) s = WG_SIN(a), c = WG_COS(a)
#endif
#define WG_SINCOS_EACH_2(a0, s0, c0, a1, s1, c1) WG_SINCOS_EACH_1(a0, s0, c0), WG_SINCOS_EACH_1(a1, s1, c1)
#define WG_SINCOS_EACH_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) WG_SINCOS_EACH_2(a0, s0, c0, a1, s1, c1), WG_SINCOS_EACH_1(a2, s2, c2)
#define WG_SINCOS_EACH_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) \
    WG_SINCOS_EACH_2(a0, s0, c0, a1, s1, c1), WG_SINCOS_EACH_2(a2, s2, c2, a3, s3, c3)
#define WG_ATAN2_EACH_1(y, x, r) r = WG_ATAN2(y, x)
#define WG_ATAN2_EACH_2(y0, x0, r0, y1, x1, r1) WG_ATAN2_EACH_1(y0, x0, r0), WG_ATAN2_EACH_1(y1, x1, r1)
#define WG_ATAN2_EACH_3(y0, x0, r0, y1, x1, r1, y2, x2, r2) WG_ATAN2_EACH_2(y0, x0, r0, y1, x1, r1), WG_ATAN2_EACH_1(y2, x2, r2)
#define WG_ATAN2_EACH_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3) \
    WG_ATAN2_EACH_2(y0, x0, r0, y1, x1, r1), WG_ATAN2_EACH_2(y2, x2, r2, y3, x3, r3)
#endif

/* An angle that is another one of the same statement and a part. The C library's sines take longer the larger an angle is, so with them the
 * part alone has its sine and cosine, which the other angle's then turn. */
#if !defined(WG_PART)
#if defined(WALKGEN_LIBM) && !defined(__OPTIMIZE_SIZE__)
#define WG_PART(angle, part) ((void)(angle), (part))
#define WG_TURN(s, c, sine, cosine) \
    do { \
        const WG_REAL wg_sine = s; \
        s = WG_FMA(cosine, wg_sine, (sine) * c); \
        c = WG_FMA(cosine, c, -((sine) * wg_sine)); \
    } while (0)
#else
#define WG_PART(angle, part) (angle)
#define WG_TURN(s, c, sine, cosine) (void)0
#endif
#endif

/* The same by calls. */
#if !defined(WG_CALLED_SINCOS_2)
#define WG_CALLED_SINCOS(a, s, c) \
    { \
        const struct WG_NAME(wg_sine_cosine) wg_found = WG_NAME(wg_sincos_called)(a); \
        s = wg_found.sine, c = wg_found.cosine; \
    }
#define WG_CALLED_SINCOS_2(a0, s0, c0, a1, s1, c1) \
    do { \
        WG_CALLED_SINCOS(a0, s0, c0) \
        WG_CALLED_SINCOS(a1, s1, c1) \
    } while (0)
#define WG_CALLED_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) \
    do { \
        WG_CALLED_SINCOS(a0, s0, c0) \
        WG_CALLED_SINCOS(a1, s1, c1) \
        WG_CALLED_SINCOS(a2, s2, c2) \
    } while (0)
#define WG_CALLED_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) \
    do { \
        WG_CALLED_SINCOS(a0, s0, c0) \
        WG_CALLED_SINCOS(a1, s1, c1) \
        WG_CALLED_SINCOS(a2, s2, c2) \
        WG_CALLED_SINCOS(a3, s3, c3) \
    } while (0)
#define WG_CALLED_ATAN2_2(y0, x0, r0, y1, x1, r1) r0 = WG_ATAN2_CALLED(y0, x0), r1 = WG_ATAN2_CALLED(y1, x1)
#define WG_CALLED_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2) WG_CALLED_ATAN2_2(y0, x0, r0, y1, x1, r1), r2 = WG_ATAN2_CALLED(y2, x2)
#define WG_CALLED_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3) \
    WG_CALLED_ATAN2_2(y0, x0, r0, y1, x1, r1), WG_CALLED_ATAN2_2(y2, x2, r2, y3, x3, r3)
#endif

/* The same for a function of many angles: where each comes alone, it is called, or such functions would be little but sines. */
#if defined(WALKGEN_LIBM) || WG_TOGETHER == 4 || defined(WALKGEN_ROWS)
#define WG_MANY_SINCOS_2(a0, s0, c0, a1, s1, c1) WG_SINCOS_2(a0, s0, c0, a1, s1, c1)
#define WG_MANY_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) WG_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2)
#define WG_MANY_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) WG_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3)
#else
#define WG_MANY_SINCOS_2(a0, s0, c0, a1, s1, c1) WG_CALLED_SINCOS_2(a0, s0, c0, a1, s1, c1)
#define WG_MANY_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) WG_CALLED_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2)
#define WG_MANY_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) WG_CALLED_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3)
#endif

/* The same for what few inputs need, which is not worth the room; where size counts all inputs go there. */
#if defined(WALKGEN_LIBM) || WG_SIZE_COUNTS || defined(WALKGEN_ROWS)
#define WG_REST_SINCOS_2(a0, s0, c0, a1, s1, c1) WG_SINCOS_2(a0, s0, c0, a1, s1, c1)
#define WG_REST_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) WG_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2)
#define WG_REST_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) WG_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3)
#define WG_REST_ATAN2_2(y0, x0, r0, y1, x1, r1) WG_ATAN2_2(y0, x0, r0, y1, x1, r1)
#define WG_REST_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2) WG_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2)
#define WG_REST_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3) WG_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3)
#else
#define WG_REST_SINCOS_2(a0, s0, c0, a1, s1, c1) WG_CALLED_SINCOS_2(a0, s0, c0, a1, s1, c1)
#define WG_REST_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) WG_CALLED_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2)
#define WG_REST_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) WG_CALLED_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3)
#define WG_REST_ATAN2_2(y0, x0, r0, y1, x1, r1) WG_CALLED_ATAN2_2(y0, x0, r0, y1, x1, r1)
#define WG_REST_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2) WG_CALLED_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2)
#define WG_REST_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3) WG_CALLED_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3)
#endif

/* The same in a function of usual inputs alone: where an angle or a point is beyond the range, *status becomes UNREACHABLE and the function
 * ends; its caller begins anew elsewhere. With no call on its way a function has no registers to save. */
#undef WG_ANGLES_WITHIN_2
#undef WG_ANGLES_WITHIN_3
#undef WG_ANGLES_WITHIN_4
#undef WG_POINTS_WITHIN_2
#undef WG_POINTS_WITHIN_3
#undef WG_POINTS_WITHIN_4
#if WG_TOGETHER > 1
#define WG_ANGLES_WITHIN_2(a0, a1) WG_NAME(wg_angles_within)(a0, a1, a0, a1)
#define WG_ANGLES_WITHIN_3(a0, a1, a2) WG_NAME(wg_angles_within)(a0, a1, a2, a0)
#define WG_ANGLES_WITHIN_4(a0, a1, a2, a3) WG_NAME(wg_angles_within)(a0, a1, a2, a3)
#define WG_POINTS_WITHIN_2(y0, x0, y1, x1) WG_NAME(wg_points_within)(y0, x0, y1, x1, y0, x0, y1, x1)
#define WG_POINTS_WITHIN_3(y0, x0, y1, x1, y2, x2) WG_NAME(wg_points_within)(y0, x0, y1, x1, y2, x2, y0, x0)
#define WG_POINTS_WITHIN_4(y0, x0, y1, x1, y2, x2, y3, x3) WG_NAME(wg_points_within)(y0, x0, y1, x1, y2, x2, y3, x3)
#else
#define WG_ANGLES_WITHIN_2(a0, a1) 1
#define WG_ANGLES_WITHIN_3(a0, a1, a2) 1
#define WG_ANGLES_WITHIN_4(a0, a1, a2, a3) 1
#define WG_POINTS_WITHIN_2(y0, x0, y1, x1) 1
#define WG_POINTS_WITHIN_3(y0, x0, y1, x1, y2, x2) 1
#define WG_POINTS_WITHIN_4(y0, x0, y1, x1, y2, x2, y3, x3) 1
#endif

/* Lanes go on to the end. */
#undef WG_LEAVE_BEYOND
#if defined(WALKGEN_ROWS) && WALKGEN_ROWS == 2
#define WG_LEAVE_BEYOND(within)
#else
#define WG_LEAVE_BEYOND(within) \
    if (!WG_LIKELY(within)) { \
        *status = WALKGEN_UNREACHABLE; \
        return; \
    }
#endif
#if !defined(WG_NEAR_SINCOS_2)
#define WG_NEAR_SINCOS_2(a0, s0, c0, a1, s1, c1) \
    WG_LEAVE_BEYOND(WG_ANGLES_WITHIN_2(a0, a1)) \
    WG_SINCOS_2(a0, s0, c0, a1, s1, c1)
#define WG_NEAR_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2) \
    WG_LEAVE_BEYOND(WG_ANGLES_WITHIN_3(a0, a1, a2)) \
    WG_SINCOS_3(a0, s0, c0, a1, s1, c1, a2, s2, c2)
#define WG_NEAR_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3) \
    WG_LEAVE_BEYOND(WG_ANGLES_WITHIN_4(a0, a1, a2, a3)) \
    WG_SINCOS_4(a0, s0, c0, a1, s1, c1, a2, s2, c2, a3, s3, c3)
#define WG_NEAR_ATAN2_2(y0, x0, r0, y1, x1, r1) \
    WG_LEAVE_BEYOND(WG_POINTS_WITHIN_2(y0, x0, y1, x1)) \
    WG_ATAN2_2(y0, x0, r0, y1, x1, r1)
#define WG_NEAR_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2) \
    WG_LEAVE_BEYOND(WG_POINTS_WITHIN_3(y0, x0, y1, x1, y2, x2)) \
    WG_ATAN2_3(y0, x0, r0, y1, x1, r1, y2, x2, r2)
#define WG_NEAR_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3) \
    WG_LEAVE_BEYOND(WG_POINTS_WITHIN_4(y0, x0, y1, x1, y2, x2, y3, x3)) \
    WG_ATAN2_4(y0, x0, r0, y1, x1, r1, y2, x2, r2, y3, x3, r3)
#endif
