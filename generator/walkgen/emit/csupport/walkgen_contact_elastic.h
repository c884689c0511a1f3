/* walkgen_contact_elastic.h: a stand on elastic legs, checked and scaled, and its linear systems; walkgen_math.h explains the macros.
 *
 * Feet are displaced by u = C f + e + (rigid motion delta of the first platform), f the ground's forces on them, e the misfit. Inside,
 * lengths are about the feet's centre in units of the stance's size, forces in units of the load's, compliances in units of C's own size.
 */
#include "walkgen_power.h"
#include "walkgen_status.h"

#if !defined(WALKGEN_MAX_FEET)
#define WALKGEN_MAX_FEET 16
#endif

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_ELASTIC_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_ELASTIC_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_ELASTIC_F64
#define WG_UNIT WG_C(1e-9)
#define WG_LEAST WG_C(1e-11)
#define WG_SIZES 250
#else
#define WALKGEN_CONTACT_ELASTIC_F32
#define WG_UNIT WG_C(1e-5)
#define WG_LEAST WG_C(1e-5)
#define WG_SIZES 30
#endif

/* A stand inside; C is in `block`s where the feet do not share links, else `matrix` has room for C and seven columns [3k, 3k + 7]. */
struct WG_NAME(wg_contact_elastic) {
    int32_t feet;
    WG_REAL r[WALKGEN_MAX_FEET][3], n[WALKGEN_MAX_FEET][3], mu[WALKGEN_MAX_FEET], e[WALKGEN_MAX_FEET][3], w[6];
    WG_REAL block[WALKGEN_MAX_FEET][9], centre[3], length, force, yield, scale; /* powers of 2; scale is 1 / yield */
    const WG_REAL *compliance;
    WG_REAL *matrix;
};

/* Forces and displacements of the feet, and the platform's motion. */
struct WG_NAME(wg_contact_stand) {
    WG_REAL f[WALKGEN_MAX_FEET][3], u[WALKGEN_MAX_FEET][3], delta[6];
};

static inline void WG_NAME(wg_elastic_cross)(const WG_REAL a[3], const WG_REAL b[3], WG_REAL c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline WG_REAL WG_NAME(wg_elastic_dot)(const WG_REAL a[3], const WG_REAL b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* A power of 2 near the largest of some triples; 0 where they are 0, -1 where one is no number or beyond what can be scaled. */
static inline WG_REAL WG_NAME(wg_elastic_size)(const WG_REAL *values, int32_t count) {
    WG_REAL largest = WG_C(0.0), sum = WG_C(0.0);
    int32_t i, exponent;
    for (i = 0; i < count; i += 3) { /* the largest passes over a NaN, the sum does not */
        const WG_REAL a = WG_ABS(values[i]), b = WG_ABS(values[i + 1]), c = WG_ABS(values[i + 2]);
        sum += a + b + c;
        largest = WG_MAX(WG_MAX(a, b), WG_MAX(c, largest));
    }
    if (!(largest > WG_C(0.0)) || !(sum <= WG_HUGE)) {
        return sum <= WG_HUGE ? WG_C(0.0) : WG_C(-1.0);
    }
    exponent = WG_NAME(wg_exponent)(largest);
    return exponent > WG_SIZES || exponent < -WG_SIZES ? WG_C(-1.0) : WG_NAME(wg_power)(exponent);
}

/* C's entry in row and column of two feet, scaled. */
static inline WG_REAL WG_NAME(wg_elastic_entry)(const struct WG_NAME(wg_contact_elastic) * stand, int32_t row, int32_t column) {
    if (stand->matrix == NULL) {
        return row / 3 == column / 3 ? stand->block[row / 3][3 * (row % 3) + column % 3] : WG_C(0.0);
    }
    return stand->compliance[row * 3 * stand->feet + column] * stand->scale;
}

/* Points about their centre, normals and friction: whether they are fine. */
static inline int WG_NAME(wg_elastic_feet)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                           struct WG_NAME(wg_contact_elastic) * stand) {
    const WG_REAL each = WG_C(1.0) / (WG_REAL)k;
    int32_t i;
    int j, fine = WG_NAME(wg_elastic_size)(points, 3 * k) >= WG_C(0.0);
    stand->feet = k;
    for (j = 0; j < 3; ++j) {
        stand->centre[j] = WG_C(0.0);
        for (i = 0; i < k; ++i) {
            stand->centre[j] += each * points[3 * i + j];
        }
    }
    for (i = 0; i < k; ++i) {
        const WG_REAL unit = WG_NAME(wg_elastic_dot)(normals + 3 * i, normals + 3 * i) - WG_C(1.0);
        fine &= (WG_ABS(unit) <= WG_C(2.0) * WG_UNIT) & (mu[i] >= WG_C(0.0));
        stand->mu[i] = mu[i];
        for (j = 0; j < 3; ++j) {
            stand->r[i][j] = points[3 * i + j] - stand->centre[j];
            stand->n[i][j] = normals[3 * i + j];
        }
    }
    return fine;
}

/* Feet, misfit and load: the status, OK or BAD_INPUT. */
static inline int32_t WG_NAME(wg_elastic_place)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                                const WG_REAL *wrench, const WG_REAL *misfit,
                                                struct WG_NAME(wg_contact_elastic) * stand) {
    WG_REAL size, moment[3], shift, per_length, per_force;
    int32_t i, j;
    const int fine = WG_NAME(wg_elastic_feet)(k, points, normals, mu, stand) && WG_NAME(wg_elastic_size)(wrench, 6) >= WG_C(0.0);
    stand->length = WG_NAME(wg_elastic_size)(&stand->r[0][0], 3 * k);
    if (!fine || stand->length < WG_C(0.0)) {
        return WALKGEN_BAD_INPUT;
    }
    stand->length = stand->length > WG_C(0.0) ? stand->length : WG_C(1.0);
    per_length = WG_C(1.0) / stand->length;
    WG_NAME(wg_elastic_cross)(stand->centre, wrench, moment);
    for (j = 0; j < 3; ++j) {
        stand->w[j] = wrench[j];
        stand->w[3 + j] = (wrench[3 + j] - moment[j]) * per_length;
    }
    shift = WG_NAME(wg_elastic_size)(misfit, 3 * k);
    size = WG_NAME(wg_elastic_size)(stand->w, 6);
    if (!(shift >= WG_C(0.0)) || !(size >= WG_C(0.0))) {
        return WALKGEN_BAD_INPUT;
    }
    stand->force = WG_MAX(size, shift * stand->scale);
    stand->force = stand->force > WG_C(0.0) ? stand->force : WG_C(1.0);
    per_force = WG_C(1.0) / stand->force;
    for (j = 0; j < 6; ++j) {
        stand->w[j] *= per_force;
    }
    for (i = 0; i < k; ++i) {
        for (j = 0; j < 3; ++j) {
            stand->r[i][j] *= per_length;
            stand->e[i][j] = misfit[3 * i + j] * per_force * stand->scale;
        }
    }
    return WALKGEN_OK;
}

/* Whether a symmetric A [n, n] (its lower triangle read and overwritten by its factor; rows `stride` apart) is positive. */
static inline int WG_NAME(wg_elastic_factor)(int32_t n, int32_t stride, WG_REAL *A) {
    int32_t i, j, m;
    int fine = 1;
    for (j = 0; j < n; ++j) {
        WG_REAL pivot = A[j * stride + j], inverse;
        const WG_REAL whole = pivot;
        for (m = 0; m < j; ++m) {
            pivot -= A[j * stride + m] * A[j * stride + m];
        }
        fine &= pivot > WG_LEAST * whole;
        inverse = WG_C(1.0) / WG_SQRT(pivot > WG_C(0.0) ? pivot : WG_C(1.0));
        A[j * stride + j] = inverse;
        for (i = j + 1; i < n; ++i) {
            WG_REAL entry = A[i * stride + j];
            for (m = 0; m < j; ++m) {
                entry -= A[i * stride + m] * A[j * stride + m];
            }
            A[i * stride + j] = entry * inverse;
        }
    }
    return fine;
}

/* x = A^-1 x by A's factor. */
static inline void WG_NAME(wg_elastic_resolve)(int32_t n, int32_t stride, const WG_REAL *A, WG_REAL *x) {
    int32_t i, m;
    for (i = 0; i < n; ++i) {
        for (m = 0; m < i; ++m) {
            x[i] -= A[i * stride + m] * x[m];
        }
        x[i] *= A[i * stride + i];
    }
    for (i = n - 1; i >= 0; --i) {
        for (m = i + 1; m < n; ++m) {
            x[i] -= A[m * stride + i] * x[m];
        }
        x[i] *= A[i * stride + i];
    }
}

/* X = A^-1 X by elimination with pivots: A [n, n] and X [n, columns] stand side by side in rows `n + columns` apart;
 * whether A is regular. */
static inline int WG_NAME(wg_elastic_eliminate)(int32_t n, int32_t columns, WG_REAL *A) {
    const int32_t width = n + columns;
    int32_t i, j, m, best;
    for (j = 0; j < n; ++j) {
        best = j;
        for (i = j + 1; i < n; ++i) {
            best = WG_ABS(A[i * width + j]) > WG_ABS(A[best * width + j]) ? i : best;
        }
        if (!(WG_ABS(A[best * width + j]) > WG_LEAST)) {
            return 0;
        }
        for (m = j; m < width && best != j; ++m) {
            const WG_REAL other = A[j * width + m];
            A[j * width + m] = A[best * width + m];
            A[best * width + m] = other;
        }
        for (i = j + 1; i < n; ++i) {
            const WG_REAL factor = A[i * width + j] / A[j * width + j];
            for (m = j + 1; m < width; ++m) {
                A[i * width + m] -= factor * A[j * width + m];
            }
        }
    }
    for (i = n - 1; i >= 0; --i) {
        for (j = n; j < width; ++j) {
            WG_REAL entry = A[i * width + j];
            for (m = i + 1; m < n; ++m) {
                entry -= A[i * width + m] * A[m * width + j];
            }
            A[i * width + j] = entry / A[i * width + i];
        }
    }
    return 1;
}

/* The platform's motion at a foot. */
static inline void WG_NAME(wg_elastic_moved)(const WG_REAL r[3], const WG_REAL delta[6], WG_REAL u[3]) {
    WG_NAME(wg_elastic_cross)(delta + 3, r, u);
    u[0] += delta[0];
    u[1] += delta[1];
    u[2] += delta[2];
}

/* The feet's displacements for forces and a motion. */
static inline void WG_NAME(wg_elastic_displace)(const struct WG_NAME(wg_contact_elastic) * stand, struct WG_NAME(wg_contact_stand) * at) {
    const int32_t k = stand->feet;
    int32_t i, j, row, column;
    for (i = 0; i < k; ++i) {
        WG_NAME(wg_elastic_moved)(stand->r[i], at->delta, at->u[i]);
        for (j = 0; j < 3; ++j) {
            at->u[i][j] += stand->e[i][j];
            if (stand->matrix == NULL) {
                at->u[i][j] += WG_NAME(wg_elastic_dot)(stand->block[i] + 3 * j, at->f[i]);
            }
        }
    }
    for (row = 0; row < 3 * k && stand->matrix != NULL; ++row) {
        for (column = 0; column < 3 * k; ++column) {
            at->u[row / 3][row % 3] += WG_NAME(wg_elastic_entry)(stand, row, column) * at->f[column / 3][column % 3];
        }
    }
}

/* (force, moment about the centre) of a foot's force, added. */
static inline void WG_NAME(wg_elastic_gather)(const WG_REAL r[3], const WG_REAL f[3], WG_REAL factor, WG_REAL *sum, int32_t stride) {
    WG_REAL moment[3];
    int32_t j;
    WG_NAME(wg_elastic_cross)(r, f, moment);
    for (j = 0; j < 3; ++j) {
        sum[j * stride] += factor * f[j];
        sum[(3 + j) * stride] += factor * moment[j];
    }
}

#undef WG_UNIT
#undef WG_LEAST
#undef WG_SIZES
#endif
