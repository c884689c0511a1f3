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
#ifndef WG_MOST_EDGES
#define WG_MOST_EDGES 4
#endif
#ifndef WG_MOST_MOTION
#define WG_MOST_MOTION ((3 + WG_MOST_EDGES) * (1 + WG_MOST_JOINTS + WG_MOST_JOINTS * WG_MOST_JOINTS))
#endif

/* The foot [3] and so many margins, their slopes [3 + edges][n] and second derivatives [3 + edges][n][n] at q [n]; NaN where there is no
 * foot. A margin has no unit, it is positive where loops close and 0 where they cease to, and goes there in proportion to q. */
typedef void (*WG_NAME(wg_driven_foot))(const WG_REAL *q, WG_REAL *motion, const void *data);

/* q [n] in the caller's lengths, from the scale 2^-size. */
static inline void WG_NAME(wg_driven_values)(int n, const int *slides, int size, const WG_REAL *q, WG_REAL own[WG_MOST_JOINTS]) {
    int j;
    for (j = 0; j < n; ++j) {
        own[j] = slides[j] ? WG_LIBM(ldexp)(q[j], size) : q[j];
    }
}

/* What the function gave, in the scale 2^-size; whether there is a foot and its derivatives are finite. */
static inline int WG_NAME(wg_driven_scaled)(int edges, int n, const int *slides, int size, WG_REAL values[WG_MOST_MOTION]) {
    const int rows = 3 + edges;
    int i, j, k, fine = 1;
    for (i = 0; i < rows; ++i) {
        const int length = i < 3;
        values[i] = WG_LIBM(ldexp)(values[i], -length * size);
        fine = fine && (!length || isfinite(values[i]));
        for (j = 0; j < n; ++j) {
            WG_REAL *slope = values + rows + n * i + j, *bends = values + rows * (1 + n) + n * (n * i + j);
            *slope = WG_LIBM(ldexp)(*slope, (slides[j] - length) * size);
            fine = fine && (!length || isfinite(*slope));
            for (k = 0; k < n; ++k) {
                bends[k] = WG_LIBM(ldexp)(bends[k], (slides[j] + slides[k] - length) * size);
                fine = fine && (!length || isfinite(bends[k]));
            }
        }
    }
    return fine;
}

/* The function in the scale 2^-size, for q in that scale; whether there is a foot and its derivatives are finite. */
static inline int WG_NAME(wg_driven_foot_at)(WG_NAME(wg_driven_foot) motion, const void *data, int edges, int n, const int *slides,
                                             int size, const WG_REAL *q, WG_REAL values[WG_MOST_MOTION]) {
    WG_REAL own[WG_MOST_JOINTS];
    WG_NAME(wg_driven_values)(n, slides, size, q, own);
    motion(own, values, data);
    return WG_NAME(wg_driven_scaled)(edges, n, slides, size, values);
}

#undef WG_LIBM
#endif
