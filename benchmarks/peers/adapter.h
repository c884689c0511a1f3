/* adapter.h: gives a peer's functions (core_*, defined before this file is included) the one signature that the harness times.
 *
 * The peer's code is in the same unit, so its compiler may inline it here, and the batch is a loop around it: what a user of that
 * generator would write. Outputs of a batch lie port after port. Define WITHOUT_INVERSE where a peer has none.
 */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define RESTRICT __restrict__
#define ENTRY extern "C" __attribute__((visibility("default")))
#else
#define RESTRICT restrict
#define ENTRY __attribute__((visibility("default")))
#endif

#define ROW const double *RESTRICT in, int32_t branch, double *RESTRICT out, int32_t *RESTRICT status
#define ROWS size_t rows, const double *RESTRICT in, const int32_t *RESTRICT branch, double *RESTRICT out, int32_t *RESTRICT status

/* One function: what to call for a row, and for row i of a batch. */
#define ADAPT(name, row, batch_row) \
    ENTRY int32_t bench_##name(ROW); \
    ENTRY size_t bench_##name##_batch(ROWS); \
    ENTRY int32_t bench_##name(ROW) { \
        (void)branch; \
        (void)status; \
        row; \
        return 0; \
    } \
    ENTRY size_t bench_##name##_batch(ROWS) { \
        (void)branch; \
        (void)status; \
        for (size_t i = 0; i < rows; ++i) { \
            batch_row; \
        } \
        return 0; \
    }

ADAPT(foot_position, core_foot_position(in, out), core_foot_position(in + 3 * i, out + 3 * i))
ADAPT(foot_position_jacobian, core_foot_position_jacobian(in, out, out + 3),
      core_foot_position_jacobian(in + 3 * i, out + 3 * i, out + 3 * rows + 9 * i))
ADAPT(foot_hessian, core_foot_hessian(in, out), core_foot_hessian(in + 3 * i, out + 27 * i))

#ifndef WITHOUT_INVERSE
/* The signs (rho, knee) of branches 0 to 3: (+,+), (+,-), (-,+), (-,-). */
static const double branch_signs[4][2] = {{1.0, 1.0}, {1.0, -1.0}, {-1.0, 1.0}, {-1.0, -1.0}};

ADAPT(inverse_branch, core_inverse_branch(in, branch_signs[branch], out),
      core_inverse_branch(in + 3 * i, branch_signs[branch[i]], out + 3 * i))
ADAPT(inverse, core_inverse(in, out), core_inverse(in + 3 * i, out + 12 * i))
#endif
