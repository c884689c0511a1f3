/* harness.c: times one function through a pointer, so that nothing inlines into the loop; every contestant has this signature. */
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#ifndef WIDTH
#define WIDTH 3 /* q or p: every function of a leg takes three numbers (and a branch) */
#endif
enum { INPUTS = WIDTH };

typedef int32_t (*row_function)(const double *in, int32_t branch, double *out, int32_t *status);
typedef size_t (*batch_function)(size_t rows, const double *in, const int32_t *branch, double *out, int32_t *status);
/* Up to four arrays in the function's own order. */
typedef size_t (*arrays_function)(size_t rows, void *a, void *b, void *c, void *d);
typedef size_t (*planes_function)(size_t rows, size_t stride, void *a, void *b, void *c, void *d);

#define ENTRY __attribute__((visibility("default")))

static volatile int32_t sink;
static volatile double nothing = 0.0;

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time); /* what else runs on the core does not count */
    return 1e9 * (double)time.tv_sec + (double)time.tv_nsec;
}

/* ns a call, calls independent of each other. */
ENTRY double time_throughput(row_function function, size_t rows, const double *in, const int32_t *branch, double *out, int32_t *status) {
    int32_t sum = 0;
    const double start = now();
    for (size_t i = 0; i < rows; ++i) {
        sum += function(in + INPUTS * i, branch[i], out, status);
    }
    const double stop = now();
    sink = sum;
    return (stop - start) / (double)rows;
}

/* ns a call, each call's input waiting for the last call's first and last output. */
ENTRY double time_latency(row_function function, size_t rows, const double *in, const int32_t *branch, double *out, int32_t *status,
                    size_t last) {
    const double zero = nothing;
    double row[INPUTS], carry = 0.0;
    int32_t sum = 0;
    const double start = now();
    for (size_t i = 0; i < rows; ++i) {
        for (size_t k = 0; k < INPUTS; ++k) {
            row[k] = in[INPUTS * i + k] + carry;
        }
        sum += function(row, branch[i], out, status);
        carry = zero * (out[0] + out[last]);
    }
    const double stop = now();
    sink = sum;
    return (stop - start) / (double)rows;
}

/* ns a row of one call on contiguous rows. */
ENTRY double time_batch(batch_function function, size_t rows, const double *in, const int32_t *branch, double *out, int32_t *status) {
    const double start = now();
    const size_t answer = function(rows, in, branch, out, status);
    const double stop = now();
    sink = (int32_t)answer;
    return (stop - start) / (double)rows;
}

/* ns a row of as many calls on the same arrays, of any precision. */
ENTRY double time_arrays(arrays_function function, size_t calls, size_t rows, void *a, void *b, void *c, void *d) {
    size_t answer = 0;
    const double start = now();
    for (size_t call = 0; call < calls; ++call) {
        answer += function(rows, a, b, c, d);
    }
    const double stop = now();
    sink = (int32_t)answer;
    return (stop - start) / (double)rows / (double)calls;
}

/* The same on arrays whose like elements lie together, `stride` numbers from one to the next of a row. */
ENTRY double time_planes(planes_function function, size_t calls, size_t rows, size_t stride, void *a, void *b, void *c, void *d) {
    size_t answer = 0;
    const double start = now();
    for (size_t call = 0; call < calls; ++call) {
        answer += function(rows, stride, a, b, c, d);
    }
    const double stop = now();
    sink = (int32_t)answer;
    return (stop - start) / (double)rows / (double)calls;
}

/* The same of memcpy, a row being `bytes`. */
ENTRY double time_copies(size_t calls, size_t rows, size_t bytes, const void *in, void *out) {
    const double start = now();
    for (size_t call = 0; call < calls; ++call) {
        memcpy(out, in, rows * bytes);
        __asm__ volatile("" : : "r"(out) : "memory");
    }
    const double stop = now();
    return (stop - start) / (double)rows / (double)calls;
}
