/* walkgen_columns.h: what follows from the Jacobian of a path of many joints in loops; walkgen_math.h explains the macros.
 *
 * J [3][n] holds by columns how the foot moves with each joint, `axes` [3][n] how it turns, zero where a joint slides: both of joints from
 * base to foot. A joint turns the columns of those behind it: dJ_j/dq_i = w_i x J_j for i <= j, which is dJ_i/dq_j as well.
 * Straight-line code does the same in the same time, and compilers take ten times as long over it.
 */
#include "walkgen_math.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_COLUMNS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_COLUMNS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_COLUMNS_F64
#else
#define WALKGEN_COLUMNS_F32
#endif

/* H [3][n][n], d2p / dq_i dq_j. */
WG_CALLED void WG_NAME(wg_second_derivatives)(const WG_REAL *WG_RESTRICT J, const WG_REAL *WG_RESTRICT axes, int32_t n,
                                               WG_REAL *WG_RESTRICT H) {
    WG_REAL *X = H, *Y = H + n * n, *Z = H + 2 * n * n;
    int i, j;
    for (i = 0; i < n; ++i) {
        const WG_REAL a = axes[i], b = axes[n + i], c = axes[2 * n + i];
        X[n * i + i] = WG_FMA(b, J[2 * n + i], -(c * J[n + i]));
        Y[n * i + i] = WG_FMA(c, J[i], -(a * J[2 * n + i]));
        Z[n * i + i] = WG_FMA(a, J[n + i], -(b * J[i]));
        for (j = i + 1; j < n; ++j) {
            X[n * i + j] = X[n * j + i] = WG_FMA(b, J[2 * n + j], -(c * J[n + j]));
            Y[n * i + j] = Y[n * j + i] = WG_FMA(c, J[j], -(a * J[2 * n + j]));
            Z[n * i + j] = Z[n * j + i] = WG_FMA(a, J[n + j], -(b * J[j]));
        }
    }
}

/* rest = a - Jdot qd, what a wanted acceleration of the foot leaves for those of the joints: Jdot qd is the sum of (w_i + w_(i-1)) x J_i qd_i
 * with w_i the angular velocity behind joint i. */
WG_CALLED void WG_NAME(wg_rest_acceleration)(const WG_REAL *WG_RESTRICT J, const WG_REAL *WG_RESTRICT axes, const WG_REAL *WG_RESTRICT qd,
                                              const WG_REAL *WG_RESTRICT a, int32_t n, WG_REAL *WG_RESTRICT rest) {
    WG_REAL u = WG_C(0.0), v = WG_C(0.0), w = WG_C(0.0), X = a[0], Y = a[1], Z = a[2];
    int i;
    for (i = 0; i < n; ++i) {
        const WG_REAL x = qd[i] * J[i], y = qd[i] * J[n + i], z = qd[i] * J[2 * n + i];
        const WG_REAL further = WG_FMA(qd[i], axes[i], u), aside = WG_FMA(qd[i], axes[n + i], v), above = WG_FMA(qd[i], axes[2 * n + i], w);
        u += further;
        v += aside;
        w += above;
        X -= WG_FMA(v, z, -(w * y));
        Y -= WG_FMA(w, x, -(u * z));
        Z -= WG_FMA(u, y, -(v * x));
        u = further;
        v = aside;
        w = above;
    }
    rest[0] = X;
    rest[1] = Y;
    rest[2] = Z;
}

#endif
