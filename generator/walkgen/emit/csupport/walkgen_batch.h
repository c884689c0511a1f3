/* walkgen_batch.h: many rows through a function, WG_LANES of them at a time; the arrays outside may have any length and stride.
 *
 * A block's numbers are gathered so that those of one element lie side by side (walkgen_ports.h), computed (walkgen_lanes.h), and scattered.
 * The last rows, where they are few, and rows with an angle beyond its range are computed alone: with the same bits.
 */
#include <string.h>

#include "walkgen_math.h"
#include "walkgen_status.h"

/* Heads of functions of one row, as they are; the second reading has others. */
#if !defined(WALKGEN_ROWS)
#undef WG_ROW
#undef WG_STATIC_ROW
#define WG_ROW(head) head
#define WG_STATIC_ROW(head) static head
#endif

#if !defined(WALKGEN_BATCH)
#define WALKGEN_BATCH
#define WG_LANES (1024 / WG_REAL_BITS) /* two vectors of the widest */
#define WG_FEW_ROWS 4
#define WG_MOST_GIVEN 48
#define WG_MOST_FOUND 32
#define WG_MOST_STATUSES 8
#define WG_LINE 64 /* bytes of the cache's lines; parts of them are written past it slowly */
#define WG_FAR_BYTES 33554432.0 /* results that do not stay in a cache */

/* On lines of the cache, which vectors then never cross. */
#if defined(__GNUC__)
#define WG_ALIGNED __attribute__((aligned(64)))
#else
#define WG_ALIGNED
#endif

/* What an array's elements are: numbers, or statuses of 32 bits. */
enum { WG_NUMBER = 0, WG_STATUS = 1 };

/* One array: `row` and `element` are the bytes from one to the next. */
struct wg_array {
    char *data;
    ptrdiff_t row, element;
    int32_t size, kind;
};

/* Rows of so many numbers one after another, of statuses, one row for all. */
#define WG_DENSE_OF(data, type, size, kind) \
    {(char *)(uintptr_t)(const void *)(data), (ptrdiff_t)((size) * sizeof(type)), (ptrdiff_t)sizeof(type), size, kind}
#define WG_DENSE(data, size) WG_DENSE_OF(data, WG_REAL, size, WG_NUMBER)
#define WG_DENSE_STATUS(data, size) WG_DENSE_OF(data, int32_t, size, WG_STATUS)
#define WG_SHARED(data, size) {(char *)(uintptr_t)(const void *)(data), 0, (ptrdiff_t)sizeof(WG_REAL), size, WG_NUMBER}

#include "walkgen_turned.h"
#endif

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_BATCH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_BATCH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_BATCH_F64
#else
#define WALKGEN_BATCH_F32
#endif

/* One row, its numbers side by side. */
typedef void (*WG_NAME(wg_alone))(const WG_REAL *given, WG_REAL *found);

#if defined(WALKGEN_VECTORS)
typedef WG_UINT WG_NAME(wg_bits) __attribute__((vector_size(32)));
#endif

/* A function of rows in both forms; how many arrays are its inputs and its outputs. */
struct WG_NAME(wg_laned) {
    void (*block)(const WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]);
    WG_NAME(wg_alone) alone;
    int32_t inputs, outputs;
};

#include "walkgen_ports.h"

/* One lane of a block by itself. */
static inline void WG_NAME(wg_lane_alone)(WG_NAME(wg_alone) alone, int lane, int inputs, int outputs, const WG_REAL (*given)[WG_LANES],
                                          WG_REAL (*found)[WG_LANES]) {
    WG_REAL in[WG_MOST_GIVEN] = {0}, out[WG_MOST_FOUND] = {0};
    for (int element = 0; element < inputs; ++element) {
        in[element] = given[element][lane];
    }
    alone(in, out);
    for (int element = 0; element < outputs; ++element) {
        found[element][lane] = out[element];
    }
}

/* Whether any lane is not +0. */
static inline int WG_NAME(wg_any)(const WG_REAL *lanes) {
    uint32_t bits[WG_LANES * sizeof(WG_REAL) / sizeof(uint32_t)], any = 0;
    memcpy(bits, lanes, sizeof bits);
    for (size_t word = 0; word < sizeof bits / sizeof bits[0]; ++word) {
        any |= bits[word];
    }
    return any != 0;
}

/* So many rows at once. */
static inline void WG_NAME(wg_whole_block)(const struct WG_NAME(wg_laned) *laned, int count, int inputs, WG_REAL (*given)[WG_LANES],
                                           WG_REAL (*found)[WG_LANES]) {
    for (int element = 0; count < WG_LANES && element < inputs; ++element) {
        for (int lane = count; lane < WG_LANES; ++lane) {
            given[element][lane] = given[element][0];
        }
    }
    laned->block((const WG_REAL(*)[WG_LANES])given, found);
}

/* Those that lost an angle once more, alone. */
static inline void WG_NAME(wg_mended)(const struct WG_NAME(wg_laned) *laned, int count, int inputs, int outputs,
                                      const WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]) {
    for (int lane = WG_NAME(wg_any)(found[outputs]) ? 0 : count; lane < count; ++lane) {
        if (!(found[outputs][lane] == WG_C(0.0))) {
            WG_NAME(wg_lane_alone)(laned->alone, lane, inputs, outputs, given, found);
        }
    }
}

/* Whether a lane may be without OK, or with an UNREACHABLE target. */
static inline int WG_NAME(wg_is_mixed)(int states, const WG_REAL (*WG_RESTRICT found)[WG_LANES]) {
#if defined(WALKGEN_VECTORS)
    const WG_NAME(wg_bits) none = {0}, away = none + WG_NAME(walkgen_to_bits)((WG_REAL)WALKGEN_UNREACHABLE);
    WG_NAME(wg_bits) mixed = none, some, state;
    for (size_t at = 0; at < WG_LANES; at += sizeof mixed / sizeof(WG_REAL)) {
        some = ~none;
        for (int which = 0; which < states; ++which) {
            memcpy(&state, &found[which][at], sizeof state);
            some &= (WG_NAME(wg_bits))(state != 0);
            mixed |= (WG_NAME(wg_bits))(state == away);
        }
        mixed |= some;
    }
    for (size_t at = 0; at < sizeof mixed / sizeof(WG_REAL); ++at) {
        mixed[0] |= mixed[at];
    }
    return mixed[0] != 0;
#else
    WG_UINT some[WG_LANES], mixed = 0;
    memset(some, 1, sizeof some);
    for (int which = 0; which < states; ++which) {
        for (int lane = 0; lane < WG_LANES; ++lane) {
            some[lane] = found[which][lane] == (WG_REAL)WALKGEN_OK ? 0 : some[lane];
            mixed |= found[which][lane] == (WG_REAL)WALKGEN_UNREACHABLE ? 1 : 0;
        }
    }
    for (int lane = 0; lane < WG_LANES; ++lane) {
        mixed |= some[lane];
    }
    return mixed != 0;
#endif
}

/* Whether a lane has this status anywhere. */
static inline int WG_NAME(wg_lane_has)(int32_t status, int states, int lane, const WG_REAL (*found)[WG_LANES]) {
    int has = 0;
    for (int which = 0; which < states; ++which) {
        has |= found[which][lane] == (WG_REAL)status;
    }
    return has;
}

/* Rows with an UNREACHABLE target by other means; how many then have no OK. */
static inline int WG_NAME(wg_settled)(WG_NAME(wg_alone) closest, int count, int inputs, int outputs, int states,
                                      const WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]) {
    const WG_REAL(*const status)[WG_LANES] = (const WG_REAL(*)[WG_LANES])(found + outputs - states);
    int bad = 0;
    for (int lane = WG_NAME(wg_is_mixed)(states, status) ? 0 : count; lane < count; ++lane) {
        if (closest && WG_NAME(wg_lane_has)(WALKGEN_UNREACHABLE, states, lane, status)) {
            WG_NAME(wg_lane_alone)(closest, lane, inputs, outputs, given, found);
        }
        bad += !WG_NAME(wg_lane_has)(WALKGEN_OK, states, lane, status);
    }
    return bad;
}

/* A batch on its way. There are three blocks at once: while one is computed, the next one's numbers are gathered and the last one's
 * scattered. Numbers that are read as wider vectors than they were written have then long arrived, and what waits for memory goes beside
 * what waits for sums and products.
 */
struct WG_NAME(wg_course) {
    WG_ALIGNED WG_REAL given[3][WG_MOST_GIVEN + 1][WG_LANES]; /* of three numbers a fourth is written too */
    WG_ALIGNED WG_REAL found[2][WG_MOST_FOUND + 1][WG_LANES];
    struct WG_NAME(wg_port) ports[WG_MOST_GIVEN + WG_MOST_FOUND], *results, *end;
    const struct WG_NAME(wg_laned) *laned;
    WG_NAME(wg_alone) closest;
    size_t bad;
    int inputs, outputs, states;
};

static inline void WG_NAME(wg_begin)(struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_laned) *laned, size_t rows,
                                     const struct wg_array *array) {
    struct WG_NAME(wg_port) *port = course->ports;
    course->laned = laned, course->bad = 0, course->inputs = course->outputs = course->states = 0;
    course->results = port + laned->inputs, course->end = course->results + laned->outputs;
    for (; port < course->end; ++port, ++array) {
        const int written = port >= course->results;
        port->at = array->data, port->row = array->row, port->element = array->element, port->size = array->size, port->kind = array->kind;
        port->rows = WG_LANES, port->beyond = port->far = 0;
        course->states = port->kind == WG_STATUS ? port->size : 0; /* a status is the last output */
        *(written ? &course->outputs : &course->inputs) += port->size;
        WG_NAME(wg_choose)(port, written);
    }
    for (port = course->results; port < course->end; ++port) {
        port->far = (double)rows * (double)course->outputs * (double)sizeof(WG_REAL) >= WG_FAR_BYTES;
    }
}

/* The numbers of a block that has another one after it, and of the last one. */
static inline void WG_NAME(wg_take)(struct WG_NAME(wg_course) *course, WG_REAL (*given)[WG_LANES]) {
    for (struct WG_NAME(wg_port) *port = course->ports; port < course->results; given += port->size, ++port) {
        port->move(port, given);
        port->at += WG_LANES * port->row;
    }
}

WG_CALLED void WG_NAME(wg_gather_last)(const struct WG_NAME(wg_port) *port, int count, WG_REAL (*given)[WG_LANES]) {
    int first = 0;
#if defined(WALKGEN_VECTORS)
    if (port->beyond) {
        first = (count - 1) / 4 * 4;
        wg_rows_to_planes(port->at, port->row, port->size, sizeof(WG_REAL), first, (char *)given, sizeof *given);
    }
#endif
    WG_NAME(wg_gather)(port, first, count, given);
}

static inline void WG_NAME(wg_take_last)(struct WG_NAME(wg_course) *course, int count, WG_REAL (*given)[WG_LANES]) {
    for (struct WG_NAME(wg_port) *port = course->ports; port < course->results; given += port->size, ++port) {
        if (count == WG_LANES && !port->beyond) {
            port->move(port, given);
        } else {
            WG_NAME(wg_gather_last)(port, count, given);
        }
    }
}

/* What the lanes left over, and their results. */
static inline void WG_NAME(wg_finish)(struct WG_NAME(wg_course) *course, int count, const WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]) {
    if (count > WG_FEW_ROWS) {
        WG_NAME(wg_mended)(course->laned, count, course->inputs, course->outputs, given, found);
    }
    if (course->states) {
        course->bad += (size_t)WG_NAME(wg_settled)(course->closest, count, course->inputs, course->outputs, course->states, given, found);
    }
}

static inline void WG_NAME(wg_give)(struct WG_NAME(wg_course) *course, const WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]) {
    WG_NAME(wg_finish)(course, WG_LANES, given, found);
    for (struct WG_NAME(wg_port) *port = course->results; port < course->end; found += port->size, ++port) {
        port->move(port, found);
        port->at += WG_LANES * port->row;
    }
}

static inline void WG_NAME(wg_give_last)(struct WG_NAME(wg_course) *course, int count, const WG_REAL (*given)[WG_LANES],
                                         WG_REAL (*found)[WG_LANES]) {
    WG_NAME(wg_finish)(course, count, given, found);
    for (struct WG_NAME(wg_port) *port = course->results; port < course->end; found += port->size, ++port) {
        if (count == WG_LANES && !port->beyond) {
            port->move(port, found);
        } else {
            WG_NAME(wg_scatter)(port, count, found);
        }
    }
}

/* The last block, which may be of few rows. */
static inline void WG_NAME(wg_compute_last)(const struct WG_NAME(wg_course) *course, int count, WG_REAL (*given)[WG_LANES],
                                            WG_REAL (*found)[WG_LANES]) {
    if (count > WG_FEW_ROWS) {
        WG_NAME(wg_whole_block)(course->laned, count, course->inputs, given, found);
    }
    for (int lane = 0; count <= WG_FEW_ROWS && lane < count; ++lane) {
        WG_NAME(wg_lane_alone)(course->laned->alone, lane, course->inputs, course->outputs, (const WG_REAL(*)[WG_LANES])given, found);
    }
}

/* All rows of the inputs' arrays and the outputs', which follow. With `closest`, which computes a row by other means, the rows that have a
 * status UNREACHABLE go to it. Returns how many rows have no status OK, of functions with one.
 */
WG_CALLED size_t WG_NAME(wg_batch)(const struct WG_NAME(wg_laned) *laned, size_t rows, const struct wg_array *arrays,
                                   WG_NAME(wg_alone) closest) {
    struct WG_NAME(wg_course) course;
    WG_REAL(*next)[WG_LANES] = course.given[0], (*given)[WG_LANES] = course.given[1], (*last)[WG_LANES] = course.given[2];
    WG_REAL(*found)[WG_LANES] = course.found[0], (*kept)[WG_LANES] = course.found[1], (*swap)[WG_LANES];
    const size_t whole = rows > 0 ? (rows - 1) / WG_LANES : 0; /* the last is another matter */
    const int count = (int)(rows - whole * WG_LANES);
    WG_NAME(wg_begin)(&course, laned, rows, arrays);
    course.closest = closest;
    if (whole > 0) {
        WG_NAME(wg_take)(&course, next);
    } else {
        WG_NAME(wg_take_last)(&course, count, next);
    }
    for (size_t block = 0; block <= whole; ++block) {
        swap = last, last = given, given = next, next = swap;
        swap = kept, kept = found, found = swap;
        if (block + 1 < whole) {
            WG_NAME(wg_take)(&course, next);
        } else if (block < whole) {
            WG_NAME(wg_take_last)(&course, count, next);
        }
        if (block < whole) {
            laned->block((const WG_REAL(*)[WG_LANES])given, found);
        } else {
            WG_NAME(wg_compute_last)(&course, count, given, found);
        }
        if (block > 0) {
            WG_NAME(wg_give)(&course, (const WG_REAL(*)[WG_LANES])last, kept);
        }
    }
    WG_NAME(wg_give_last)(&course, count, (const WG_REAL(*)[WG_LANES])given, found);
#if defined(WALKGEN_VECTORS)
    if (course.results->far) {
        __builtin_ia32_sfence(); /* what went past the cache is seen before what the caller writes next */
    }
#endif
    return course.bad;
}
#endif
