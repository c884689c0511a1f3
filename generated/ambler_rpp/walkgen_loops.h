/* walkgen_loops.h: how a generated kernel is run over the rows of NumPy arrays; for <robot>_python.c only.
 *
 * NumPy calls a loop with one pointer and one step (bytes from row to row) for each argument, then, in the same order,
 * the steps of every core dimension. Where all core dimensions are dense the kernel works on NumPy's memory directly;
 * else each row is gathered into, and scattered from, a dense buffer.
 */
#ifndef WALKGEN_LOOPS_H
#define WALKGEN_LOOPS_H

#include <fenv.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* One copy of the shared body for all loops: inlining it into each of hundreds would cost seconds of compiling. */
#if defined(__GNUC__) || defined(__clang__)
#define WALKGEN_SHARED static __attribute__((noinline, unused))
#else
#define WALKGEN_SHARED static
#endif

#define WALKGEN_MAX_PORTS 32
#define WALKGEN_MAX_RANK 6

/* One argument: size of an element, whether the kernel writes it, where its dense copy starts in the buffer, its shape, where -i stands for
 * NumPy's i-th dimension. */
typedef struct {
    intptr_t item;
    int output;
    intptr_t offset;
    int rank;
    intptr_t shape[WALKGEN_MAX_RANK];
} walkgen_port;

/* How many elements it has. */
static inline intptr_t walkgen_size(const walkgen_port *port) {
    intptr_t size = 1;
    int axis;
    for (axis = 0; axis < port->rank; axis++) {
        size *= port->shape[axis];
    }
    return size;
}

/* A kernel run over rows whose core dimensions are dense; `steps` are the bytes from row to row, `dimensions` NumPy's. */
typedef void (*walkgen_rows)(intptr_t rows, char *const *arguments, const intptr_t *steps, const intptr_t *dimensions);

/* The table with the sizes of this call. */
static inline void walkgen_sized(const walkgen_port *ports, int count, const intptr_t *dimensions, walkgen_port *sized) {
    int port, axis;
    for (port = 0; port < count; port++) {
        sized[port] = ports[port];
        for (axis = 0; axis < ports[port].rank; axis++) {
            const intptr_t size = ports[port].shape[axis];
            sized[port].shape[axis] = size < 0 ? dimensions[-size] : size;
        }
    }
}

/* What C code takes for an integer: a value out of its range becomes -1, which is never valid. */
static inline int32_t walkgen_integer(const char *value) {
    int64_t wide;
    memcpy(&wide, value, sizeof wide);
    return wide < 0 || wide > INT32_MAX ? (int32_t)-1 : (int32_t)wide;
}

static inline void walkgen_integers(int count, const char *values, int32_t *narrow) {
    int at;
    for (at = 0; at < count; at++) {
        narrow[at] = walkgen_integer(values + at * (intptr_t)sizeof(int64_t));
    }
}

/* Whether the core dimensions lie dense and the rows aligned. */
static inline int walkgen_is_dense(const walkgen_port *port, const char *data, intptr_t step, const intptr_t *core) {
    intptr_t dense = port->item;
    int axis;
    for (axis = port->rank - 1; axis >= 0; axis--) {
        if (core[axis] != dense && port->shape[axis] != 1) {
            return 0;
        }
        dense *= port->shape[axis];
    }
    return (((uintptr_t)data | (uintptr_t)step) & (uintptr_t)(port->item - 1)) == 0;
}

/* Copy one row between NumPy's memory and its dense place, element by element in C order. */
static inline void walkgen_copy(const walkgen_port *port, char *data, const intptr_t *core, char *dense) {
    intptr_t index[WALKGEN_MAX_RANK] = {0};
    int axis;
    do {
        memcpy(port->output ? data : dense, port->output ? dense : data, (size_t)port->item);
        dense += port->item;
        for (axis = port->rank - 1; axis >= 0; axis--) {
            data += core[axis];
            if (++index[axis] < port->shape[axis]) {
                break;
            }
            data -= core[axis] * port->shape[axis];
            index[axis] = 0;
        }
    } while (axis >= 0);
}

/* The rows one by one through the buffer, for the arguments that are not dense. */
WALKGEN_SHARED void walkgen_gather(walkgen_rows run, const walkgen_port *ports, int count, const char *dense, char *buffer,
                                   char *const *arguments, const intptr_t *dimensions, const intptr_t *steps) {
    char *row[WALKGEN_MAX_PORTS];
    intptr_t at;
    for (at = 0; at < dimensions[0]; at++) {
        const intptr_t *core = steps + count;
        int port;
        for (port = 0; port < count; core += ports[port].rank, port++) {
            char *data = arguments[port] + at * steps[port];
            row[port] = dense[port] ? data : buffer + ports[port].offset;
            if (!dense[port] && !ports[port].output) {
                walkgen_copy(&ports[port], data, core, row[port]);
            }
        }
        run(1, row, steps, dimensions);
        core = steps + count;
        for (port = 0; port < count; core += ports[port].rank, port++) {
            if (!dense[port] && ports[port].output) {
                walkgen_copy(&ports[port], arguments[port] + at * steps[port], core, row[port]);
            }
        }
    }
}

/* Whether a flag is up that NumPy would warn of; where numbers are in SSE's registers only their flags can be. */
static inline int walkgen_is_flagged(void) {
#if defined(__GNUC__) && defined(__x86_64__) && defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ == 0
    return (__builtin_ia32_stmxcsr() & 0x1D) != 0;
#else
    return fetestexcept(FE_ALL_EXCEPT & ~FE_INEXACT) != 0;
#endif
}

/* The body of every loop. Flags that untaken branches raised are lowered: a status, not a warning, says what failed. */
WALKGEN_SHARED void walkgen_loop(walkgen_rows run, const walkgen_port *ports, int count, char *buffer, char *const *arguments,
                                 const intptr_t *dimensions, const intptr_t *steps) {
    char dense[WALKGEN_MAX_PORTS];
    const intptr_t *core = steps + count;
    int all = 1;
    int port;
    for (port = 0; port < count; core += ports[port].rank, port++) {
        dense[port] = (char)walkgen_is_dense(&ports[port], arguments[port], steps[port], core);
        all &= dense[port];
    }
    if (all) {
        run(dimensions[0], arguments, steps, dimensions);
    } else {
        walkgen_gather(run, ports, count, dense, buffer, arguments, dimensions, steps);
    }
    if (walkgen_is_flagged()) {
        feclearexcept(FE_ALL_EXCEPT);
    }
}

/* A function's kernel over rows: what follows is its body, a statement for each row, which finds its ports here. */
#define WALKGEN_EACH_ROW \
    intptr_t at; \
    (void)dimensions; \
    for (at = 0; at < rows; at++)
#define WALKGEN_PLACE(number) (a[number] + at * step[number])
#define WALKGEN_PORT(type, number) ((type *)WALKGEN_PLACE(number))
#define WALKGEN_ROWS(name) \
    static void name##_rows(intptr_t rows, char *const *a, const intptr_t *step, const intptr_t *dimensions)

/* What NumPy calls: `run`, rows or wide_rows, computes, and the buffer holds all ports. Where shapes vary, `before` finds them. */
#define WALKGEN_LOOP(name, run, real, size, count) WALKGEN_SIZED_LOOP(name, name##_##run, real, size, , name##_ports, count)
#define WALKGEN_SIZED_LOOP(name, run, real, size, before, table, count) \
    void name##_loop(char **arguments, const intptr_t *dimensions, const intptr_t *steps, void *data); \
    void name##_loop(char **arguments, const intptr_t *dimensions, const intptr_t *steps, void *data) { \
        real buffer[size]; \
        before \
        (void)data; \
        walkgen_loop(run, table, count, (char *)buffer, arguments, dimensions, steps); \
    }

/* The loop of an earlier function with the same code serves. */
#define WALKGEN_LOOP_OF(name, same) \
    void name##_loop(char **arguments, const intptr_t *dimensions, const intptr_t *steps, void *data); \
    void name##_loop(char **arguments, const intptr_t *dimensions, const intptr_t *steps, void *data) { \
        same##_loop(arguments, dimensions, steps, data); \
    }

#endif
