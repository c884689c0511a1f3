/* walkgen_wide.h: functions with lanes compiled for wider vectors than every processor has, and how NumPy's loops reach them; for
 * <robot>_python.c and <robot>_python_wide.c only. walkgen_loops.h, where it is needed, and a precision's header come before.
 */
#include "walkgen_batch.h"

#if defined(WALKGEN_LOOPS_H) && !defined(WALKGEN_WIDE_ARRAYS)
#define WALKGEN_WIDE_ARRAYS
/* What a port's elements are: `status` is the place of a status, `integers` has a bit for the place of each integer that is an input. */
static inline int32_t walkgen_kind(int port, int status, uint32_t integers) {
    return port == status ? WG_STATUS : integers >> port & 1 ? WG_LONG : WG_NUMBER;
}

/* NumPy's rows as arrays. */
static inline void walkgen_arrays(const walkgen_port *ports, int count, int status, uint32_t integers, char *const *a, const intptr_t *step,
                                  struct wg_array *arrays) {
    for (int port = 0; port < count; port++) {
        arrays[port].data = a[port];
        arrays[port].row = step[port];
        arrays[port].element = ports[port].item;
        arrays[port].size = (int32_t)walkgen_size(&ports[port]);
        arrays[port].kind = walkgen_kind(port, status, integers);
    }
}
#endif

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_WIDE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_WIDE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_WIDE_F64
#else
#define WALKGEN_WIDE_F32
#endif

/* All functions of a robot for one set of instructions; `batch` is NULL where the compiler does not know it. */
struct WG_NAME(walkgen_wide) {
    size_t (*batch)(const struct WG_NAME(wg_laned) *laned, size_t rows, const struct wg_array *arrays, WG_NAME(wg_alone) closest);
    const struct WG_NAME(wg_laned) *const *functions;
};

#if defined(WALKGEN_LOOPS_H)
/* One row whose numbers lie side by side: as batch computes it, without arrays around. */
WALKGEN_SHARED void WG_NAME(walkgen_wide_row)(const struct WG_NAME(wg_laned) *laned, const walkgen_port *ports, int count, int status,
                                              uint32_t integers, WG_NAME(wg_alone) closest, char *const *a) {
    WG_REAL in[WG_MOST_GIVEN], out[WG_MOST_FOUND], *next = in;
    const WG_REAL *const given = laned->inputs == 1 ? (const WG_REAL *)(const void *)a[0] : in;
    WG_REAL *const found = laned->outputs == 1 && status < 0 ? (WG_REAL *)(void *)a[laned->inputs] : out;
    int port = given == in ? 0 : laned->inputs, away = 0;
    for (; port < laned->inputs; port++) {
        const WG_REAL *numbers = (const WG_REAL *)(const void *)a[port];
        const int32_t kind = walkgen_kind(port, status, integers);
        for (intptr_t at = 0, size = walkgen_size(&ports[port]); at < size; at++) {
            *next++ = kind == WG_LONG ? WG_NAME(wg_integer)(kind, a[port] + at * (intptr_t)sizeof(int64_t)) : numbers[at];
        }
    }
    laned->alone(given, found);
    if (closest) {
        next = found;
        for (port = laned->inputs; port < status; port++) {
            next += walkgen_size(&ports[port]);
        }
        for (intptr_t left = walkgen_size(&ports[status]); left > 0; left--) {
            away |= *next++ == (WG_REAL)WALKGEN_UNREACHABLE;
        }
        if (away) {
            closest(given, found);
        }
    }
    next = found;
    for (port = found == out ? laned->inputs : count; port < count; port++) {
        for (intptr_t at = 0, size = walkgen_size(&ports[port]); at < size; at++, next++) {
            if (port == status) {
                ((int32_t *)(void *)a[port])[at] = (int32_t)*next;
            } else {
                ((WG_REAL *)(void *)a[port])[at] = *next;
            }
        }
    }
}

/* Rows by one set of instructions. */
WALKGEN_SHARED void WG_NAME(walkgen_wide_rows)(const struct WG_NAME(walkgen_wide) *set, int number, const walkgen_port *ports, int count,
                                               int status, uint32_t integers, WG_NAME(wg_alone) closest, intptr_t rows, char *const *a,
                                               const intptr_t *step) {
    struct wg_array arrays[WALKGEN_MAX_PORTS];
    if (rows == 1) {
        WG_NAME(walkgen_wide_row)(set->functions[number], ports, count, status, integers, closest, a);
    } else {
        walkgen_arrays(ports, count, status, integers, a, step, arrays);
        (void)set->batch(set->functions[number], (size_t)rows, arrays, closest);
    }
}
#endif
#endif

#if defined(WALKGEN_LOOPS_H) && !defined(WALKGEN_WIDE_LOOPS)
#define WALKGEN_WIDE_LOOPS
/* The widest set that this processor has: 2 AVX-512, 1 AVX2 with fused multiply-add, 0 none of them. */
static inline int walkgen_widest(void) {
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
        return 2;
    }
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? 1 : 0;
#else
    return 0;
#endif
}

/* The rows of a function with lanes: by the widest set, chosen at the first call, which `run` knows (walkgen_wide_rows), else as every
 * processor can. */
#define WALKGEN_WIDE_ROWS(name, robot, run, number, status, integers, closest) \
    static void name##_wide_rows(intptr_t rows, char *const *a, const intptr_t *step, const intptr_t *dimensions) { \
        const int level = robot##_level(-1), count = (int)(sizeof name##_ports / sizeof name##_ports[0]); \
        if (level == 0) { \
            name##_rows(rows, a, step, dimensions); \
        } else { \
            run(robot##_wide[level - 1], number, name##_ports, count, status, integers, closest, rows, a, step); \
        } \
    }

/* Which set a robot uses; `most` at least 0 forbids wider ones from then on. Threads that meet here come to the same answer. */
#define WALKGEN_LEVEL(robot) \
    int robot##_level(int most); \
    int robot##_level(int most) { \
        static int chosen = -1; \
        int level = chosen; \
        if (level < 0 || most >= 0) { \
            level = walkgen_widest(); \
            level = most >= 0 && most < level ? most : level; \
            level = level > 0 && robot##_wide[level - 1]->batch == NULL ? 0 : level; \
            chosen = level; \
        } \
        return level; \
    }
#endif
