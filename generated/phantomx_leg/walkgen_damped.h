/* walkgen_damped.h: joint rates of a three-joint leg, damped near singular poses; walkgen_math.h explains the macros.
 *
 * With the singular values s1 >= s2 >= s3 of J: where s3 >= epsilon, qd = J^-1 v. Below, qd = J^T (J J^T + lambda^2 1)^-1 v with
 * lambda^2 = (1 - (s3/epsilon)^2) lambda_max^2 (Nakamura and Hanafusa 1986; Maciejewski and Klein 1988), which is continuous
 * at epsilon and keeps |qd| <= |v| / (2 lambda), since s / (s^2 + lambda^2) <= 1 / (2 lambda) for every s.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_DAMPED_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_DAMPED_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_DAMPED_F64
#define WG_LIBM(name) name
#define WG_SAFE_SQUARE WG_C(1e60) /* cubes and squares of J whose squared norm lies between its inverse and it are safe */
#else
#define WALKGEN_DAMPED_F32
#define WG_LIBM(name) name##f
#define WG_SAFE_SQUARE WG_C(1e10)
#endif

/* Rows of the adjugate of J (its columns' cross products), row-major. */
static inline void WG_NAME(wg_adjugate_3)(const WG_REAL J[9], WG_REAL A[9]) {
    A[0] = J[4] * J[8] - J[5] * J[7];
    A[1] = J[2] * J[7] - J[1] * J[8];
    A[2] = J[1] * J[5] - J[2] * J[4];
    A[3] = J[5] * J[6] - J[3] * J[8];
    A[4] = J[0] * J[8] - J[2] * J[6];
    A[5] = J[2] * J[3] - J[0] * J[5];
    A[6] = J[3] * J[7] - J[4] * J[6];
    A[7] = J[1] * J[6] - J[0] * J[7];
    A[8] = J[0] * J[4] - J[1] * J[3];
}

/* y = M x, 3 by 3 row-major. */
static inline void WG_NAME(wg_apply_3)(const WG_REAL M[9], const WG_REAL x[3], WG_REAL y[3]) {
    int i;
    for (i = 0; i < 3; ++i) {
        y[i] = M[3 * i] * x[0] + M[3 * i + 1] * x[1] + M[3 * i + 2] * x[2];
    }
}

/* qd = J^-1 v where J is surely far from singular and of ordinary size: 1, or 0 with qd undefined.
 * |det J| = s1 s2 s3 and s1 s2 <= (s1^2 + s2^2) / 2 <= |J|^2 / 2 (Frobenius), so s3 >= 2 |det J| / |J|^2: the test needs no singular
 * value. Its margin of 32 roundings times |J| covers the error of det J. One step of refinement makes the adjugate's answer as good
 * as pivoted elimination's. */
static inline int WG_NAME(wg_solve_regular_3)(const WG_REAL J[9], const WG_REAL v[3], WG_REAL epsilon, WG_REAL qd[3]) {
    WG_REAL A[9], residual[3], correction[3], square = WG_C(0.0), determinant, inverse;
    int i;
    for (i = 0; i < 9; ++i) {
        square += J[i] * J[i];
    }
    if (!(square > WG_C(1.0) / WG_SAFE_SQUARE && square < WG_SAFE_SQUARE)) {
        return 0;
    }
    WG_NAME(wg_adjugate_3)(J, A);
    determinant = J[0] * A[0] + J[1] * A[3] + J[2] * A[6];
    if (!(WG_C(2.0) * WG_ABS(determinant) >= (epsilon + WG_C(32.0) * WG_EPSILON * WG_SQRT(square)) * square)) {
        return 0;
    }
    inverse = WG_C(1.0) / determinant;
    WG_NAME(wg_apply_3)(A, v, qd);
    for (i = 0; i < 3; ++i) {
        qd[i] *= inverse;
    }
    WG_NAME(wg_apply_3)(J, qd, residual);
    for (i = 0; i < 3; ++i) {
        residual[i] = v[i] - residual[i];
    }
    WG_NAME(wg_apply_3)(A, residual, correction);
    for (i = 0; i < 3; ++i) {
        qd[i] += correction[i] * inverse;
    }
    return isfinite(qd[0]) && isfinite(qd[1]) && isfinite(qd[2]);
}

/* One Jacobi rotation of columns p and q of B and V that makes the columns of B orthogonal; whether it was needed. */
static inline int WG_NAME(wg_rotate_columns_3)(WG_REAL B[9], WG_REAL V[9], int p, int q) {
    WG_REAL alpha = WG_C(0.0), beta = WG_C(0.0), gamma = WG_C(0.0), zeta, tangent, cosine, sine;
    int i;
    for (i = 0; i < 9; i += 3) {
        alpha += B[i + p] * B[i + p];
        beta += B[i + q] * B[i + q];
        gamma += B[i + p] * B[i + q];
    }
    if (!(WG_ABS(gamma) > WG_EPSILON * WG_SQRT(alpha) * WG_SQRT(beta))) {
        return 0;
    }
    zeta = (beta - alpha) / (WG_C(2.0) * gamma);
    tangent = (zeta < WG_C(0.0) ? WG_C(-1.0) : WG_C(1.0)) / (WG_ABS(zeta) + WG_HYPOT(WG_C(1.0), zeta));
    cosine = WG_C(1.0) / WG_SQRT(WG_C(1.0) + tangent * tangent);
    sine = cosine * tangent;
    for (i = 0; i < 9; i += 3) {
        const WG_REAL b = B[i + p], v = V[i + p];
        B[i + p] = cosine * b - sine * B[i + q];
        B[i + q] = sine * b + cosine * B[i + q];
        V[i + p] = cosine * v - sine * V[i + q];
        V[i + q] = sine * v + cosine * V[i + q];
    }
    return 1;
}

/* B = J V with orthogonal columns, whose lengths are the singular values of J (one-sided Jacobi, Hestenes 1958); J of size about 1. */
static inline void WG_NAME(wg_singular_values_3)(WG_REAL B[9], WG_REAL V[9], WG_REAL s[3]) {
    int i, sweep, turning = 1;
    for (i = 0; i < 9; ++i) {
        V[i] = i % 4 == 0 ? WG_C(1.0) : WG_C(0.0);
    }
    for (sweep = 0; sweep < 20 && turning; ++sweep) {
        turning = WG_NAME(wg_rotate_columns_3)(B, V, 0, 1);
        turning |= WG_NAME(wg_rotate_columns_3)(B, V, 0, 2);
        turning |= WG_NAME(wg_rotate_columns_3)(B, V, 1, 2);
    }
    for (i = 0; i < 3; ++i) {
        s[i] = WG_HYPOT(WG_HYPOT(B[i], B[i + 3]), B[i + 6]);
    }
}

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

/* The damped solution by singular values, for finite input of any size; whether it is the undamped one.
 * A direction without extent and without damping gets no rate. */
static inline int WG_NAME(wg_solve_damped_3)(
    const WG_REAL J[9], const WG_REAL v[3], WG_REAL epsilon, WG_REAL lambda_max, WG_REAL qd[3]) {
    WG_REAL B[9], V[9], s[3], rhs[3], rates[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, least, limit, lambda = WG_C(0.0);
    const int size = WG_NAME(wg_normalise)(J, 9, B), speed = WG_NAME(wg_normalise)(v, 3, rhs);
    int i, k;
    WG_NAME(wg_singular_values_3)(B, V, s);
    least = WG_MIN(s[0], WG_MIN(s[1], s[2]));
    limit = WG_LIBM(ldexp)(epsilon, -size);
    if (least < limit) {
        lambda = WG_LIBM(ldexp)(lambda_max, -size) * WG_SQRT((WG_C(1.0) - least / limit) * (WG_C(1.0) + least / limit));
    }
    for (k = 0; k < 3; ++k) {
        const WG_REAL length = WG_HYPOT(s[k], lambda);
        const WG_REAL along = B[k] * rhs[0] + B[k + 3] * rhs[1] + B[k + 6] * rhs[2];
        const WG_REAL rate = length > WG_C(0.0) ? along / length / length : WG_C(0.0);
        for (i = 0; i < 3; ++i) {
            rates[i] += V[3 * i + k] * rate;
        }
    }
    for (i = 0; i < 3; ++i) {
        qd[i] = WG_LIBM(ldexp)(rates[i], speed - size);
    }
    return least >= limit && least > WG_C(0.0);
}

/* qd with J qd = v: OK; damped where the least singular value of J is below epsilon: SINGULAR; NaN and BAD_INPUT where an input is
 * not finite, epsilon or lambda_max is negative, or qd would exceed the range of numbers. J is row-major. */
static inline void WG_NAME(wg_damped_inverse_3)(const WG_REAL *WG_RESTRICT J, const WG_REAL *WG_RESTRICT v, WG_REAL epsilon,
                                                WG_REAL lambda_max, WG_REAL *WG_RESTRICT qd, int32_t *WG_RESTRICT status) {
    int i, fine = epsilon >= WG_C(0.0) && epsilon <= WG_HUGE && lambda_max >= WG_C(0.0) && lambda_max <= WG_HUGE;
    *status = WALKGEN_OK;
    if (fine && WG_NAME(wg_solve_regular_3)(J, v, epsilon, qd)) {
        return;
    }
    for (i = 0; i < 9; ++i) {
        fine = fine && isfinite(J[i]) && (i >= 3 || isfinite(v[i]));
    }
    if (fine) {
        *status = WG_NAME(wg_solve_damped_3)(J, v, epsilon, lambda_max, qd) ? WALKGEN_OK : WALKGEN_SINGULAR;
        fine = isfinite(qd[0]) && isfinite(qd[1]) && isfinite(qd[2]);
    }
    if (!fine) {
        *status = WALKGEN_BAD_INPUT;
        qd[0] = qd[1] = qd[2] = WG_NAN;
    }
}

#undef WG_SAFE_SQUARE
#undef WG_LIBM
#endif
