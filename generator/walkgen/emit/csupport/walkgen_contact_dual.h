/* walkgen_contact_dual.h: the six multipliers of a stance's balance, led to the least forces; walkgen_math.h explains the macros.
 *
 * The forces that minimise half of sum weight |f|^2 under A f = b in cones are f_i = P_i(ease_i A_i' y), P the nearest force in the cone, for
 * the y that maximises the concave b . y - sum of weight |f|^2 / 2. Its slope is b - A f, its second derivative the sum of -A_i P_i' A_i'
 * ease_i, found together with the nearest forces: Newton, with a search along the line where a cone's boundary is crossed. y grows without
 * bound where the load cannot be carried, in a direction that proves it.
 *
 * The same steps maximise b . y - |A' y|^2 / 2 - sum of |P_i(centre_i + stretch A_i' y)|^2 / (2 stretch), which always has a maximum.
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
    const WG_REAL (*centre)[3];
    struct WG_NAME(wg_contact_image) image[WALKGEN_MAX_FEET];
};

/* The multipliers' product with a foot's force: y_force + y_moment x r. */
WG_INLINE void WG_NAME(wg_contact_pull)(const WG_REAL y[6], const WG_REAL r[3], WG_REAL z[3]) {
    z[0] = y[0] + (y[4] * r[2] - y[5] * r[1]);
    z[1] = y[1] + (y[5] * r[0] - y[3] * r[2]);
    z[2] = y[2] + (y[3] * r[1] - y[4] * r[0]);
}

/* sum += factor (f, r x f). */
WG_INLINE void WG_NAME(wg_contact_push)(const WG_REAL f[3], const WG_REAL r[3], WG_REAL factor, WG_REAL sum[6]) {
    sum[0] += factor * f[0];
    sum[1] += factor * f[1];
    sum[2] += factor * f[2];
    sum[3] += factor * (r[1] * f[2] - r[2] * f[1]);
    sum[4] += factor * (r[2] * f[0] - r[0] * f[2]);
    sum[5] += factor * (r[0] * f[1] - r[1] * f[0]);
}

/* |A' y|^2's slope: (mass y_force, inertia y_moment). */
static inline void WG_NAME(wg_contact_metric)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL product[6]) {
    int i;
    for (i = 0; i < 3; ++i) {
        product[i] = stance->mass * y[i];
        product[3 + i] = WG_NAME(wg_dot)(stance->inertia[i], y + 3);
    }
}

/* Forces and slope at dual->y. */
static inline void WG_NAME(wg_contact_evaluate)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL z[3];
    int i, j;
    for (j = 0; j < 6; ++j) {
        dual->slope[j] = stance->b[j];
    }
    for (i = 0; i < stance->feet; ++i) {
        struct WG_NAME(wg_contact_image) *image = &dual->image[i];
        const WG_REAL factor = dual->stretch * stance->ease[i];
        WG_NAME(wg_contact_pull)(dual->y, stance->r[i], z);
        for (j = 0; j < 3; ++j) {
            z[j] = factor * z[j] + (dual->centre ? dual->centre[i][j] : WG_C(0.0));
        }
        if (stance->cone[i].facets) {
            WG_NAME(wg_contact_nearest_faceted)(&stance->cone[i], z, image);
        } else {
            WG_NAME(wg_contact_nearest)(&stance->cone[i], z, image);
        }
        WG_NAME(wg_contact_push)(image->f, stance->r[i], WG_C(-1.0), dual->slope);
    }
    if (dual->bound > WG_C(0.0)) {
        WG_REAL product[6];
        WG_NAME(wg_contact_metric)(stance, dual->y, product);
        for (j = 0; j < 6; ++j) {
            dual->slope[j] -= dual->bound * product[j];
        }
    }
    for (j = 0; j < 3; ++j) {
        dual->slope[3 + j] = stance->lost[j] ? WG_C(0.0) : dual->slope[3 + j];
    }
}

/* Minus the second derivative, below its diagonal; the diagonal raised by `damping` of that of A A'. */
static inline void WG_NAME(wg_contact_curvature)(const struct WG_NAME(wg_contact_stance) * stance, const struct WG_NAME(wg_contact_dual) * dual,
                                                 WG_REAL damping, WG_REAL H[6][6]) {
    int i, j, m, row;
    for (j = 0; j < 6; ++j) {
        for (m = 0; m < j; ++m) {
            H[j][m] = j > 2 && m > 2 ? dual->bound * stance->inertia[j - 3][m - 3] : WG_C(0.0);
        }
        H[j][j] = (damping + dual->bound) * (j < 3 ? stance->mass : stance->inertia[j - 3][j - 3]);
    }
    for (i = 0; i < stance->feet; ++i) {
        const struct WG_NAME(wg_contact_image) *image = &dual->image[i];
        const WG_REAL *r = stance->r[i], factor = dual->stretch * stance->ease[i];
        if (image->full) {
            const WG_REAL x = factor * r[0], y = factor * r[1], z = factor * r[2];
            H[0][0] += factor;
            H[1][1] += factor;
            H[2][2] += factor;
            H[3][1] -= z;
            H[3][2] += y;
            H[4][0] += z;
            H[4][2] -= x;
            H[5][0] -= y;
            H[5][1] += x;
            H[3][3] += y * r[1] + z * r[2];
            H[4][3] -= x * r[1];
            H[4][4] += x * r[0] + z * r[2];
            H[5][3] -= x * r[2];
            H[5][4] -= y * r[2];
            H[5][5] += x * r[0] + y * r[1];
        }
        for (row = 0; row < image->count; ++row) {
            const WG_REAL share = factor * image->c[row];
            WG_REAL a[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
            WG_NAME(wg_contact_push)(image->v[row], r, WG_C(1.0), a);
            for (j = 0; j < 6; ++j) {
                const WG_REAL scaled = share * a[j];
                for (m = 0; m <= j; ++m) {
                    H[j][m] += scaled * a[m];
                }
            }
        }
    }
}

/* step = H^-1 slope by L D L'; a pivot that rounding made nothing counts as large: nothing moves there. H is overwritten. */
static inline void WG_NAME(wg_contact_solve)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL slope[6], WG_REAL H[6][6],
                                             WG_REAL step[6]) {
    WG_REAL inverse[6], scaled[6];
    int i, j, m;
    for (j = 0; j < 6; ++j) {
        const WG_REAL size = j < 3 ? stance->mass : stance->inertia[j - 3][j - 3];
        WG_REAL pivot = H[j][j];
        step[j] = slope[j];
        for (m = 0; m < j; ++m) {
            scaled[m] = H[j][m] * inverse[m];
            pivot -= scaled[m] * H[j][m];
        }
        for (m = 0; m < j; ++m) {
            H[j][m] = scaled[m];
            step[j] -= scaled[m] * step[m];
        }
        inverse[j] = pivot > WG_C(0.01) * WG_EPSILON * size && !(j > 2 && stance->lost[j - 3]) ? WG_C(1.0) / pivot : WG_C(0.0);
        for (i = j + 1; i < 6; ++i) {
            for (m = 0; m < j; ++m) {
                H[i][j] -= H[i][m] * H[j][m];
            }
        }
    }
    for (j = 5; j >= 0; --j) {
        step[j] *= inverse[j];
        for (i = j + 1; i < 6; ++i) {
            step[j] -= H[i][j] * step[i];
        }
    }
}

/* a . b. */
WG_INLINE WG_REAL WG_NAME(wg_contact_product)(const WG_REAL a[6], const WG_REAL b[6]) {
    return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
}

#endif
