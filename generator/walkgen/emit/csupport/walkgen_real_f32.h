/* walkgen_real_f32.h: support routines included after this work in float; walkgen_math.h explains. */
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

#define WG_REAL float
#define WG_REAL_BITS 32
#define WG_UINT uint32_t
#define WG_NAME(x) x##_f32
#define WG_C(x) x##f
#define WG_EPSILON 1.19209290e-7f
#define WG_TINY 1.17549435e-38f
#define WG_HUGE 3.40282347e+38f
#define WG_PI 3.14159265f
#define WG_NAN ((float)NAN)
#define WG_INFINITY ((float)INFINITY)
#define WG_TAN(x) tanf(x)
#define WG_SQRT(x) sqrtf(x)
#define WG_ABS(x) fabsf(x)
#define WG_HYPOT(x, y) hypotf(x, y)
#define WG_MIN(a, b) walkgen_min_f32(a, b)
#define WG_MAX(a, b) walkgen_max_f32(a, b)
#define WG_INDICATOR(truth) walkgen_indicator_f32(truth)
#define WG_SELECT(truth, a, b) ((truth) ? (a) : (b))
#define WG_STATE int32_t
#if defined(WALKGEN_FAST_FMAF)
#define WG_FMA(a, b, c) fmaf((a), (b), (c))
#else
#define WG_FMA(a, b, c) ((a) * (b) + (c))
#endif

#define WG_MASKS 1

/* How many numbers one instruction takes. */
#if defined(WALKGEN_VECTORS) || defined(WALKGEN_PAIRS)
#define WG_TOGETHER 4
#else
#define WG_TOGETHER 1
#endif

#if defined(WALKGEN_LIBM)
#define WG_SIN(x) sinf(x)
#define WG_COS(x) cosf(x)
#define WG_ATAN2(y, x) wg_atan2_lib_f32(y, x)
#define WG_ATAN2_CALLED(y, x) WG_ATAN2(y, x)
#define WG_LIB_SINCOS(x, s, c) wg_sincos_lib_f32(x, s, c)
#else
#define WG_SIN(x) wg_sin_f32(x)
#define WG_COS(x) wg_cos_f32(x)
#define WG_ATAN2(y, x) wg_atan2_f32(y, x)
#define WG_ATAN2_CALLED(y, x) wg_atan2_called_f32(y, x)
#include "walkgen_trig.h"
#endif

#include "walkgen_together.h"
