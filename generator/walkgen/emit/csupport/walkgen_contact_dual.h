/* walkgen_contact_dual.h: the six multipliers of a stance's balance: forces, slope and curvature; walkgen_math.h explains the macros.
 *
 * The forces that minimise half of sum weight |f|^2 under A f = b in cones are f_i = P_i(ease_i A_i' y), P the nearest
 * force in the cone, for the y that maximises the concave b . y - sum of weight |f|^2 / 2. Its slope is b - A f, its
 * second derivative the sum of -A_i P_i' A_i' ease_i, found together with the nearest forces. y grows without bound where
 * the load cannot be carried, in a direction that proves it.
 *
 * The same code serves b . y - |A' y|^2 / 2 - sum of |P_i(centre_i + stretch A_i' y)|^2 / (2 stretch), which always has a maximum.
 */
#include "walkgen_contact_stance.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_DUAL_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_DUAL_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_DUAL_F64
#else
#define WALKGEN_CONTACT_DUAL_F32
#endif

/* Multipliers, what they make of every foot, and the slope; `stretch` and `centre` (NULL: 0) as above, `bound` 1 with |A' y|^2 / 2. */
struct WG_NAME(wg_contact_dual) {
    WG_REAL y[6], slope[6], stretch, bound;
    const WG_REAL (*centre)[WALKGEN_MAX_FEET];
    struct WG_NAME(wg_contact_images) images;
};

/* A symmetric matrix by blocks of forces and moments: A, C (xx, xy, xz, yy, yz, zz), B below A. */
struct WG_NAME(wg_contact_matrix) {
    WG_REAL A[6], B[3][3], C[6];
};

/* The multipliers' products with the feet's forces: y_force + y_moment x r. */
WG_INLINE void WG_NAME(wg_contact_pull)(const struct WG_NAME(wg_contact_stance) * WG_RESTRICT stance, const WG_REAL y[6],
                                        WG_REAL z[3][WALKGEN_MAX_FEET]) {
    const WG_REAL a = y[0], b = y[1], c = y[2], d = y[3], e = y[4], f = y[5];
    const int32_t rows = (stance->feet + 3) & ~3;
    int i;
    for (i = 0; i < rows; ++i) {
        const WG_REAL x = stance->r[0][i], h = stance->r[1][i], k = stance->r[2][i];
        z[0][i] = a + (e * k - f * h);
        z[1][i] = b + (f * x - d * k);
        z[2][i] = c + (d * h - e * x);
    }
}

/* What forces lack of the load: b - A f. */
static inline void WG_NAME(wg_contact_rest)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[3][WALKGEN_MAX_FEET],
                                            WG_REAL rest[6]) {
    WG_REAL sum[6] = {stance->b[0], stance->b[1], stance->b[2], stance->b[3], stance->b[4], stance->b[5]};
    int i;
    for (i = 0; i < stance->feet; ++i) {
        const WG_REAL x = f[0][i], y = f[1][i], z = f[2][i];
        sum[0] -= x;
        sum[1] -= y;
        sum[2] -= z;
        sum[3] -= stance->r[1][i] * z - stance->r[2][i] * y;
        sum[4] -= stance->r[2][i] * x - stance->r[0][i] * z;
        sum[5] -= stance->r[0][i] * y - stance->r[1][i] * x;
    }
    for (i = 0; i < 6; ++i) {
        rest[i] = i > 2 && stance->lost[i - 3] ? WG_C(0.0) : sum[i];
    }
}

/* a . b. */
WG_INLINE WG_REAL WG_NAME(wg_contact_product)(const WG_REAL a[6], const WG_REAL b[6]) {
    return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
}

/* M v of a symmetric matrix (xx, xy, xz, yy, yz, zz). */
WG_INLINE void WG_NAME(wg_contact_apply)(const WG_REAL M[6], const WG_REAL v[3], WG_REAL product[3]) {
    product[0] = M[0] * v[0] + M[1] * v[1] + M[2] * v[2];
    product[1] = M[1] * v[0] + M[3] * v[1] + M[4] * v[2];
    product[2] = M[2] * v[0] + M[4] * v[1] + M[5] * v[2];
}

/* |A' y|^2's slope: (mass y_force, inertia y_moment). */
static inline void WG_NAME(wg_contact_metric)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL product[6]) {
    product[0] = stance->mass * y[0];
    product[1] = stance->mass * y[1];
    product[2] = stance->mass * y[2];
    WG_NAME(wg_contact_apply)(stance->inertia, y + 3, product + 3);
}

/* Forces and slope at dual->y. */
static inline void WG_NAME(wg_contact_evaluate)(const struct WG_NAME(wg_contact_stance) * WG_RESTRICT stance,
                                                struct WG_NAME(wg_contact_dual) * WG_RESTRICT dual) {
    WG_REAL z[3][WALKGEN_MAX_FEET], product[6];
    int i, j;
    WG_NAME(wg_contact_pull)(stance, dual->y, z);
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < ((stance->feet + 3) & ~3); ++i) {
            z[j][i] *= dual->stretch * stance->ease[i];
        }
    }
    for (i = 0; i < 3 * stance->feet && dual->centre; ++i) {
        z[i % 3][i / 3] += dual->centre[i % 3][i / 3];
    }
    WG_NAME(wg_contact_nearest)(&stance->cones, z, &dual->images);
    WG_NAME(wg_contact_rest)(stance, dual->images.f, dual->slope);
    if (dual->bound > WG_C(0.0)) {
        WG_NAME(wg_contact_metric)(stance, dual->y, product);
        for (j = 0; j < 6; ++j) {
            dual->slope[j] -= j > 2 && stance->lost[j - 3] ? WG_C(0.0) : dual->bound * product[j];
        }
    }
}

/* Products of four feet's derivatives with their places: P (6 rows), B = [r] P (9), [r] P [r]' (6). */
WG_INLINE void WG_NAME(wg_contact_bend)(const struct WG_NAME(wg_contact_stance) * WG_RESTRICT stance,
                                        const struct WG_NAME(wg_contact_dual) * WG_RESTRICT dual, int first,
                                        WG_REAL (*WG_RESTRICT four)[4]) {
    int lane;
    for (lane = 0; lane < 4; ++lane) {
        const int i = first + lane;
        const WG_REAL x = stance->r[0][i], y = stance->r[1][i], z = stance->r[2][i], factor = dual->stretch * stance->ease[i];
        const WG_REAL a = factor * dual->images.slope[0][i], b = factor * dual->images.slope[1][i], c = factor * dual->images.slope[2][i];
        const WG_REAL d = factor * dual->images.slope[3][i], e = factor * dual->images.slope[4][i], f = factor * dual->images.slope[5][i];
        const WG_REAL xx = y * c - z * b, xy = y * e - z * d, xz = y * f - z * e, yx = z * a - x * c, yy = z * b - x * e;
        const WG_REAL yz = z * c - x * f, zx = x * b - y * a, zy = x * d - y * b, zz = x * e - y * c;
        four[0][lane] = a;
        four[1][lane] = b;
        four[2][lane] = c;
        four[3][lane] = d;
        four[4][lane] = e;
        four[5][lane] = f;
        four[6][lane] = xx;
        four[7][lane] = xy;
        four[8][lane] = xz;
        four[9][lane] = yx;
        four[10][lane] = yy;
        four[11][lane] = yz;
        four[12][lane] = zx;
        four[13][lane] = zy;
        four[14][lane] = zz;
        four[15][lane] = y * xz - z * xy;
        four[16][lane] = z * xx - x * xz;
        four[17][lane] = x * xy - y * xx;
        four[18][lane] = z * yx - x * yz;
        four[19][lane] = x * yy - y * yx;
        four[20][lane] = x * zy - y * zx;
    }
}

WG_INLINE WG_REAL WG_NAME(wg_contact_four)(const WG_REAL four[4]) { return (four[0] + four[1]) + (four[2] + four[3]); }

/* Minus the second derivative; its diagonal raised by `damping` of that of A A'. */
WG_CALLED void WG_NAME(wg_contact_curvature)(const struct WG_NAME(wg_contact_stance) * stance, const struct WG_NAME(wg_contact_dual) * dual,
                                             WG_REAL damping, struct WG_NAME(wg_contact_matrix) * H) {
    const WG_REAL raised = damping + dual->bound, mass = raised * stance->mass, *I = stance->inertia;
    struct WG_NAME(wg_contact_matrix) sum = {
        {mass, WG_C(0.0), WG_C(0.0), mass, WG_C(0.0), mass},
        {{WG_C(0.0), WG_C(0.0), WG_C(0.0)}, {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, {WG_C(0.0), WG_C(0.0), WG_C(0.0)}},
        {raised * I[0], dual->bound * I[1], dual->bound * I[2], raised * I[3], dual->bound * I[4], raised * I[5]}};
    WG_REAL four[21][4];
    int i, j;
    for (i = 0; i < stance->feet; i += 4) {
        WG_NAME(wg_contact_bend)(stance, dual, i, four);
        for (j = 0; j < 6; ++j) {
            sum.A[j] += WG_NAME(wg_contact_four)(four[j]);
            sum.C[j] += WG_NAME(wg_contact_four)(four[15 + j]);
        }
        for (j = 0; j < 3; ++j) {
            sum.B[0][j] += WG_NAME(wg_contact_four)(four[6 + j]);
            sum.B[1][j] += WG_NAME(wg_contact_four)(four[9 + j]);
            sum.B[2][j] += WG_NAME(wg_contact_four)(four[12 + j]);
        }
    }
    *H = sum;
}

/* M^-1 of a symmetric matrix by its adjugate; its determinant over the cube of `size`. */
WG_INLINE WG_REAL WG_NAME(wg_contact_invert)(const WG_REAL M[6], WG_REAL size, WG_REAL inverse[6]) {
    const WG_REAL a = M[3] * M[5] - M[4] * M[4], b = M[2] * M[4] - M[1] * M[5], c = M[1] * M[4] - M[2] * M[3];
    const WG_REAL determinant = M[0] * a + M[1] * b + M[2] * c, scale = WG_C(1.0) / determinant;
    inverse[0] = scale * a;
    inverse[1] = scale * b;
    inverse[2] = scale * c;
    inverse[3] = scale * (M[0] * M[5] - M[2] * M[2]);
    inverse[4] = scale * (M[1] * M[2] - M[0] * M[4]);
    inverse[5] = scale * (M[0] * M[3] - M[1] * M[1]);
    return determinant / (size * size * size);
}

/* step = H^-1 slope by blocks; whether H is conditioned well enough for that. */
WG_INLINE int WG_NAME(wg_contact_solve_blocks)(const struct WG_NAME(wg_contact_matrix) * H, const WG_REAL slope[6], WG_REAL step[6]) {
    WG_REAL A[6], C[6], S[6], Y[3][3], x[3], rest[3], first, second;
    int i, j;
    first = WG_NAME(wg_contact_invert)(H->A, H->A[0] + H->A[3] + H->A[5], A);
    WG_NAME(wg_contact_apply)(A, slope, x);
    for (i = 0; i < 3; ++i) {
        WG_NAME(wg_contact_apply)(A, H->B[i], Y[i]);
        rest[i] = slope[3 + i] - WG_NAME(wg_dot)(H->B[i], x);
    }
    S[0] = H->C[0] - WG_NAME(wg_dot)(H->B[0], Y[0]);
    S[1] = H->C[1] - WG_NAME(wg_dot)(H->B[0], Y[1]);
    S[2] = H->C[2] - WG_NAME(wg_dot)(H->B[0], Y[2]);
    S[3] = H->C[3] - WG_NAME(wg_dot)(H->B[1], Y[1]);
    S[4] = H->C[4] - WG_NAME(wg_dot)(H->B[1], Y[2]);
    S[5] = H->C[5] - WG_NAME(wg_dot)(H->B[2], Y[2]);
    second = WG_NAME(wg_contact_invert)(S, H->C[0] + H->C[3] + H->C[5], C);
    WG_NAME(wg_contact_apply)(C, rest, step + 3);
    for (j = 0; j < 3; ++j) {
        step[j] = x[j] - (Y[0][j] * step[3] + Y[1][j] * step[4] + Y[2][j] * step[5]);
    }
    return (first > WG_C(1e-5)) & (second > WG_C(1e-8));
}

/* step = H^-1 slope by L D L'; a pivot that rounding made nothing counts as large: nothing moves there. */
WG_CALLED void WG_NAME(wg_contact_solve)(const struct WG_NAME(wg_contact_stance) * stance, const struct WG_NAME(wg_contact_matrix) * H,
                                             const WG_REAL slope[6], WG_REAL step[6]) {
    static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    WG_REAL L[6][6], inverse[6], scaled[6];
    int i, j, m;
    for (j = 0; j < 6; ++j) {
        for (m = 0; m <= j; ++m) {
            L[j][m] = j < 3 ? H->A[place[j][m]] : m < 3 ? H->B[j - 3][m] : H->C[place[j - 3][m - 3]];
        }
    }
    for (j = 0; j < 6; ++j) {
        const WG_REAL size = j < 3 ? stance->mass : stance->inertia[place[j - 3][j - 3]];
        WG_REAL pivot = L[j][j];
        step[j] = slope[j];
        for (m = 0; m < j; ++m) {
            scaled[m] = L[j][m] * inverse[m];
            pivot -= scaled[m] * L[j][m];
        }
        for (m = 0; m < j; ++m) {
            L[j][m] = scaled[m];
            step[j] -= scaled[m] * step[m];
        }
        inverse[j] = pivot > WG_C(0.01) * WG_EPSILON * size && !(j > 2 && stance->lost[j - 3]) ? WG_C(1.0) / pivot : WG_C(0.0);
        for (i = j + 1; i < 6; ++i) {
            for (m = 0; m < j; ++m) {
                L[i][j] -= L[i][m] * L[j][m];
            }
        }
    }
    for (j = 5; j >= 0; --j) {
        step[j] *= inverse[j];
        for (i = j + 1; i < 6; ++i) {
            step[j] -= L[i][j] * step[i];
        }
    }
}

#endif
