/* contact_walkgen.c: walkgen's contact forces for rows of stances, every one cold. */
#include <time.h>

#include "walkgen_real_f64.h"
#include "walkgen_contact.h"

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e9 * (double)time.tv_sec + (double)time.tv_nsec;
}

__attribute__((visibility("default"))) double time_rows(int rows, int k, int facets, const double *points, const double *normals, const double *mu,
                                                        const double *wrench, double *f, int32_t *status) {
    static const walkgen_contact_work cold = {0, {0}};
    double one[WALKGEN_MAX_FEET], most[WALKGEN_MAX_FEET], certificate[6], violation;
    int32_t state[WALKGEN_MAX_FEET];
    for (int i = 0; i < k; ++i) {
        one[i] = 1.0;
        most[i] = INFINITY;
    }
    const double start = now();
    for (int i = 0; i < rows; ++i) {
        walkgen_contact_work work = cold;
        wg_contact_least_squares(k, points + 3 * k * i, normals + 3 * k * i, mu + k * i, wrench + 6 * i, one, most, facets, &work, f + 3 * k * i,
                                 status + i, state, certificate, &violation);
    }
    return (now() - start) / rows;
}
