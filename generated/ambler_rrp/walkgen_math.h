/* walkgen_math.h: what generated kernels and support routines share; header only, no symbols.
 *
 * Precision. A support routine is written once, over WG_REAL, and compiled for double or float:
 *
 *     #include "walkgen_real_f64.h"      sets WG_REAL double, WG_NAME(x) x        (or walkgen_real_f32.h: float, x_f32)
 *     #include "walkgen_inverse.h"       defines static inline ... WG_NAME(wg_inverse)(const WG_REAL *q, ...)
 *
 * Both may be included in one file, one after the other. So a support header guards itself by precision, not by name:
 *
 *     #include "walkgen_math.h"
 *     #include "walkgen_status.h"
 *     #if (WG_REAL_BITS == 64 && !defined(WALKGEN_INVERSE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_INVERSE_F32))
 *     #if WG_REAL_BITS == 64
 *     #define WALKGEN_INVERSE_F64
 *     #else
 *     #define WALKGEN_INVERSE_F32
 *     #endif
 *     ...
 *     #endif
 *
 * For the body the precision header gives:
 *     WG_REAL, WG_REAL_BITS        the type; 64 or 32
 *     WG_UINT                      the unsigned integers of as many bits; WG_NAME(walkgen_to_bits)(x) and WG_NAME(walkgen_of_bits)(bits)
 *     WG_NAME(x)                   x or x_f32; use it to define and to call another support routine
 *     WG_C(0.5)                    a literal of that type
 *     WG_EPSILON WG_TINY WG_HUGE WG_PI    unit roundoff times 2, least normal, greatest finite number, pi
 *     WG_SIN WG_COS WG_ATAN2       walkgen_trig.h, which the precision header includes; the C library's with WALKGEN_LIBM
 *     WG_ATAN2_CALLED              the same by a call, where it is not worth the room it takes
 *     WG_SINCOS_2 .. 4, WG_ATAN2_2 .. 4   several at once: WG_SINCOS_2(x, sin_x, cos_x, y, sin_y, cos_y)
 *     WG_MANY_SINCOS_2 .. 4        the same in functions of more than four angles
 *     WG_REST_SINCOS_2 .. 4, WG_REST_ATAN2_2 .. 4   the same in functions that few inputs need
 *     WG_PART(angle, part) WG_TURN(s, c, sine, cosine)   for such an angle that is another of them and a part: walkgen_together.h
 *     WG_NEAR_SINCOS_2 .. 4, WG_NEAR_ATAN2_2 .. 4   the same in functions that leave what is beyond the range to others
 *     WG_TAN WG_SQRT WG_ABS WG_HYPOT
 *     WG_FMA(a, b, c)              a*b + c, rounded once where the target has the instruction, else a product and a sum
 *     WG_MIN(a, b) WG_MAX(a, b)    a < b ? a : b and a > b ? a : b: the second operand where either is NaN
 *     WG_INDICATOR(truth)          1 or 0
 *     WG_SELECT(truth, a, b)       a where it holds, else b
 *     WG_STATE                     the type of a status
 *     WG_NAN WG_INFINITY           a quiet NaN; the positive infinity
 *
 * WALKGEN_LIBM, defined when compiling, selects the C library's sin, cos and atan2: smaller code, slower. It is implied
 * where sums are not rounded as written: by -ffast-math and where the compiler keeps intermediate results wider than their type.
 *
 * WALKGEN_NO_BATCHES leaves `_batch` functions out, WALKGEN_NO_BLOCKS lets them take row after row; WALKGEN_PLAIN selects C99 alone,
 * without vector types: the same bits. NumPy's loops are then without vectors wider than
 * every processor has, whose products and sums are rounded once.
 *
 * WALKGEN_NO_CLOSEST leaves the closest points of yaw-pitch-pitch legs out: rows of unreachable targets are NaN, and UNREACHABLE as before.
 * WALKGEN_NO_DAMPING leaves damped rates of legs of three joints out: where their pose is not surely regular, or an input is not finite, rates
 * are NaN and SINGULAR. Both spare room, with -Os half of a leg's; whatever is answered has the same bits.
 * WALKGEN_SMALL lets functions answer through one another, with -Os in a fifth to a third less room: a part, such as the foot's position,
 * through the whole, with the same bits; all branches of the inverse of a yaw-pitch-pitch leg one after the other; mass matrices through
 * efforts, column by column. They take up to four times as long, and locals of what they call besides; the last two differ from what they
 * give without it by roundings alone.
 *
 * isfinite comes from <math.h>, WG_RESTRICT and the status codes from walkgen_status.h.
 *
 * A part of the code that walkgen generates: yours to use under any terms.
 */
#ifndef WALKGEN_MATH_H
#define WALKGEN_MATH_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "walkgen_status.h"

#if defined(__FAST_MATH__) && !defined(WALKGEN_ALLOW_FAST_MATH)
#error "-ffast-math removes the NaN guards of this code; define WALKGEN_ALLOW_FAST_MATH to build it all the same"
#endif

/* Methods 16 and 32 widen types below float only. */
#if !defined(WALKGEN_LIBM) && (defined(__FAST_MATH__) || !(FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 16 || FLT_EVAL_METHOD == 32))
#define WALKGEN_LIBM
#endif

/* Small functions that callers share work with once they are inlined; where size counts, they are called. */
#if defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define WG_INLINE static inline __attribute__((always_inline))
#else
#define WG_INLINE static inline
#endif
/* Large functions that several others call: one copy each, or compilers write them out again and again. */
#if defined(__GNUC__)
#define WG_CALLED static __attribute__((noinline, unused))
#else
#define WG_CALLED static inline
#endif
/* Whether size counts. */
#if defined(__OPTIMIZE_SIZE__)
#define WG_SIZE_COUNTS 1
#else
#define WG_SIZE_COUNTS 0
#endif
/* Functions that are called at several places: compilers see to them, but where size counts. */
#if WG_SIZE_COUNTS
#define WG_REPEATED WG_CALLED
#else
#define WG_REPEATED static
#endif
#if defined(__GNUC__)
#define WG_LIKELY(condition) __builtin_expect((condition), 1)
#else
#define WG_LIKELY(condition) (condition)
#endif

/* Fused multiply-add only where it is one instruction: a library call would cost a hundred times as much. */
#if !defined(WALKGEN_NO_FMA)
#if defined(FP_FAST_FMA) || defined(__FP_FAST_FMA) || defined(__FMA__) || defined(__AVX512F__) || (defined(__ARM_FEATURE_FMA) && defined(__aarch64__))
#define WALKGEN_FAST_FMA
#endif
#if defined(FP_FAST_FMAF) || defined(__FP_FAST_FMAF) || defined(__FMA__) || defined(__AVX512F__) || defined(__ARM_FEATURE_FMA)
#define WALKGEN_FAST_FMAF
#endif
#endif

/* Four numbers in one instruction, or two doubles: where the compiler has vector types, the target AVX2, or SSE2 alone, and neither size
 * nor the plainest C is asked for. */
#if defined(__GNUC__) && defined(__AVX2__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(WALKGEN_PLAIN) && !defined(WALKGEN_LIBM)
#define WALKGEN_VECTORS
#if defined(__has_builtin)
#if __has_builtin(__builtin_elementwise_fma)
#define WALKGEN_ELEMENTWISE
#endif
#endif
#elif defined(__GNUC__) && defined(__SSE2__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(WALKGEN_PLAIN) && !defined(WALKGEN_LIBM) && !defined(WALKGEN_FAST_FMA)
#define WALKGEN_PAIRS
#endif

/* Rows side by side (walkgen_batch.h): where vectors hold several numbers and speed is asked for. */
#if (defined(__SSE2__) || defined(__aarch64__) || defined(_M_X64)) && !defined(__OPTIMIZE_SIZE__) && !defined(WALKGEN_LIBM) && !defined(WALKGEN_SMALL) && !defined(WALKGEN_NO_BLOCKS)
#define WALKGEN_BLOCKS
#endif

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

/* The C library's functions. Its sincos, called by another name, writes where results are wanted, while compilers copy them. */
#if defined(WALKGEN_LIBM)
#if defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(WALKGEN_PLAIN)
#define WG_NOT_NEGATIVE(x) (__builtin_constant_p((x) < 0) && (x) > 0) /* as far as compilers see */
#if defined(__GLIBC__)
#define WALKGEN_SINCOS
extern void wg_sincos_lib(double x, double *sine, double *cosine) __asm__("sincos");
extern void wg_sincos_lib_f32(float x, float *sine, float *cosine) __asm__("sincosf");
#endif
#else
#define WG_NOT_NEGATIVE(x) 0
#endif
/* Of finite numbers: without half planes to tell, the arctangent of the ratio is enough, in two thirds of the time. */
static inline double wg_atan2_lib(double y, double x) { return WG_NOT_NEGATIVE(x) ? atan(y / x) : atan2(y, x); }
static inline float wg_atan2_lib_f32(float y, float x) { return WG_NOT_NEGATIVE(x) ? atanf(y / x) : atan2f(y, x); }
#endif

static inline double walkgen_min(double a, double b) { return a < b ? a : b; }
static inline double walkgen_max(double a, double b) { return a > b ? a : b; }
static inline float walkgen_min_f32(float a, float b) { return a < b ? a : b; }
static inline float walkgen_max_f32(float a, float b) { return a > b ? a : b; }

/* A number of IEEE 754 as its bits, and back. */
static inline uint64_t walkgen_to_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double walkgen_of_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static inline uint32_t walkgen_to_bits_f32(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline float walkgen_of_bits_f32(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Functions, because gcc reads the conversion of a comparison itself as a selection and may jump. A number at hand is there sooner than
 * one converted, where no vectors are to be made of it. */
#if defined(WALKGEN_LIBM) && !defined(__OPTIMIZE_SIZE__)
static const double walkgen_truths[2] = {0.0, 1.0};
static inline double walkgen_indicator(int truth) { return walkgen_truths[truth != 0]; }
static inline float walkgen_indicator_f32(int truth) { return (float)walkgen_truths[truth != 0]; }
#else
static inline double walkgen_indicator(int truth) { return (double)truth; }
static inline float walkgen_indicator_f32(int truth) { return (float)truth; }
#endif

/* Choices by the bits, for lanes: of a choice between numbers compilers make ways that part, and compute on each. */
static inline double walkgen_select(int truth, double a, double b) {
    const uint64_t mask = 0 - (uint64_t)truth;
    return walkgen_of_bits((walkgen_to_bits(a) & mask) | (walkgen_to_bits(b) & ~mask));
}

static inline float walkgen_select_f32(int truth, float a, float b) {
    const uint32_t mask = 0 - (uint32_t)truth;
    return walkgen_of_bits_f32((walkgen_to_bits_f32(a) & mask) | (walkgen_to_bits_f32(b) & ~mask));
}

#endif
