/* walkgen_driven_foot.h: the foot of a chain that a function describes instead of its axes, such as a leg of closed loops; walkgen_math.h
 * explains the macros.
 *
 * Lengths of the function are the caller's, those of its users are scaled by a power of 2.
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_DRIVEN_FOOT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_DRIVEN_FOOT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_DRIVEN_FOOT_F64
#define WG_LIBM(name) name
#else
#define WALKGEN_DRIVEN_FOOT_F32
#define WG_LIBM(name) name##f
#endif
#ifndef WG_MOST_JOINTS
#define WG_MOST_JOINTS 16
#endif
#ifndef WG_MOST_MOTION
#define WG_MOST_MOTION (3 * (1 + WG_MOST_JOINTS + WG_MOST_JOINTS * WG_MOST_JOINTS))
#endif

/* The foot [3], its Jacobian [3][n] and second derivatives [3][n][n] at q [n]; NaN where there is no foot. */
typedef void (*WG_NAME(wg_driven_foot))(const WG_REAL *q, WG_REAL *motion, const void *data);

/* The same in the scale 2^-size, for q in that scale; whether there is a foot and its derivatives are finite. */
static inline int WG_NAME(wg_driven_foot_at)(WG_NAME(wg_driven_foot) motion, const void *data, int n, const int *slides, int size,
                                             const WG_REAL *q, WG_REAL values[WG_MOST_MOTION]) {
    WG_REAL own[WG_MOST_JOINTS];
    int i, j, k, fine = 1;
    for (j = 0; j < n; ++j) {
        own[j] = slides[j] ? WG_LIBM(ldexp)(q[j], size) : q[j];
    }
    motion(own, values, data);
    for (i = 0; i < 3; ++i) {
        values[i] = WG_LIBM(ldexp)(values[i], -size);
        fine = fine && isfinite(values[i]);
        for (j = 0; j < n; ++j) {
            WG_REAL *slope = values + 3 + n * i + j, *bends = values + 3 + 3 * n + n * (n * i + j);
            *slope = slides[j] ? *slope : WG_LIBM(ldexp)(*slope, -size);
            fine = fine && isfinite(*slope);
            for (k = 0; k < n; ++k) {
                bends[k] = WG_LIBM(ldexp)(bends[k], (slides[j] + slides[k] - 1) * size);
                fine = fine && isfinite(bends[k]);
            }
        }
    }
    return fine;
}

#undef WG_LIBM
#endif
