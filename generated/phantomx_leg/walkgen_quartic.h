/* walkgen_quartic.h: real roots of polynomials up to degree four, clusters and double roots included; walkgen_math.h explains the macros.
 *
 * The roots of each derivative cut an interval into pieces on which the next lower derivative is monotonic: at most one root each, found by
 * Newton steps that a bracket guards. Roots up to 1.118 are sought as they are, greater ones as reciprocals, so nothing overflows.
 * An extremum that misses zero by its own rounding is a double root.
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_QUARTIC_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_QUARTIC_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_QUARTIC_F64
#define WG_LIBM(name) name
#define WG_LEAST WG_C(1e-300)
#else
#define WALKGEN_QUARTIC_F32
#define WG_LIBM(name) name##f
#define WG_LEAST WG_C(1e-36)
#endif
#ifndef WG_SPLIT
#define WG_SPLIT WG_C(1.118)
#endif

/* Value of c[0] + ... + c[degree] x^degree, and its derivative. */
static inline WG_REAL WG_NAME(wg_polynomial)(const WG_REAL *c, int degree, WG_REAL x, WG_REAL *slope) {
    WG_REAL value = WG_C(0.0);
    int i;
    *slope = WG_C(0.0);
    for (i = degree; i >= 0; --i) {
        *slope = *slope * x + value;
        value = value * x + c[i];
    }
    return value;
}

/* The sign change between low, where the polynomial is negative or not, and high, where it is the other. */
static inline WG_REAL WG_NAME(wg_bracketed_root)(const WG_REAL *c, int degree, WG_REAL low, WG_REAL high, int negative) {
    WG_REAL slope, before = high - low, last = before, x = WG_C(0.5) * (low + high);
    int i;
    for (i = 0; i < 96; ++i) {
        const WG_REAL value = WG_NAME(wg_polynomial)(c, degree, x, &slope);
        WG_REAL next;
        if (!(WG_ABS(value) > WG_C(0.0))) {
            break;
        }
        if ((value < WG_C(0.0)) == negative) {
            low = x;
        } else {
            high = x;
        }
        next = x - value / slope;
        if (!(next >= low && next <= high && WG_C(2.0) * WG_ABS(next - x) < before)) {
            next = low + WG_C(0.5) * (high - low);
        }
        before = last;
        last = WG_ABS(next - x);
        x = next;
        if (!(last > WG_C(0.5) * WG_EPSILON * WG_ABS(x) && last > WG_LEAST)) {
            break;
        }
    }
    return x;
}

/* The sign changes of a polynomial between consecutive cuts: their number. */
static inline int WG_NAME(wg_sign_changes)(const WG_REAL *c, int degree, const WG_REAL *cuts, int count, WG_REAL *roots) {
    WG_REAL slope;
    int i, found = 0, negative = WG_NAME(wg_polynomial)(c, degree, cuts[0], &slope) < WG_C(0.0);
    for (i = 1; i < count; ++i) {
        const int next = WG_NAME(wg_polynomial)(c, degree, cuts[i], &slope) < WG_C(0.0);
        if (next != negative) {
            roots[found++] = WG_NAME(wg_bracketed_root)(c, degree, cuts[i - 1], cuts[i], negative);
        }
        negative = next;
    }
    return found;
}

/* Whether there is no sign change on either side of cut i, and the value there is at most slack times its terms' magnitudes. */
static inline int WG_NAME(wg_touches)(const WG_REAL *c, int degree, const WG_REAL *cuts, int i, WG_REAL slack) {
    WG_REAL slope, size = WG_C(0.0), largest = WG_C(0.0);
    const WG_REAL value = WG_NAME(wg_polynomial)(c, degree, cuts[i], &slope);
    const int negative = value < WG_C(0.0);
    int k;
    for (k = degree; k >= 0; --k) {
        size = size * WG_ABS(cuts[i]) + WG_ABS(c[k]);
        largest = WG_MAX(largest, WG_ABS(c[k]));
    }
    return negative == (WG_NAME(wg_polynomial)(c, degree, cuts[i - 1], &slope) < WG_C(0.0)) &&
           negative == (WG_NAME(wg_polynomial)(c, degree, cuts[i + 1], &slope) < WG_C(0.0)) && cuts[i] > cuts[i - 1] &&
           cuts[i] < cuts[i + 1] && largest > WG_C(0.0) && WG_ABS(value) <= slack * WG_MAX(size, WG_LEAST * largest);
}

/* Roots in [-bound, bound] in rising order, at most 4: their number. A touching extremum counts twice. */
static inline int WG_NAME(wg_roots_within)(const WG_REAL c[5], WG_REAL bound, WG_REAL slack, WG_REAL roots[4]) {
    WG_REAL cuts[6], crossings[4];
    int level, i, k, count = 2, crossed = 0, found = 0;
    cuts[0] = -bound;
    cuts[1] = bound;
    for (level = 3; level >= 0; --level) {
        WG_REAL derivative[5];
        for (i = level; i < 5; ++i) {
            derivative[i - level] = c[i];
            for (k = 0; k < level; ++k) {
                derivative[i - level] *= (WG_REAL)(i - k);
            }
        }
        crossed = WG_NAME(wg_sign_changes)(derivative, 4 - level, cuts, count, crossings);
        if (level > 0) {
            for (i = 0; i < crossed; ++i) {
                cuts[i + 1] = crossings[i];
            }
            cuts[crossed + 1] = bound;
            count = crossed + 2;
        }
    }
    for (i = 1, k = 0; i <= count - 1 && found < 4; ++i) { /* merge crossings and touching extrema */
        for (; k < crossed && crossings[k] <= cuts[i] && found < 4; ++k) {
            roots[found++] = crossings[k];
        }
        if (i < count - 1 && found < 4 && WG_NAME(wg_touches)(c, 4, cuts, i, slack)) {
            roots[found++] = cuts[i];
            if (found < 4) {
                roots[found++] = cuts[i];
            }
        }
    }
    return found;
}

/* The polynomial times a power of 2 that brings its largest coefficient to [1/2, 1); its degree, -1 for none. */
static inline int WG_NAME(wg_scaled_quartic)(const WG_REAL c[5], WG_REAL scaled[5]) {
    WG_REAL largest = WG_C(0.0);
    int i, exponent = 0, degree = -1;
    for (i = 0; i < 5; ++i) {
        largest = WG_MAX(largest, WG_ABS(c[i]));
    }
    (void)WG_LIBM(frexp)(largest, &exponent);
    for (i = 0; i < 5; ++i) {
        scaled[i] = WG_LIBM(ldexp)(c[i], -exponent);
        degree = WG_ABS(scaled[i]) > WG_C(0.0) ? i : degree;
    }
    return degree;
}

/* Real roots of c[0] + ... + c[4] x^4 in rising order, a double root twice: their number, 0 for the zero polynomial. */
static inline int WG_NAME(wg_quartic_roots)(const WG_REAL c[5], WG_REAL roots[4]) {
    WG_REAL inner[5], outer[5], near_roots[4], far_roots[4];
    const int degree = WG_NAME(wg_scaled_quartic)(c, inner);
    int i, count, near_count, far_count;
    for (i = 0; i < 5; ++i) {
        outer[i] = i <= degree ? inner[degree - i] : WG_C(0.0);
    }
    near_count = WG_NAME(wg_roots_within)(inner, WG_SPLIT, WG_C(16.0) * WG_EPSILON, near_roots);
    far_count = WG_NAME(wg_roots_within)(outer, WG_C(1.0) / WG_SPLIT, WG_C(16.0) * WG_EPSILON, far_roots);
    count = 0;
    for (i = far_count - 1; i >= 0 && count < degree; --i) { /* -1/8, -1/2: -8 comes before -2, and both before the near ones */
        if (far_roots[i] < -WG_LEAST) {
            roots[count++] = WG_C(1.0) / far_roots[i];
        }
    }
    for (i = 0; i < near_count && count < degree; ++i) {
        roots[count++] = near_roots[i];
    }
    for (i = far_count - 1; i >= 0 && count < degree; --i) {
        if (far_roots[i] > WG_LEAST) {
            roots[count++] = WG_C(1.0) / far_roots[i];
        }
    }
    return count;
}

#undef WG_LEAST
#undef WG_LIBM
#endif
