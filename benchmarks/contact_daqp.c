/* contact_daqp.c: DAQP through its C interface, cold: identity as Hessian, balance as active rows, the pyramids' sides as others. The
 * matrices are given. By its one call for a problem that is new (daqp_quadprog), or with the memory of one workspace kept. */
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include "daqp/api.h"
#include "daqp/auxiliary.h"
#include "daqp/utils.h"

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e9 * (double)time.tv_sec + (double)time.tv_nsec;
}

__attribute__((visibility("default"))) double time_matrices(int rows, int n, int m, double *A, double *lower, double *upper, double *x,
                                                            int32_t *status) {
    int *sense = malloc(sizeof(int) * (size_t)m);
    DAQPWorkspace work = {0};
    DAQPProblem qp = {0};
    qp.n = n;
    qp.m = m;
    qp.A = A;
    qp.blower = lower;
    qp.bupper = upper;
    qp.sense = sense;
    for (int i = 0; i < m; ++i)
        sense[i] = i < 6 ? ACTIVE + IMMUTABLE : 0;
    allocate_daqp_settings(&work);
    work.settings->primal_tol = 1e-8;
    if (setup_daqp(&qp, &work, NULL) < 0)
        return -1.0;
    const double start = now();
    for (int i = 0; i < rows; ++i) {
        work.qp->A = A + (size_t)(m * n) * (size_t)i;
        work.qp->blower = lower + m * i;
        work.qp->bupper = upper + m * i;
        deactivate_constraints(&work);
        reset_daqp_workspace(&work);
        update_ldp(UPDATE_M + UPDATE_d + UPDATE_sense, &work);
        activate_constraints(&work);
        status[i] = daqp_ldp(&work);
        ldp2qp_solution(&work);
        for (int j = 0; j < n; ++j)
            x[n * i + j] = work.x[j];
    }
    const double found = (now() - start) / rows;
    free_daqp_workspace(&work);
    free_daqp_ldp(&work);
    free(sense);
    return found;
}

__attribute__((visibility("default"))) double time_calls(int rows, int n, int m, double *A, double *lower, double *upper, double *x,
                                                         int32_t *status) {
    int *sense = malloc(sizeof(int) * (size_t)m);
    double *lam = malloc(sizeof(double) * (size_t)m);
    DAQPProblem qp = {0};
    DAQPSettings settings;
    DAQPResult result = {0};
    daqp_default_settings(&settings);
    settings.primal_tol = 1e-8;
    qp.n = n;
    qp.m = m;
    qp.sense = sense;
    result.lam = lam;
    const double start = now();
    for (int i = 0; i < rows; ++i) {
        qp.A = A + (size_t)(m * n) * (size_t)i;
        qp.blower = lower + m * i;
        qp.bupper = upper + m * i;
        for (int j = 0; j < m; ++j)
            sense[j] = j < 6 ? ACTIVE + IMMUTABLE : 0;
        result.x = x + n * i;
        daqp_quadprog(&result, &qp, &settings);
        status[i] = result.exitflag;
    }
    const double found = (now() - start) / rows;
    free(lam);
    free(sense);
    return found;
}
