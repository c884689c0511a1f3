/* walkgen_damped.h: joint rates of a three-joint leg, damped near singular poses; walkgen_math.h explains the macros.
 *
 * With the singular values s1 >= s2 >= s3 of J: where s3 >= epsilon, qd = J^-1 v, fast where J is surely regular; below,
 * qd = J^T (J J^T + lambda^2 1)^-1 v as walkgen_damped_general.h has it for any number of joints.
 */
#include "walkgen_damped_general.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_DAMPED_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_DAMPED_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_DAMPED_F64
#define WG_SAFE_SQUARE WG_C(1e60) /* cubes and squares of J whose squared norm lies between its inverse and it are safe */
#else
#define WALKGEN_DAMPED_F32
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

/* qd with J qd = v: OK; damped where the least singular value of J is below epsilon: SINGULAR; NaN and BAD_INPUT where an input is
 * not finite, epsilon or lambda_max is negative, or qd would exceed the range of numbers. J is row-major. */
static inline void WG_NAME(wg_damped_inverse_3)(const WG_REAL *WG_RESTRICT J, const WG_REAL *WG_RESTRICT v, WG_REAL epsilon,
                                                WG_REAL lambda_max, WG_REAL *WG_RESTRICT qd, int32_t *WG_RESTRICT status) {
    const int fine = epsilon >= WG_C(0.0) && epsilon <= WG_HUGE && lambda_max >= WG_C(0.0) && lambda_max <= WG_HUGE;
    if (fine && WG_NAME(wg_solve_regular_3)(J, v, epsilon, qd)) {
        *status = WALKGEN_OK;
        return;
    }
#if defined(WALKGEN_NO_DAMPING)
    *status = WG_NAME(wg_undamped)(qd, 3);
#else
    WG_NAME(wg_damped_inverse)(J, v, 3, epsilon, lambda_max, qd, status);
#endif
}

#undef WG_SAFE_SQUARE
#endif
