/* walkgen_tipping.h: how a stiff robot turns about a line between two feet, fast or slow, level or not: an inverted pendulum with
 * phi'' = kappa sin(phi), phi from upright; walkgen_math.h explains the macros.
 *
 * With x = phi / 2, phi'^2 = 4 kappa (a + sin(x)^2), and a keeps its value: elliptic integrals and functions in closed form (Carlson 1979;
 * DLMF 19.29, 22.8 and 22.20).
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_TIPPING_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_TIPPING_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_TIPPING_F64
#define WG_CLOSE WG_C(1e-3)
#else
#define WALKGEN_TIPPING_F32
#define WG_CLOSE WG_C(3e-2)
#endif

/* A motion: half angles' sine, cosine and 1/sqrt(kappa) times their rate, and a; of 1 and 0 in size. */
struct WG_NAME(wg_tipping) {
    WG_REAL x, sine, cosine, pace, energy;
};

/* Its start: 0 where it is none. */
static inline int WG_NAME(wg_tipping_read)(WG_REAL kappa, WG_REAL tilt, WG_REAL rate, struct WG_NAME(wg_tipping) * tipping) {
    if (!(kappa > WG_C(0.0) && kappa <= WG_HUGE && WG_ABS(tilt) < WG_PI)) {
        return 0;
    }
    tipping->x = WG_C(0.5) * tilt;
    tipping->sine = WG_SIN(tipping->x);
    tipping->cosine = WG_COS(tipping->x);
    tipping->pace = WG_C(0.5) * rate / WG_SQRT(kappa);
    tipping->energy = (tipping->pace - tipping->sine) * (tipping->pace + tipping->sine);
    return WG_ABS(tipping->energy) <= WG_HUGE;
}

/* Carlson's R_F of numbers of which at most one is 0. */
static inline WG_REAL WG_NAME(wg_tipping_integral)(WG_REAL x, WG_REAL y, WG_REAL z) {
    WG_REAL mean = (x + y + z) / WG_C(3.0), far = WG_C(1.0), first, second, third;
    int turn;
    for (turn = 0; turn < 60 && far > WG_CLOSE; ++turn) {
        const WG_REAL p = WG_SQRT(x), q = WG_SQRT(y), r = WG_SQRT(z), more = p * q + q * r + r * p;
        x = WG_C(0.25) * (x + more);
        y = WG_C(0.25) * (y + more);
        z = WG_C(0.25) * (z + more);
        mean = (x + y + z) / WG_C(3.0);
        far = WG_MAX(WG_MAX(WG_ABS(mean - x), WG_ABS(mean - y)), WG_ABS(mean - z)) / mean;
    }
    first = (mean - x) / mean;
    second = (mean - y) / mean;
    third = -(first + second);
    x = first * second - third * third;
    y = first * second * third;
    return (WG_C(1.0) - x / WG_C(10.0) + y / WG_C(14.0) + x * x / WG_C(24.0) - WG_C(3.0) * x * y / WG_C(44.0)) / WG_SQRT(mean);
}

/* sqrt(kappa) times the time between half angles below a right angle, on one side of upright: their sines, cosines and squared paces, and
 * the difference of the squares of the sines. */
static inline WG_REAL WG_NAME(wg_tipping_between)(WG_REAL energy, const WG_REAL from[3], const WG_REAL to[3], WG_REAL difference) {
    const WG_REAL root = (to[0] * to[1] * WG_SQRT(from[2]) + from[0] * from[1] * WG_SQRT(to[2])) / difference, square = root * root;
    return WG_NAME(wg_tipping_integral)(square + WG_C(1.0) + energy, WG_MAX(square + energy, WG_C(0.0)), square);
}

/* sqrt(kappa) times the time to the half angle `end` > x, negative where it never comes. */
static inline WG_REAL WG_NAME(wg_tipping_long)(const struct WG_NAME(wg_tipping) * tipping, WG_REAL end) {
    const WG_REAL a = tipping->energy, difference = WG_SIN(end - tipping->x) * WG_SIN(end + tipping->x);
    const WG_REAL start = tipping->pace * tipping->pace, stop = start + difference, turned = WG_SQRT(WG_MAX(-a, WG_C(0.0)));
    const WG_REAL here[3] = {WG_ABS(tipping->sine), tipping->cosine, start};
    const WG_REAL there[3] = {WG_ABS(WG_SIN(end)), WG_COS(end), WG_MAX(stop, WG_C(0.0))};
    const WG_REAL top[3] = {WG_C(0.0), WG_C(1.0), WG_MAX(a, WG_C(0.0))};
    const WG_REAL turn[3] = {turned, WG_SQRT(WG_MAX(WG_C(1.0) + a, WG_C(0.0))), WG_C(0.0)};
    if (tipping->x < WG_C(0.0)) { /* up, and over */
        if (!(tipping->pace > WG_C(0.0)) || !(end > WG_C(0.0) ? a > WG_C(0.0) : stop > WG_C(0.0))) {
            return WG_C(-1.0);
        }
        if (end <= WG_C(0.0)) {
            return WG_NAME(wg_tipping_between)(a, there, here, -difference);
        }
        return WG_NAME(wg_tipping_between)(a, top, here, here[0] * here[0]) +
               WG_NAME(wg_tipping_between)(a, top, there, there[0] * there[0]);
    }
    if (tipping->pace < WG_C(0.0)) { /* back, and down again */
        if (!(a < WG_C(0.0))) {
            return WG_C(-1.0);
        }
        return WG_NAME(wg_tipping_between)(a, turn, here, start) + WG_NAME(wg_tipping_between)(a, turn, there, stop);
    }
    return start > WG_C(0.0) || tipping->sine > WG_C(0.0) ? WG_NAME(wg_tipping_between)(a, here, there, difference) : WG_C(-1.0);
}

/* The time (s) in which a robot that is `tilt` from upright about its line (rad, below 0 over its feet) and turns at `rate` (rad/s) turns
 * on by `turn` (rad, to less than pi from upright). INFEASIBLE and infinite where it never does; BAD_INPUT and NaN. */
static inline void WG_NAME(wg_tipping_time)(WG_REAL kappa, WG_REAL tilt, WG_REAL rate, WG_REAL turn, WG_REAL *WG_RESTRICT time,
                                            int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_tipping) tipping;
    WG_REAL taken = WG_C(0.0);
    *time = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    if (!(turn >= WG_C(0.0) && tilt + turn < WG_PI) || !WG_NAME(wg_tipping_read)(kappa, tilt, rate, &tipping)) {
        return;
    }
    if (turn > WG_C(0.0)) {
        taken = WG_NAME(wg_tipping_long)(&tipping, tipping.x + WG_C(0.5) * turn) / WG_SQRT(kappa);
    }
    *status = taken >= WG_C(0.0) && taken <= WG_HUGE ? WALKGEN_OK : WALKGEN_INFEASIBLE;
    *time = *status == WALKGEN_OK ? taken : WG_INFINITY;
}

/* sn, cn, dn of u and the complementary parameter, by the arithmetic-geometric mean. */
static inline void WG_NAME(wg_tipping_elliptic)(WG_REAL u, WG_REAL complement, WG_REAL found[3]) {
    WG_REAL a[24], c[24], b = WG_SQRT(complement), phi;
    int n = 0;
    a[0] = WG_C(1.0);
    c[0] = WG_C(1.0);
    while (n < 23 && c[n] > WG_EPSILON * a[n]) {
        a[n + 1] = WG_C(0.5) * (a[n] + b);
        c[n + 1] = WG_C(0.5) * (a[n] - b);
        b = WG_SQRT(a[n] * b);
        ++n;
    }
    phi = (WG_REAL)(1L << n) * a[n] * u;
    for (; n > 0; --n) {
        const WG_REAL sine = c[n] / a[n] * WG_SIN(phi);
        phi = WG_C(0.5) * (phi + WG_ATAN2(sine, WG_SQRT((WG_C(1.0) - sine) * (WG_C(1.0) + sine))));
    }
    found[0] = WG_SIN(phi);
    found[1] = WG_COS(phi);
    found[2] = WG_SQRT(complement + (WG_C(1.0) - complement) * found[1] * found[1]);
}

/* sn, cn, dn of a sum, of parameter 1 - complement. */
static inline void WG_NAME(wg_tipping_sum)(WG_REAL complement, const WG_REAL p[3], const WG_REAL q[3], WG_REAL found[3]) {
    const WG_REAL m = WG_C(1.0) - complement, size = p[1] * p[1] + p[0] * p[0] * q[2] * q[2], mixed = m * p[0] * p[1] * q[0] * q[1];
    found[0] = (p[0] * q[1] * q[2] + q[0] * p[1] * p[2]) / size;
    found[1] = (p[1] * q[1] - p[0] * q[0] * p[2] * q[2]) / size;
    found[2] = mixed > WG_C(0.0) ? (complement + m * p[1] * p[1] * q[1] * q[1]) / (p[2] * q[2] + mixed) : (p[2] * q[2] - mixed) / size;
}

/* How far (rad) it has turned from there after a time (s), and its rate (rad/s) then; from upright by less than a whole turn. BAD_INPUT and
 * NaN. */
static inline void WG_NAME(wg_tipping_tilt)(WG_REAL kappa, WG_REAL tilt, WG_REAL rate, WG_REAL time, WG_REAL *WG_RESTRICT turn,
                                            WG_REAL *WG_RESTRICT rate_then, int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_tipping) tipping;
    WG_REAL start[3], step[3], end[3], complement, size, side, sine, cosine, pace;
    *turn = *rate_then = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    if (!(time >= WG_C(0.0)) || !WG_NAME(wg_tipping_read)(kappa, tilt, rate, &tipping) || !(WG_SQRT(kappa) * time <= WG_HUGE)) {
        return;
    }
    *status = WALKGEN_OK;
    if (!(WG_ABS(tipping.sine) + WG_ABS(tipping.pace) > WG_C(0.0))) {
        *turn = *rate_then = WG_C(0.0);
        return;
    }
    size = WG_SQRT(tipping.pace * tipping.pace + tipping.cosine * tipping.cosine); /* sqrt(1 + a) */
    if (tipping.energy < WG_C(0.0)) {                                             /* never upright */
        side = tipping.sine < WG_C(0.0) ? WG_C(-1.0) : WG_C(1.0);
        complement = -tipping.energy;
        start[2] = WG_SQRT(complement) / WG_ABS(tipping.sine);
        start[1] = tipping.cosine * start[2] / size;
        start[0] = side * tipping.pace / (size * WG_ABS(tipping.sine));
        WG_NAME(wg_tipping_elliptic)(WG_SQRT(kappa) * time, complement, step);
        WG_NAME(wg_tipping_sum)(complement, start, step, end);
        sine = WG_SQRT(complement) / end[2];
        cosine = size * end[1] / end[2];
        pace = size * sine * end[0];
    } else { /* over and over */
        side = tipping.pace < WG_C(0.0) ? WG_C(-1.0) : WG_C(1.0);
        complement = WG_MAX(tipping.energy / (size * size), WG_TINY);
        start[0] = tipping.cosine;
        start[1] = -side * tipping.sine;
        start[2] = WG_ABS(tipping.pace) / size;
        WG_NAME(wg_tipping_elliptic)(WG_SQRT(kappa) * time * size, complement, step);
        WG_NAME(wg_tipping_sum)(complement, start, step, end);
        sine = -end[1];
        cosine = end[0];
        pace = size * end[2];
    }
    *turn = WG_C(2.0) * WG_ATAN2(side * sine, cosine) - tilt;
    *rate_then = WG_C(2.0) * WG_SQRT(kappa) * side * pace;
}

/* The least forward speed (m/s) at which a robot that takes a step of `length` (m) has set its foot down before it has turned on by `turn`:
 * length over wg_tipping_time's time, 0 where it never turns so far. */
static inline void WG_NAME(wg_tipping_speed_limit)(WG_REAL length, WG_REAL kappa, WG_REAL tilt, WG_REAL rate, WG_REAL turn,
                                                   WG_REAL *WG_RESTRICT speed, int32_t *WG_RESTRICT status) {
    WG_REAL time;
    WG_NAME(wg_tipping_time)(kappa, tilt, rate, turn, &time, status);
    if (!(length >= WG_C(0.0) && length <= WG_HUGE) || !(turn > WG_C(0.0))) {
        *status = WALKGEN_BAD_INPUT;
    }
    *speed = *status == WALKGEN_BAD_INPUT ? WG_NAN : *status == WALKGEN_INFEASIBLE ? WG_C(0.0) : length / time;
    *status = *status == WALKGEN_INFEASIBLE ? WALKGEN_OK : *status;
}

#undef WG_CLOSE
#endif
