/* yardstick.c: what the C library alone costs, three sincos a row, and what an empty call costs. */
#define _GNU_SOURCE
#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define ROW const double *restrict in, int32_t branch, double *restrict out, int32_t *restrict status
#define ROWS size_t rows, const double *restrict in, const int32_t *restrict branch, double *restrict out, int32_t *restrict status

/* One function and its batch, as the harness calls them; `row` reads x and writes y. */
#define YARDSTICK(name, row) \
    static inline void name(const double *restrict x, double *restrict y) { row; } \
    __attribute__((visibility("default"))) int32_t bench_##name(ROW); \
    __attribute__((visibility("default"))) size_t bench_##name##_batch(ROWS); \
    int32_t bench_##name(ROW) { \
        (void)branch; \
        (void)status; \
        name(in, out); \
        return 0; \
    } \
    size_t bench_##name##_batch(ROWS) { \
        (void)branch; \
        (void)status; \
        for (size_t i = 0; i < rows; ++i) { \
            name(in + 3 * i, out + 6 * i); \
        } \
        return 0; \
    }

YARDSTICK(three_sincos, sincos(x[0], y, y + 1); sincos(x[1], y + 2, y + 3); sincos(x[2], y + 4, y + 5))
YARDSTICK(empty, y[0] = x[0]; y[5] = x[1])
