/* walkgen_damped_general.h: joint rates of a leg or route of 1 to 16 joints, damped near singular poses; for the macros see walkgen_math.h.
 *
 * With the singular values s1 >= ... >= sm of J, m the lesser of 3 and n: where sm >= epsilon, qd = J^+ v, which of all rates with foot
 * velocity v is the least for n > 3, and whose foot velocity is the closest to v for n < 3. Below, each s of J^+ counts as
 * s + lambda^2 / s with lambda^2 = (1 - (sm/epsilon)^2) lambda_max^2 (Nakamura and Hanafusa 1986; Maciejewski and Klein 1988), that is
 *     qd = J^T (J J^T + lambda^2 1)^-1 v = (J^T J + lambda^2 1)^-1 J^T v,
 * which is continuous at epsilon and keeps |qd| <= |v| / (2 lambda), since s / (s^2 + lambda^2) <= 1 / (2 lambda) for every s.
 * The singular values are those of J itself, not roots of a squared matrix's (one-sided Jacobi, Hestenes 1958).
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_DAMPED_GENERAL_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_DAMPED_GENERAL_F32))
#ifndef WG_MOST_RATES
#define WG_MOST_RATES 16
#endif
#if WG_REAL_BITS == 64
#define WALKGEN_DAMPED_GENERAL_F64
#define WG_LIBM(name) name
#define WG_SAFE_SQUARE WG_C(1e60) /* cubes and squares of J whose squared norm lies between its inverse and it are safe */
#define WG_ATTAINED WG_C(1e-9)
#else
#define WALKGEN_DAMPED_GENERAL_F32
#define WG_LIBM(name) name##f
#define WG_SAFE_SQUARE WG_C(1e10)
#define WG_ATTAINED WG_C(1e-4)
#endif

/* No rates where they would be damped, and the status. */
static inline int32_t WG_NAME(wg_undamped)(WG_REAL *qd, int n) {
    int i;
    for (i = 0; i < n; ++i) {
        qd[i] = WG_NAN;
    }
    return WALKGEN_SINGULAR;
}

/* M V = B with orthogonal columns, one after the other, whose lengths are s: M is J where n <= 3, else its transpose. */
struct WG_NAME(wg_orthogonal) {
    WG_REAL B[3 * WG_MOST_RATES], V[9], s[3];
    int rows, columns;
};

/* The numbers times a power of 2 that brings the largest to [1/2, 1); the exponent taken out. */
static inline int WG_NAME(wg_normalise)(const WG_REAL *values, int count, WG_REAL *scaled) {
    WG_REAL largest = WG_C(0.0);
    int i, exponent = 0;
    for (i = 0; i < count; ++i) {
        largest = WG_MAX(WG_ABS(values[i]), largest);
    }
    (void)WG_LIBM(frexp)(largest, &exponent);
    for (i = 0; i < count; ++i) {
        scaled[i] = WG_LIBM(ldexp)(values[i], -exponent);
    }
    return exponent;
}

static inline WG_REAL WG_NAME(wg_product_of)(const WG_REAL *a, const WG_REAL *b, int count) {
    WG_REAL sum = WG_C(0.0);
    int i;
    for (i = 0; i < count; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* The two columns turned into each other. */
static inline void WG_NAME(wg_turn_columns)(WG_REAL *a, WG_REAL *b, int count, WG_REAL cosine, WG_REAL sine) {
    int i;
    for (i = 0; i < count; ++i) {
        const WG_REAL first = a[i];
        a[i] = cosine * first - sine * b[i];
        b[i] = sine * first + cosine * b[i];
    }
}

/* One Jacobi rotation that makes columns p and q orthogonal; whether it was needed. */
static inline int WG_NAME(wg_rotate_columns)(struct WG_NAME(wg_orthogonal) * m, int p, int q) {
    WG_REAL *a = m->B + m->rows * p, *b = m->B + m->rows * q;
    const WG_REAL alpha = WG_NAME(wg_product_of)(a, a, m->rows), beta = WG_NAME(wg_product_of)(b, b, m->rows);
    const WG_REAL gamma = WG_NAME(wg_product_of)(a, b, m->rows);
    WG_REAL zeta, tangent, cosine;
    if (!(WG_ABS(gamma) > WG_EPSILON * WG_SQRT(alpha) * WG_SQRT(beta))) {
        return 0;
    }
    zeta = (beta - alpha) / (WG_C(2.0) * gamma);
    tangent = (zeta < WG_C(0.0) ? WG_C(-1.0) : WG_C(1.0)) / (WG_ABS(zeta) + WG_HYPOT(WG_C(1.0), zeta));
    cosine = WG_C(1.0) / WG_SQRT(WG_C(1.0) + tangent * tangent);
    WG_NAME(wg_turn_columns)(a, b, m->rows, cosine, cosine * tangent);
    WG_NAME(wg_turn_columns)(m->V + m->columns * p, m->V + m->columns * q, m->columns, cosine, cosine * tangent);
    return 1;
}

/* J's columns, or its rows where it has more than three columns, made orthogonal; the exponent of J's size, taken out. */
static inline int WG_NAME(wg_orthogonal_columns)(const WG_REAL *J, int n, struct WG_NAME(wg_orthogonal) * m) {
    WG_REAL scaled[3 * WG_MOST_RATES];
    const int size = WG_NAME(wg_normalise)(J, 3 * n, scaled);
    int i, k, p, q, sweep, turning = 1;
    m->rows = n > 3 ? n : 3;
    m->columns = n > 3 ? 3 : n;
    for (i = 0; i < 3 * n; ++i) {
        m->B[n > 3 ? i : 3 * (i % n) + i / n] = scaled[i];
    }
    for (i = 0; i < m->columns * m->columns; ++i) {
        m->V[i] = i % (m->columns + 1) == 0 ? WG_C(1.0) : WG_C(0.0);
    }
    for (sweep = 0; sweep < 20 && turning; ++sweep) {
        turning = 0;
        for (p = 0; p < m->columns; ++p) {
            for (q = p + 1; q < m->columns; ++q) {
                turning |= WG_NAME(wg_rotate_columns)(m, p, q);
            }
        }
    }
    for (k = 0; k < m->columns; ++k) {
        m->s[k] = WG_C(0.0);
        for (i = 0; i < m->rows; ++i) {
            m->s[k] = WG_HYPOT(m->s[k], m->B[m->rows * k + i]);
        }
    }
    return size;
}

/* Whether v is a velocity of the foot: what the columns leave of it is nothing but rounding. */
static inline int WG_NAME(wg_is_attained)(const struct WG_NAME(wg_orthogonal) * m, const WG_REAL v[3]) {
    WG_REAL rest[3];
    int i, k;
    for (i = 0; i < 3; ++i) {
        rest[i] = v[i];
    }
    for (k = 0; k < m->columns; ++k) {
        const WG_REAL *column = m->B + 3 * k, along = WG_NAME(wg_product_of)(column, v, 3) / m->s[k];
        for (i = 0; i < 3; ++i) {
            rest[i] -= along * (column[i] / m->s[k]);
        }
    }
    return WG_NAME(wg_product_of)(rest, rest, 3) <= WG_ATTAINED * WG_ATTAINED * WG_NAME(wg_product_of)(v, v, 3);
}

/* The solution by singular values, for finite input of any size, and its status.
 * A direction without extent and without damping gets no rate. */
static inline int32_t WG_NAME(wg_solve_damped)(const WG_REAL *J, const WG_REAL v[3], int n, WG_REAL epsilon, WG_REAL lambda_max,
                                               WG_REAL *qd) {
    struct WG_NAME(wg_orthogonal) m;
    WG_REAL rhs[3], least, limit, lambda = WG_C(0.0);
    const int size = WG_NAME(wg_orthogonal_columns)(J, n, &m), speed = WG_NAME(wg_normalise)(v, 3, rhs);
    int i, k;
    least = m.s[0];
    for (k = 1; k < m.columns; ++k) {
        least = WG_MIN(least, m.s[k]);
    }
    limit = WG_LIBM(ldexp)(epsilon, -size);
    if (least < limit) {
        lambda = WG_LIBM(ldexp)(lambda_max, -size) * WG_SQRT((WG_C(1.0) - least / limit) * (WG_C(1.0) + least / limit));
    }
    for (i = 0; i < n; ++i) {
        qd[i] = WG_C(0.0);
    }
    for (k = 0; k < m.columns; ++k) {
        const WG_REAL *column = m.B + m.rows * k, *turned = m.V + m.columns * k;
        const WG_REAL length = WG_HYPOT(m.s[k], lambda), along = WG_NAME(wg_product_of)(n > 3 ? turned : column, rhs, 3);
        const WG_REAL rate = length > WG_C(0.0) ? along / length / length : WG_C(0.0);
        for (i = 0; i < n; ++i) {
            qd[i] += (n > 3 ? column[i] : turned[i]) * rate;
        }
    }
    for (i = 0; i < n; ++i) {
        qd[i] = WG_LIBM(ldexp)(qd[i], speed - size);
    }
    if (!(least >= limit && least > WG_C(0.0))) {
        return WALKGEN_SINGULAR;
    }
    return n > 2 || WG_NAME(wg_is_attained)(&m, rhs) ? WALKGEN_OK : WALKGEN_UNREACHABLE;
}

/* J^T = Q R by Gram and Schmidt, of J's three rows: Q by rows [3][n], R upper triangular; 1, or 0 where a row adds no direction. */
static inline int WG_NAME(wg_orthonormal_rows)(const WG_REAL *J, int n, WG_REAL *Q, WG_REAL R[9]) {
    int i, k, l;
    for (i = 0; i < 3 * n; ++i) {
        Q[i] = J[i];
    }
    for (k = 0; k < 3; ++k) {
        WG_REAL *row = Q + n * k;
        R[4 * k] = WG_SQRT(WG_NAME(wg_product_of)(row, row, n));
        if (!(R[4 * k] > WG_C(0.0))) {
            return 0;
        }
        for (i = 0; i < n; ++i) {
            row[i] /= R[4 * k];
        }
        for (l = k + 1; l < 3; ++l) {
            R[3 * k + l] = WG_NAME(wg_product_of)(row, Q + n * l, n);
            for (i = 0; i < n; ++i) {
                Q[n * l + i] -= R[3 * k + l] * row[i];
            }
        }
    }
    return 1;
}

/* The least qd with J qd = v where n > 3 and J is surely far from singular and of ordinary size: 1, or 0 with qd undefined.
 * J and R have the same singular values, and |det R| = s1 s2 s3 with s1 s2 <= |J|^2 / 2 (Frobenius), so s3 >= 2 |det R| / |J|^2.
 * The margin of 64 roundings times |J| covers the error of R. One step of refinement takes away what Q lacks in orthogonality. */
static inline int WG_NAME(wg_solve_regular)(const WG_REAL *J, const WG_REAL v[3], int n, WG_REAL epsilon, WG_REAL *qd) {
    WG_REAL Q[3 * WG_MOST_RATES], R[9], rest[3], w[3];
    const WG_REAL square = WG_NAME(wg_product_of)(J, J, 3 * n);
    int i, step, fine = 1;
    if (!(square > WG_C(1.0) / WG_SAFE_SQUARE && square < WG_SAFE_SQUARE) || !WG_NAME(wg_orthonormal_rows)(J, n, Q, R) ||
        !(WG_C(2.0) * R[0] * R[4] * R[8] >= (epsilon + WG_C(64.0) * WG_EPSILON * WG_SQRT(square)) * square)) {
        return 0;
    }
    for (i = 0; i < n; ++i) {
        qd[i] = WG_C(0.0);
    }
    for (step = 0; step < 2; ++step) {
        for (i = 0; i < 3; ++i) {
            rest[i] = v[i] - WG_NAME(wg_product_of)(J + n * i, qd, n);
        }
        w[0] = rest[0] / R[0];
        w[1] = (rest[1] - R[1] * w[0]) / R[4];
        w[2] = (rest[2] - R[2] * w[0] - R[5] * w[1]) / R[8];
        for (i = 0; i < n; ++i) {
            qd[i] += Q[i] * w[0] + Q[n + i] * w[1] + Q[2 * n + i] * w[2];
        }
    }
    for (i = 0; i < n; ++i) {
        fine = fine && isfinite(qd[i]);
    }
    return fine;
}

/* qd = J^+ v: OK, or UNREACHABLE where n < 3 and J qd misses v by more than 1e-9 of |v| (1e-4 in float); damped where the least
 * singular value is below epsilon: SINGULAR; NaN and BAD_INPUT where an input is not finite, epsilon or lambda_max is negative, n is not
 * 1 to 16, or qd would exceed the range of numbers. J is row-major [3][n]. */
WG_CALLED void WG_NAME(wg_damped_inverse)(const WG_REAL *WG_RESTRICT J, const WG_REAL *WG_RESTRICT v, int32_t n, WG_REAL epsilon,
                                           WG_REAL lambda_max, WG_REAL *WG_RESTRICT qd, int32_t *WG_RESTRICT status) {
    int i, fine = epsilon >= WG_C(0.0) && epsilon <= WG_HUGE && lambda_max >= WG_C(0.0) && lambda_max <= WG_HUGE;
    *status = WALKGEN_OK;
    fine = fine && n >= 1 && n <= WG_MOST_RATES;
    if (fine && n > 3 && WG_NAME(wg_solve_regular)(J, v, n, epsilon, qd)) {
        return;
    }
    for (i = 0; fine && i < 3 * n; ++i) {
        fine = isfinite(J[i]) && isfinite(v[i / n]);
    }
    if (fine) {
        *status = WG_NAME(wg_solve_damped)(J, v, n, epsilon, lambda_max, qd);
        for (i = 0; i < n; ++i) {
            fine = fine && isfinite(qd[i]);
        }
    }
    if (!fine) {
        *status = WALKGEN_BAD_INPUT;
        for (i = 0; i < n; ++i) {
            qd[i] = WG_NAN;
        }
    }
}

#undef WG_ATTAINED
#undef WG_SAFE_SQUARE
#undef WG_LIBM
#endif
