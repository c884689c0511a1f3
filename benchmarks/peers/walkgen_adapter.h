/* walkgen_adapter.h: walkgen's functions under the signature that the harness times, with their statuses and their own batches. */
#include <stddef.h>
#include <stdint.h>

#define ENTRY __attribute__((visibility("default")))
#define ROW const double *restrict in, int32_t branch, double *restrict out, int32_t *restrict status
#define ROWS size_t rows, const double *restrict in, const int32_t *restrict branch, double *restrict out, int32_t *restrict status

#define ADAPT(name, row, batch) \
    ENTRY int32_t bench_##name(ROW); \
    ENTRY size_t bench_##name##_batch(ROWS); \
    ENTRY int32_t bench_##name(ROW) { \
        (void)branch; \
        (void)status; \
        return row; \
    } \
    ENTRY size_t bench_##name##_batch(ROWS) { \
        (void)branch; \
        (void)status; \
        return batch; \
    }

ADAPT(foot_position, (mero_leg_leg_foot_position(in, out), 0), (mero_leg_leg_foot_position_batch(rows, in, out), rows))
ADAPT(foot_position_jacobian, (mero_leg_leg_foot_position_jacobian(in, out, out + 3), 0),
      (mero_leg_leg_foot_position_jacobian_batch(rows, in, out, out + 3 * rows), rows))
ADAPT(foot_hessian, (mero_leg_leg_foot_hessian(in, out), 0), (mero_leg_leg_foot_hessian_batch(rows, in, out), rows))
ADAPT(inverse_branch, mero_leg_leg_inverse_branch(in, branch, out), mero_leg_leg_inverse_branch_batch(rows, in, branch, out, status))
ADAPT(inverse, mero_leg_leg_inverse(in, out, status), mero_leg_leg_inverse_batch(rows, in, out, status))
