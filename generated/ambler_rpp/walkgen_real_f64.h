/* walkgen_real_f64.h: support routines included after this work in double; walkgen_math.h explains. */
#include "walkgen_math.h"

#undef WG_REAL
#undef WG_REAL_BITS
#undef WG_UINT
#undef WG_TOGETHER
#undef WG_MASKS
#undef WG_NAME
#undef WG_C
#undef WG_EPSILON
#undef WG_TINY
#undef WG_HUGE
#undef WG_PI
#undef WG_NAN
#undef WG_INFINITY
#undef WG_SIN
#undef WG_COS
#undef WG_TAN
#undef WG_ATAN2
#undef WG_ATAN2_CALLED
#undef WG_LIB_SINCOS
#undef WG_SQRT
#undef WG_ABS
#undef WG_HYPOT
#undef WG_MIN
#undef WG_MAX
#undef WG_INDICATOR
#undef WG_SELECT
#undef WG_STATE
#undef WG_FMA

#define WG_REAL double
#define WG_REAL_BITS 64
#define WG_UINT uint64_t
#define WG_NAME(x) x
#define WG_C(x) x
#define WG_EPSILON 2.220446049250313e-16
#define WG_TINY 2.2250738585072014e-308
#define WG_HUGE 1.7976931348623157e+308
#define WG_PI 3.141592653589793
#define WG_NAN ((double)NAN)
#define WG_INFINITY ((double)INFINITY)
#define WG_TAN(x) tan(x)
#define WG_SQRT(x) sqrt(x)
#define WG_ABS(x) fabs(x)
#define WG_HYPOT(x, y) hypot(x, y)
#define WG_MIN(a, b) walkgen_min(a, b)
#define WG_MAX(a, b) walkgen_max(a, b)
#define WG_INDICATOR(truth) walkgen_indicator(truth)
#define WG_SELECT(truth, a, b) ((truth) ? (a) : (b))
#define WG_STATE int32_t
#if defined(WALKGEN_FAST_FMA)
#define WG_FMA(a, b, c) fma((a), (b), (c))
#else
#define WG_FMA(a, b, c) ((a) * (b) + (c))
#endif

/* Whether compilers make vectors of masks as wide as a number; of 64 bits on x86-64 from SSE4.2 on. */
#if defined(__SSE2__) && !defined(__SSE4_2__)
#define WG_MASKS 0
#else
#define WG_MASKS 1
#endif

/* How many numbers one instruction takes. */
#if defined(WALKGEN_VECTORS)
#define WG_TOGETHER 4
#elif defined(WALKGEN_PAIRS)
#define WG_TOGETHER 2
#else
#define WG_TOGETHER 1
#endif

#if defined(WALKGEN_LIBM)
#define WG_SIN(x) sin(x)
#define WG_COS(x) cos(x)
#define WG_ATAN2(y, x) wg_atan2_lib(y, x)
#define WG_ATAN2_CALLED(y, x) WG_ATAN2(y, x)
#define WG_LIB_SINCOS(x, s, c) wg_sincos_lib(x, s, c)
#else
#define WG_SIN(x) wg_sin(x)
#define WG_COS(x) wg_cos(x)
#define WG_ATAN2(y, x) wg_atan2(y, x)
#define WG_ATAN2_CALLED(y, x) wg_atan2_called(y, x)
#include "walkgen_trig.h"
#endif

#include "walkgen_together.h"
