/* contact_osqp.c: OSQP through its C interface, warm: set up once, then matrix and bounds of every stance, started where the last one ended. */
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include "osqp/osqp.h"

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e9 * (double)time.tv_sec + (double)time.tv_nsec;
}

/* A is column by column, all entries kept. */
__attribute__((visibility("default"))) double time_matrices(int rows, int n, int m, double *A, double *lower, double *upper, double *x,
                                                            int32_t *status) {
    OSQPSettings settings;
    OSQPSolver *solver = NULL;
    OSQPInt *start = malloc(sizeof(OSQPInt) * (size_t)(n + 1)), *index = malloc(sizeof(OSQPInt) * (size_t)(n * m));
    OSQPInt *first = malloc(sizeof(OSQPInt) * (size_t)(n + 1)), *place = malloc(sizeof(OSQPInt) * (size_t)n);
    double *one = malloc(sizeof(double) * (size_t)n), *zero = calloc((size_t)n, sizeof(double));
    for (int j = 0; j <= n; ++j) {
        start[j] = m * j;
        first[j] = j;
    }
    for (int j = 0; j < n; ++j) {
        one[j] = 1.0;
        place[j] = j;
        for (int i = 0; i < m; ++i)
            index[m * j + i] = i;
    }
    OSQPCscMatrix P = {n, n, first, place, one, n, -1, 0}, G = {m, n, start, index, A, n * m, -1, 0};
    osqp_set_default_settings(&settings);
    settings.verbose = 0;
    settings.eps_abs = settings.eps_rel = 1e-6;
    if (osqp_setup(&solver, &P, zero, &G, lower, upper, m, n, &settings))
        return -1.0;
    const double begin = now();
    for (int i = 0; i < rows; ++i) {
        osqp_update_data_mat(solver, NULL, NULL, 0, A + (size_t)(m * n) * (size_t)i, NULL, n * m);
        osqp_update_data_vec(solver, NULL, lower + m * i, upper + m * i);
        osqp_solve(solver);
        status[i] = solver->info->status_val;
        for (int j = 0; j < n; ++j)
            x[n * i + j] = solver->solution->x[j];
    }
    const double found = (now() - begin) / rows;
    osqp_cleanup(solver);
    free(start);
    free(index);
    free(first);
    free(place);
    free(one);
    free(zero);
    return found;
}
