/* walkgen_conic_cones.h: cones of three numbers, (normal, two tangential parts) with normal >= |tangential|; walkgen_math.h explains the
 * macros. */
#include "walkgen_stance.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONIC_CONES_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONIC_CONES_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONIC_CONES_F64
#else
#define WALKGEN_CONIC_CONES_F32
#endif

/* Inner product of rows. */
static inline WG_REAL WG_NAME(wg_conic_product)(int n, const WG_REAL *a, const WG_REAL *b) {
    WG_REAL sum = WG_C(0.0);
    int i;
    for (i = 0; i < n; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* x0^2 - x1^2 - x2^2 of a vector in the cone, without the loss of squares. */
static inline WG_REAL WG_NAME(wg_conic_size)(const WG_REAL x[3]) {
    const WG_REAL along = WG_SQRT(x[1] * x[1] + x[2] * x[2]);
    return (x[0] - along) * (x[0] + along);
}

/* The product of a symmetric matrix and a vector. */
static inline void WG_NAME(wg_conic_apply)(const WG_REAL W[6], const WG_REAL v[3], WG_REAL product[3]) {
    product[0] = W[0] * v[0] + W[1] * v[1] + W[2] * v[2];
    product[1] = W[1] * v[0] + W[3] * v[1] + W[4] * v[2];
    product[2] = W[2] * v[0] + W[4] * v[1] + W[5] * v[2];
}

/* Nesterov and Todd's V of a cone: V z = V^-1 x. */
static inline void WG_NAME(wg_conic_scaling)(const WG_REAL x[3], const WG_REAL z[3], WG_REAL V[6]) {
    const WG_REAL of_x = WG_SQRT(WG_NAME(wg_conic_size)(x)), of_z = WG_SQRT(WG_NAME(wg_conic_size)(z)), beta = WG_SQRT(of_x / of_z);
    const WG_REAL inner = (x[0] * z[0] + x[1] * z[1] + x[2] * z[2]) / of_x / of_z;
    const WG_REAL share = WG_C(1.0) / WG_SQRT(WG_C(2.0) * (WG_C(1.0) + inner)), w = share * (x[0] / of_x + z[0] / of_z);
    const WG_REAL half = WG_C(1.0) / WG_SQRT(WG_C(2.0) * (w + WG_C(1.0))), p = half * (w + WG_C(1.0));
    const WG_REAL q = half * share * (x[1] / of_x - z[1] / of_z), r = half * share * (x[2] / of_x - z[2] / of_z);
    V[0] = beta * (WG_C(2.0) * p * p - WG_C(1.0));
    V[1] = beta * WG_C(2.0) * p * q;
    V[2] = beta * WG_C(2.0) * p * r;
    V[3] = beta * (WG_C(2.0) * q * q + WG_C(1.0));
    V[4] = beta * WG_C(2.0) * q * r;
    V[5] = beta * (WG_C(2.0) * r * r + WG_C(1.0));
}

/* C of C C' = 1 + V mass V, lower triangle by columns. */
static inline void WG_NAME(wg_conic_weigh)(const WG_REAL V[6], const WG_REAL mass[3], WG_REAL C[6]) {
    const WG_REAL W[3][3] = {{V[0], V[1], V[2]}, {V[1], V[3], V[4]}, {V[2], V[4], V[5]}};
    WG_REAL N[6];
    int i, j, m, place = 0;
    for (i = 0; i < 3; ++i) {
        for (j = i; j < 3; ++j, ++place) {
            N[place] = i == j ? WG_C(1.0) : WG_C(0.0);
            for (m = 0; m < 3; ++m) {
                N[place] += W[i][m] * mass[m] * W[j][m];
            }
        }
    }
    C[0] = WG_SQRT(N[0]);
    C[1] = N[1] / C[0];
    C[2] = N[2] / C[0];
    C[3] = WG_SQRT(N[3] - C[1] * C[1]);
    C[4] = (N[4] - C[1] * C[2]) / C[3];
    C[5] = WG_SQRT(N[5] - C[2] * C[2] - C[4] * C[4]);
}

/* C^-1 v in place of v, or C^-T v. */
static inline void WG_NAME(wg_conic_lighten)(const WG_REAL C[6], int transposed, WG_REAL v[3]) {
    if (transposed) {
        v[2] /= C[5];
        v[1] = (v[1] - C[4] * v[2]) / C[3];
        v[0] = (v[0] - C[1] * v[1] - C[2] * v[2]) / C[0];
    } else {
        v[0] /= C[0];
        v[1] = (v[1] - C[1] * v[0]) / C[3];
        v[2] = (v[2] - C[2] * v[0] - C[4] * v[1]) / C[5];
    }
}

/* u of the cones' product e u = d (-e - d): by how much x and z, moved by V d and as far as that takes z, miss complementarity. */
static inline void WG_NAME(wg_conic_missed)(const WG_REAL e[3], WG_REAL size, const WG_REAL d[3], WG_REAL u[3]) {
    const WG_REAL other[3] = {-e[0] - d[0], -e[1] - d[1], -e[2] - d[2]}, v = WG_NAME(wg_dot)(d, other);
    const WG_REAL p = d[0] * other[1] + other[0] * d[1], q = d[0] * other[2] + other[0] * d[2];
    u[0] = (e[0] * v - e[1] * p - e[2] * q) / size;
    u[1] = (p - e[1] * u[0]) / e[0];
    u[2] = (q - e[2] * u[0]) / e[0];
}

/* How far along d the points x stay in their cones, at most 1e9. */
static inline WG_REAL WG_NAME(wg_conic_room)(int cones, const WG_REAL *x, const WG_REAL *d) {
    WG_REAL room = WG_C(1e9);
    int c;
    for (c = 0; c < 3 * cones; c += 3) {
        const WG_REAL square = d[c] * d[c] - d[c + 1] * d[c + 1] - d[c + 2] * d[c + 2], size = WG_NAME(wg_conic_size)(x + c);
        const WG_REAL mixed = x[c] * d[c] - x[c + 1] * d[c + 1] - x[c + 2] * d[c + 2], under = mixed * mixed - square * size;
        const WG_REAL below = under > WG_C(0.0) ? WG_SQRT(under) - mixed : -mixed; /* not negative but for rounding */
        if (below > WG_C(0.0)) {
            room = WG_MIN(room, size / below);
        }
    }
    return room;
}

/* Whether points x stay inside their cones `length` along d. */
static inline int WG_NAME(wg_conic_stays)(int cones, const WG_REAL *x, const WG_REAL *d, WG_REAL length) {
    int fine = 1, c;
    for (c = 0; c < 3 * cones; c += 3) {
        const WG_REAL next[3] = {x[c] + length * d[c], x[c + 1] + length * d[c + 1], x[c + 2] + length * d[c + 2]};
        fine &= next[0] > WG_C(0.0) && WG_NAME(wg_conic_size)(next) > WG_C(0.0);
    }
    return fine;
}

#endif
