/* walkgen_batch.h: many rows through a function, WG_LANES of them at a time; the arrays outside may have any length and stride.
 *
 * A block's numbers are gathered so that those of one element lie side by side, computed (walkgen_lanes.h), and scattered. The last rows,
 * where they are few, and rows with a NaN among their results are computed alone: with the same bits.
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
#define WG_LANES 32
#define WG_FEW_ROWS 4
#define WG_MOST_GIVEN 48
#define WG_MOST_FOUND 32
#define WG_MOST_STATUSES 8
#define WG_LINE 64 /* bytes of the cache's lines; parts of them are written past it slowly */
#define WG_FAR_BYTES 33554432.0 /* results that do not stay in a cache */

/* By fours, none in a loop: compilers make a call of the C library of that. */
#define WG_COPY_4(to, from, at) memcpy((to) + (at), (from) + (at), 4 * sizeof *(from))
#define WG_COPY_16(to, from, at) \
    (WG_COPY_4(to, from, at), WG_COPY_4(to, from, (at) + 4), WG_COPY_4(to, from, (at) + 8), WG_COPY_4(to, from, (at) + 12))
#define WG_COPY_LANES(to, from) ((void)WG_COPY_16(to, from, 0), (void)WG_COPY_16(to, from, 16))

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
#endif

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_BATCH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_BATCH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_BATCH_F64
#else
#define WALKGEN_BATCH_F32
#endif

/* One row, its numbers side by side. */
typedef void (*WG_NAME(wg_alone))(const WG_REAL *given, WG_REAL *found);

/* A function of rows in both forms; how many arrays are its inputs and its outputs. */
struct WG_NAME(wg_laned) {
    void (*block)(const WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]);
    WG_NAME(wg_alone) alone;
    int32_t inputs, outputs;
};

#if defined(WALKGEN_VECTORS)
#if WG_REAL_BITS == 64
#define WG_X4 wg_x4
#define WG_X4_BITS wg_bits_x4
#else
#define WG_X4 wg_x4_f32
#define WG_X4_BITS wg_bits_x4_f32
#endif
#include "walkgen_turned.h"
#undef WG_X4
#undef WG_X4_BITS
#endif

/* Whether numbers can be read and written as such: aligned, and those of a row side by side. */
static inline int WG_NAME(wg_is_plain)(const struct wg_array *array) {
    return array->kind == WG_NUMBER && ((uintptr_t)array->data | (uintptr_t)array->row | (uintptr_t)array->element) % sizeof(WG_REAL) == 0;
}

/* Numbers of so many rows from an array to a block. */
WG_CALLED void WG_NAME(wg_gather)(const struct wg_array *array, ptrdiff_t first, int count, int more, WG_REAL (*WG_RESTRICT given)[WG_LANES]) {
    const char *start = array->data + first * array->row;
    int element = 0;
    if (WG_NAME(wg_is_plain)(array)) {
        const WG_REAL *numbers = (const WG_REAL *)(const void *)start;
        const ptrdiff_t step = array->row / (ptrdiff_t)sizeof(WG_REAL), across = array->element / (ptrdiff_t)sizeof(WG_REAL);
#if defined(WALKGEN_VECTORS)
        if (across == 1 && count == WG_LANES && step >= array->size && (array->size > 3 || (array->size == 3 && more))) {
            WG_NAME(wg_gather_turned)(numbers, step, array->size, given);
            return;
        }
#endif
        (void)more;
        for (; step == 1 && count == WG_LANES && element < array->size; ++element) {
            WG_COPY_LANES(given[element], numbers + element * across);
        }
        for (; element < array->size; ++element) {
            const WG_REAL *from = numbers + element * across;
            int lane = 0;
            for (; lane + 4 <= count; lane += 4, from += 4 * step) {
                const WG_REAL a = from[0], b = from[step], c = from[2 * step], d = from[3 * step];
                given[element][lane] = a, given[element][lane + 1] = b, given[element][lane + 2] = c, given[element][lane + 3] = d;
            }
            for (; lane < count; ++lane, from += step) {
                given[element][lane] = *from;
            }
        }
    }
    for (; element < array->size; ++element) {
        for (int lane = 0; lane < count; ++lane) {
            memcpy(&given[element][lane], start + element * array->element + lane * array->row, sizeof(WG_REAL));
        }
    }
}

/* Statuses of so many rows, which lie together; of whole blocks by a loop that compilers make vectors of. */
static inline void WG_NAME(wg_scatter_states)(int32_t *WG_RESTRICT to, int count, const WG_REAL *WG_RESTRICT found) {
    if (count == WG_LANES) {
        for (int lane = 0; lane < WG_LANES; ++lane) {
            to[lane] = (int32_t)found[lane];
        }
    } else {
        for (int lane = 0; lane < count; ++lane) {
            to[lane] = (int32_t)found[lane];
        }
    }
}

/* Numbers of so many rows from a block to an array. */
WG_CALLED void WG_NAME(wg_scatter)(const struct wg_array *array, ptrdiff_t first, int count, int far,
                                   const WG_REAL (*WG_RESTRICT found)[WG_LANES]) {
    char *start = array->data + first * array->row;
    int element = 0;
#if defined(WALKGEN_VECTORS)
    if (array->kind == WG_STATUS && count == WG_LANES && array->size > 3 && array->element == (ptrdiff_t)sizeof(int32_t) &&
        array->row == array->size * array->element && (uintptr_t)start % sizeof(int32_t) == 0) {
        WG_NAME(wg_scatter_statuses)((int32_t *)(void *)start, array->size, found);
        return;
    }
#endif
    (void)far;
    if (WG_NAME(wg_is_plain)(array)) {
        WG_REAL *numbers = (WG_REAL *)(void *)start;
        const ptrdiff_t step = array->row / (ptrdiff_t)sizeof(WG_REAL), across = array->element / (ptrdiff_t)sizeof(WG_REAL);
#if defined(WALKGEN_VECTORS)
        if (across == 1 && count == WG_LANES && (array->size > 3 || (array->size == 3 && step == 3))) {
            WG_NAME(wg_scatter_turned)(numbers, step, array->size, found);
            return;
        }
#endif
        for (; step == 1 && count == WG_LANES && element < array->size; ++element) {
#if defined(WALKGEN_VECTORS)
            if (far && (uintptr_t)(numbers + element * across) % WG_LINE == 0) {
                WG_NAME(wg_stream_lanes)(numbers + element * across, found[element]);
                continue;
            }
#endif
            WG_COPY_LANES(numbers + element * across, found[element]);
        }
        for (; element < array->size; ++element) {
            WG_REAL *to = numbers + element * across;
            int lane = 0;
            for (; lane + 4 <= count; lane += 4, to += 4 * step) {
                const WG_REAL *const from = &found[element][lane];
                to[0] = from[0], to[step] = from[1], to[2 * step] = from[2], to[3 * step] = from[3];
            }
            for (; lane < count; ++lane, to += step) {
                *to = found[element][lane];
            }
        }
    }
    if (array->kind == WG_STATUS && array->row == (ptrdiff_t)sizeof(int32_t) && ((uintptr_t)start | (uintptr_t)array->element) % sizeof(int32_t) == 0) {
        for (; element < array->size; ++element) {
            WG_NAME(wg_scatter_states)((int32_t *)(void *)(start + element * array->element), count, found[element]);
        }
    }
    for (; element < array->size; ++element) {
        for (int lane = 0; lane < count; ++lane) {
            char *to = start + element * array->element + lane * array->row;
            if (array->kind == WG_NUMBER) {
                memcpy(to, &found[element][lane], sizeof(WG_REAL));
            } else {
                const int32_t status = (int32_t)found[element][lane];
                memcpy(to, &status, sizeof status);
            }
        }
    }
}

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

/* So many rows at once; those with a NaN once more, alone. */
static inline void WG_NAME(wg_whole_block)(const struct WG_NAME(wg_laned) *laned, int count, int inputs, int outputs,
                                           WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]) {
    for (int element = 0; element < inputs; ++element) {
        for (int lane = count; lane < WG_LANES; ++lane) {
            given[element][lane] = given[element][0];
        }
    }
    laned->block((const WG_REAL(*)[WG_LANES])given, found);
    for (int lane = WG_NAME(wg_any)(found[outputs]) ? 0 : count; lane < count; ++lane) {
        if (!(found[outputs][lane] == WG_C(0.0))) {
            WG_NAME(wg_lane_alone)(laned->alone, lane, inputs, outputs, (const WG_REAL(*)[WG_LANES])given, found);
        }
    }
}

/* Rows with an UNREACHABLE target by other means; how many then have no OK. Where all lanes have one, none is looked at alone. */
static inline int WG_NAME(wg_settled)(WG_NAME(wg_alone) closest, int count, int inputs, int outputs, int states,
                                      const WG_REAL (*given)[WG_LANES], WG_REAL (*found)[WG_LANES]) {
    WG_REAL none[WG_LANES], away[WG_LANES] = {0};
    int bad = 0;
    for (int lane = 0; lane < WG_LANES; ++lane) {
        none[lane] = lane < count ? WG_C(1.0) : WG_C(0.0);
    }
    for (int which = outputs - states; which < outputs; ++which) {
        for (int lane = 0; lane < WG_LANES; ++lane) {
            none[lane] = found[which][lane] == (WG_REAL)WALKGEN_OK ? WG_C(0.0) : none[lane];
            away[lane] = found[which][lane] == (WG_REAL)WALKGEN_UNREACHABLE ? WG_C(1.0) : away[lane];
        }
    }
    for (int lane = closest && WG_NAME(wg_any)(away) ? 0 : count; lane < count; ++lane) {
        if (away[lane] > WG_C(0.0)) {
            WG_NAME(wg_lane_alone)(closest, lane, inputs, outputs, given, found);
            none[lane] = WG_C(1.0);
            for (int which = outputs - states; which < outputs; ++which) {
                none[lane] = found[which][lane] == (WG_REAL)WALKGEN_OK ? WG_C(0.0) : none[lane];
            }
        }
    }
    for (int lane = WG_NAME(wg_any)(none) ? 0 : count; lane < count; ++lane) {
        bad += none[lane] > WG_C(0.0);
    }
    return bad;
}

/* All rows of the inputs' arrays and the outputs', which follow. With `closest`, which computes a row by other means, the rows that have a
 * status UNREACHABLE go to it. Returns how many rows have no status OK, of functions with one.
 */
WG_CALLED size_t WG_NAME(wg_batch)(const struct WG_NAME(wg_laned) *laned, size_t rows, const struct wg_array *arrays,
                                   WG_NAME(wg_alone) closest) {
    WG_ALIGNED WG_REAL given[WG_MOST_GIVEN][WG_LANES];
    WG_ALIGNED WG_REAL found[WG_MOST_FOUND + 1][WG_LANES];
    const struct wg_array *const results = arrays + laned->inputs, *const end = results + laned->outputs;
    size_t bad = 0;
    int inputs = 0, outputs = 0, states = 0;
    for (const struct wg_array *array = arrays; array < end; ++array) {
        *(array < results ? &inputs : &outputs) += array->size;
        states = array->kind == WG_STATUS ? array->size : 0; /* a status is the last output */
    }
    const int far = (double)rows * (double)outputs * (double)sizeof(WG_REAL) >= WG_FAR_BYTES;
    for (size_t first = 0; first < rows; first += WG_LANES) {
        const int count = rows - first < WG_LANES ? (int)(rows - first) : WG_LANES;
        int place = 0;
        for (const struct wg_array *array = arrays; array < results; place += array->size, ++array) {
            WG_NAME(wg_gather)(array, (ptrdiff_t)first, count, first + WG_LANES < rows, given + place);
        }
        if (count > WG_FEW_ROWS) {
            WG_NAME(wg_whole_block)(laned, count, inputs, outputs, given, found);
        }
        for (int lane = 0; count <= WG_FEW_ROWS && lane < count; ++lane) {
            WG_NAME(wg_lane_alone)(laned->alone, lane, inputs, outputs, (const WG_REAL(*)[WG_LANES])given, found);
        }
        if (states) {
            bad += (size_t)WG_NAME(wg_settled)(closest, count, inputs, outputs, states, (const WG_REAL(*)[WG_LANES])given, found);
        }
        place = 0;
        for (const struct wg_array *array = results; array < end; place += array->size, ++array) {
            WG_NAME(wg_scatter)(array, (ptrdiff_t)first, count, far, (const WG_REAL(*)[WG_LANES])(found + place));
        }
    }
#if defined(WALKGEN_VECTORS)
    if (far) {
        __builtin_ia32_sfence(); /* what went past the cache is seen before what the caller writes next */
    }
#endif
    return bad;
}
#endif
