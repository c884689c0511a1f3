/* walkgen_adapt_solve.h: symmetric equations in a robot's chain joints; walkgen_math.h explains the macros. */
#include "walkgen_tree.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_SOLVE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_SOLVE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_SOLVE_F64
#else
#define WALKGEN_ADAPT_SOLVE_F32
#endif

/* matrix^-1 x in place of x, by Cholesky in the lower triangle: whether the matrix is clearly positive definite. */
static inline int WG_NAME(wg_adapt_cholesky)(int n, WG_REAL matrix[WG_TREE_CHAINS][WG_TREE_CHAINS], WG_REAL *x) {
    int i, j, k;
    for (j = 0; j < n; ++j) {
        const WG_REAL diagonal = matrix[j][j];
        for (i = j; i < n; ++i) {
            WG_REAL left = matrix[i][j];
            for (k = 0; k < j; ++k) {
                left -= matrix[i][k] * matrix[j][k];
            }
            matrix[i][j] = left;
        }
        if (!(matrix[j][j] > WG_C(64.0) * WG_EPSILON * diagonal)) {
            return 0;
        }
        matrix[j][j] = WG_SQRT(matrix[j][j]);
        for (i = j + 1; i < n; ++i) {
            matrix[i][j] /= matrix[j][j];
        }
    }
    for (j = 0; j < n; ++j) {
        for (k = 0; k < j; ++k) {
            x[j] -= matrix[j][k] * x[k];
        }
        x[j] /= matrix[j][j];
    }
    for (j = n - 1; j >= 0; --j) {
        for (k = j + 1; k < n; ++k) {
            x[j] -= matrix[k][j] * x[k];
        }
        x[j] /= matrix[j][j];
    }
    return 1;
}

#endif
