/* walkgen_wide.h: functions with lanes compiled for wider vectors than every processor has, and how NumPy's loops reach them; for
 * <robot>_python.c and <robot>_python_wide.c only. walkgen_loops.h, where it is needed, and a precision's header come before.
 */
#include "walkgen_batch.h"

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

/* NumPy's rows as arrays; `status` is the place of a status among the ports. */
static inline void walkgen_arrays(const walkgen_port *ports, int count, int status, char *const *a, const intptr_t *step, struct wg_array *arrays) {
    for (int port = 0; port < count; port++) {
        intptr_t size = 1;
        for (int axis = 0; axis < ports[port].rank; axis++) {
            size *= ports[port].shape[axis];
        }
        arrays[port].data = a[port];
        arrays[port].row = step[port];
        arrays[port].element = ports[port].item;
        arrays[port].size = (int32_t)size;
        arrays[port].kind = port == status ? WG_STATUS : WG_NUMBER;
    }
}

/* The rows of a function with lanes: by the widest set, chosen at the first call, else as every processor can. */
#define WALKGEN_WIDE_ROWS(name, robot, number, status, closest) \
    static void name##_wide_rows(intptr_t rows, char *const *a, const intptr_t *step, const intptr_t *dimensions) { \
        struct wg_array arrays[WALKGEN_MAX_PORTS]; \
        const int level = robot##_level(-1); \
        if (level == 0) { \
            name##_rows(rows, a, step, dimensions); \
            return; \
        } \
        walkgen_arrays(name##_ports, (int)(sizeof name##_ports / sizeof name##_ports[0]), status, a, step, arrays); \
        (void)robot##_wide[level - 1]->batch(robot##_wide[level - 1]->functions[number], (size_t)rows, arrays, closest); \
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
