/* walkgen_batch.h: many rows through a function, WG_LANES of them at a time; the arrays outside may have any length and stride.
 *
 * A block's numbers are gathered so that those of one element lie side by side (walkgen_ports.h), computed (walkgen_lanes.h), and scattered;
 * where an array has them so, they are read and written there. The last rows, where they are few, and rows with an angle beyond its range
 * or a status other than OK are computed alone: with the same bits.
 */
#include <string.h>

#include "walkgen_math.h"
#include "walkgen_status.h"

/* Heads of functions of one row, as they are; the second reading has others. */
#if !defined(WALKGEN_ROWS)
#undef WG_ROW
#undef WG_STATIC_ROW
#undef WG_INLINE_ROW
#define WG_ROW(head) head
#define WG_STATIC_ROW(head) static head
#define WG_INLINE_ROW(head) WG_INLINE head
#endif

#if !defined(WALKGEN_BATCH)
#define WALKGEN_BATCH
#define WG_LANES (1024 / WG_REAL_BITS) /* two vectors of the widest */
#define WG_FEW_ROWS 4
#define WG_MOST_GIVEN 48
#define WG_MOST_FOUND 32
#define WG_MOST_STATUSES 8
#define WG_MOST_INTEGERS 4
#define WG_LINE 64 /* bytes of the cache's lines */

/* clang, asked for vectors, would tell of square roots that set errno, of which it makes none. */
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wpass-failed"
#endif

/* On lines of the cache, which vectors then never cross. */
#if defined(__GNUC__)
#define WG_ALIGNED __attribute__((aligned(WG_LINE)))
#else
#define WG_ALIGNED
#endif

/* What an array's elements are: numbers, or integers of 32 bits, as statuses are, or, of inputs, of 64 bits. */
enum { WG_NUMBER = 0, WG_STATUS = 1, WG_LONG = 2 };

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
/* Whether a lane is left over. Of half as many bits as a number, for whose sake gcc computes two vectors of numbers beside each other; a
 * number where vectors have no masks. */
#if WG_REAL_BITS == 64
#define WALKGEN_BATCH_F64
#if WG_MASKS
typedef int32_t wg_left;
#else
typedef double wg_left;
#endif
#else
#define WALKGEN_BATCH_F32
typedef int16_t wg_left_f32;
#endif

/* One row, its numbers side by side. */
typedef void (*WG_NAME(wg_alone))(const WG_REAL *given, WG_REAL *found);

/* Where a port's numbers of one block lie, or its integers: like ones side by side, `step` from one element to the next, and `ahead` bytes from
 * those of the next block but one. */
struct WG_NAME(wg_lanes) {
    void *at;
    ptrdiff_t step, ahead;
};

/* A function of rows in both forms; how many arrays are its inputs and its outputs, and how many statuses the last one has. */
struct WG_NAME(wg_laned) {
    void (*block)(const struct WG_NAME(wg_lanes) *ports, ptrdiff_t first, WG_NAME(wg_left) *left);
    WG_NAME(wg_alone) alone;
    int32_t inputs, outputs, statuses;
};

#include "walkgen_ports.h"

/* What is gathered for a block, and where all its numbers lie. */
struct WG_NAME(wg_gathered) {
    WG_ALIGNED WG_REAL given[WG_MOST_GIVEN + 1][WG_LANES]; /* of three numbers a fourth is written too */
    WG_ALIGNED int32_t integers[WG_MOST_INTEGERS][WG_LANES];
    struct WG_NAME(wg_lanes) lanes[WG_MOST_GIVEN + WG_MOST_FOUND];
};

/* A batch on its way. It `takes` where inputs are to be gathered: those of the next block before one is computed, since numbers that are read as
 * wider vectors than they were written have then long arrived, and what waits for memory goes beside what waits for sums and products. It
 * `gives` where outputs are to be scattered. It `stays` where all arrays are read and written where they lie, but for statuses, which can be set
 * when those of many rows are known. `calm` is a block of which no lane was left over: all its statuses are OK. `whole` are the rows of all
 * blocks but the last, if that is another matter. Ports of what is moved stand where their next block begins.
 */
struct WG_NAME(wg_course) {
    WG_ALIGNED WG_REAL found[WG_MOST_FOUND + 1][WG_LANES]; /* of three numbers a fourth is read too */
    WG_ALIGNED WG_NAME(wg_left) left[WG_LANES];
    struct WG_NAME(wg_gathered) blocks[2];
    struct WG_NAME(wg_port) ports[WG_MOST_GIVEN + WG_MOST_FOUND], *results, *end;
    const struct WG_NAME(wg_laned) *laned;
    WG_NAME(wg_alone) closest;
    size_t bad;
    ptrdiff_t whole;
    int outputs, states, takes, gives, stays, calm;
};

#include "walkgen_left_over.h"

/* The lanes of every other block, of which the first is `block`; of one of too `few` rows all lie in between. */
static inline void WG_NAME(wg_prepare)(struct WG_NAME(wg_course) *course, struct WG_NAME(wg_gathered) *gathered, int block, int few) {
    struct WG_NAME(wg_lanes) *lanes = gathered->lanes;
    WG_REAL(*between)[WG_LANES] = gathered->given;
    int32_t(*integers)[WG_LANES] = gathered->integers;
    for (const struct WG_NAME(wg_port) *port = course->ports; port < course->end; ++port, ++lanes) {
        const int integer = port < course->results && port->kind != WG_NUMBER;
        between = port == course->results ? course->found : between;
        lanes->at = integer ? (void *)integers : (void *)between, lanes->step = WG_LANES, lanes->ahead = 0;
        if (port->direct && !few) {
            lanes->at = port->at + block * WG_LANES * port->row, lanes->ahead = 2 * WG_LANES * port->row;
            lanes->step = port->element / (ptrdiff_t)sizeof(WG_REAL);
        }
        integers += integer, between += integer ? 0 : port->size;
    }
}

static inline void WG_NAME(wg_begin)(struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_laned) *laned, ptrdiff_t rows,
                                     const struct wg_array *array) {
    struct WG_NAME(wg_port) *port = course->ports;
    course->laned = laned, course->states = laned->statuses, course->bad = 0;
    course->outputs = course->takes = course->gives = 0, course->stays = 1;
    course->results = port + laned->inputs, course->end = course->results + laned->outputs;
    for (; port < course->end; ++port, ++array) {
        const int written = port >= course->results;
        port->at = array->data, port->row = array->row, port->element = array->element, port->size = array->size, port->kind = array->kind;
        WG_NAME(wg_choose)(port, written, course->states > 0);
        course->outputs += written ? port->size : 0;
        *(written ? &course->gives : &course->takes) |= !port->direct;
        course->stays &= port->direct || (port->filled && !port->beyond);
    }
    course->whole = (course->stays || rows == 0 ? rows : rows - 1) / WG_LANES * WG_LANES;
    WG_NAME(wg_prepare)(course, &course->blocks[0], 0, 0);
    if (!course->stays) {
        WG_NAME(wg_prepare)(course, &course->blocks[1], 1, course->whole == 0);
    }
    WG_NAME(wg_all_ok)(course);
}

#include "walkgen_carry.h"

/* A block, of which the first row lies so far on from where its lanes do. */
static inline void WG_NAME(wg_compute)(struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_lanes) *lanes, ptrdiff_t first) {
    course->laned->block(lanes, first, course->left);
    course->calm = !WG_NAME(wg_any_left)(course->left);
}

/* One of so many rows with what it leaves over. */
static inline void WG_NAME(wg_complete)(struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_lanes) *lanes, int count) {
    WG_NAME(wg_compute)(course, lanes, 0);
    if (!course->calm) {
        WG_NAME(wg_mend)(course, lanes, 0, count, 0);
    }
}

/* Of a batch that stays: rows that are calm before a row, and the block that begins there and is not. */
WG_CALLED void WG_NAME(wg_pause)(struct WG_NAME(wg_course) *course, ptrdiff_t calm, ptrdiff_t row) {
    WG_NAME(wg_give)(course, calm, 1, course->blocks);
    WG_NAME(wg_mend)(course, course->blocks->lanes, row, WG_LANES, 0);
    WG_NAME(wg_give)(course, WG_LANES, 0, course->blocks);
}

/* All its whole blocks. */
static inline struct WG_NAME(wg_gathered) *WG_NAME(wg_stay)(struct WG_NAME(wg_course) *course) {
    ptrdiff_t given = 0;
    for (ptrdiff_t row = 0; row < course->whole; row += WG_LANES) {
        WG_NAME(wg_compute)(course, course->blocks->lanes, row);
        if (!course->calm) {
            WG_NAME(wg_pause)(course, row - given, row);
            given = row + WG_LANES;
        }
    }
    WG_NAME(wg_give)(course, course->whole - given, 1, course->blocks);
    return course->blocks;
}

/* The lanes are to serve another block. */
static inline void WG_NAME(wg_advance)(const struct WG_NAME(wg_course) *course, struct WG_NAME(wg_gathered) *gathered) {
    struct WG_NAME(wg_lanes) *lanes = gathered->lanes;
    for (const struct WG_NAME(wg_port) *port = course->ports; port < course->end; ++port, ++lanes) {
        lanes->at = (char *)lanes->at + lanes->ahead;
    }
}

/* Blocks of one that moves, but the last. Returns the other one's. */
static inline struct WG_NAME(wg_gathered) *WG_NAME(wg_move)(struct WG_NAME(wg_course) *course, int count) {
    struct WG_NAME(wg_gathered) *now = &course->blocks[0], *next = &course->blocks[1], *swap;
    if (course->takes && course->whole > 0) {
        WG_NAME(wg_take)(course, now);
    }
    for (ptrdiff_t row = WG_LANES; row <= course->whole; row += WG_LANES) {
        if (course->takes && row < course->whole) {
            WG_NAME(wg_take)(course, next);
        } else if (course->takes) {
            WG_NAME(wg_take_last)(course, count, next);
        }
        WG_NAME(wg_complete)(course, now->lanes, WG_LANES);
        WG_NAME(wg_give)(course, WG_LANES, course->calm, now);
        if (row < course->whole) {
            WG_NAME(wg_advance)(course, now);
        }
        swap = now, now = next, next = swap;
    }
    return now;
}

/* The last block: of few rows each alone, and where lanes are more than rows the others are as the first. */
static inline void WG_NAME(wg_compute_last)(struct WG_NAME(wg_course) *course, int count, struct WG_NAME(wg_gathered) *gathered) {
    const struct WG_NAME(wg_lanes) *lanes = gathered->lanes;
    if (count <= WG_FEW_ROWS) {
        course->calm = 0;
        WG_NAME(wg_mend)(course, lanes, 0, count, 1);
        return;
    }
    for (const struct WG_NAME(wg_port) *port = course->ports; count < WG_LANES && port < course->results; ++port, ++lanes) {
        WG_NAME(wg_repeat)(port, count, lanes->at);
    }
    WG_NAME(wg_complete)(course, gathered->lanes, count);
}

/* All rows of the inputs' arrays and the outputs', which follow. With `closest`, which computes a row by other means, the rows that have a
 * status UNREACHABLE go to it. Returns how many rows have no status OK, of functions with one.
 */
WG_CALLED size_t WG_NAME(wg_batch)(const struct WG_NAME(wg_laned) *laned, size_t rows, const struct wg_array *arrays,
                                   WG_NAME(wg_alone) closest) {
    struct WG_NAME(wg_course) course;
    struct WG_NAME(wg_gathered) *last;
    int count;
    WG_NAME(wg_begin)(&course, laned, (ptrdiff_t)rows, arrays);
    course.closest = closest;
    count = (int)((ptrdiff_t)rows - course.whole);
    last = course.stays ? WG_NAME(wg_stay)(&course) : WG_NAME(wg_move)(&course, count);
    if (count > 0) {
        if (!course.takes || course.whole == 0) {
            WG_NAME(wg_take_last)(&course, count, last);
        }
        WG_NAME(wg_compute_last)(&course, count, last);
        WG_NAME(wg_give_last)(&course, count, last);
    }
    return course.bad;
}
#endif
