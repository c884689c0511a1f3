/* walkgen_each.h: rows one after another through a function of one row, by its address; walkgen_math.h explains the macros.
 *
 * A loop for each function would take compilers several times as long. wg_each_1_2_batch is of functions of one input and two outputs,
 * wg_each_1_2_told_batch of such that return a status: it returns how many rows are not OK. After each array stands the length of its
 * rows, 0 where all share one.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_EACH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_EACH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_EACH_F64
#else
#define WALKGEN_EACH_F32
#endif

WG_CALLED void WG_NAME(wg_each_1_1_batch)(size_t rows, void (*f)(const WG_REAL *WG_RESTRICT, WG_REAL *WG_RESTRICT), const WG_REAL *a,
    size_t a_row, WG_REAL *x, size_t x_row) {
    for (; rows > 0; --rows, a += a_row, x += x_row) {
        f(a, x);
    }
}

WG_CALLED void WG_NAME(wg_each_1_2_batch)(size_t rows, void (*f)(const WG_REAL *WG_RESTRICT, WG_REAL *WG_RESTRICT, WG_REAL *WG_RESTRICT),
    const WG_REAL *a, size_t a_row, WG_REAL *x, size_t x_row, WG_REAL *y, size_t y_row) {
    for (; rows > 0; --rows, a += a_row, x += x_row, y += y_row) {
        f(a, x, y);
    }
}

WG_CALLED void WG_NAME(wg_each_2_1_batch)(size_t rows, void (*f)(const WG_REAL *WG_RESTRICT, const WG_REAL *WG_RESTRICT, WG_REAL
    *WG_RESTRICT), const WG_REAL *a, size_t a_row, const WG_REAL *b, size_t b_row, WG_REAL *x, size_t x_row) {
    for (; rows > 0; --rows, a += a_row, b += b_row, x += x_row) {
        f(a, b, x);
    }
}

WG_CALLED void WG_NAME(wg_each_3_1_batch)(size_t rows, void (*f)(const WG_REAL *WG_RESTRICT, const WG_REAL *WG_RESTRICT, const WG_REAL
    *WG_RESTRICT, WG_REAL *WG_RESTRICT), const WG_REAL *a, size_t a_row, const WG_REAL *b, size_t b_row, const WG_REAL *c, size_t c_row,
    WG_REAL *x, size_t x_row) {
    for (; rows > 0; --rows, a += a_row, b += b_row, c += c_row, x += x_row) {
        f(a, b, c, x);
    }
}

WG_CALLED void WG_NAME(wg_each_4_1_batch)(size_t rows, void (*f)(const WG_REAL *WG_RESTRICT, const WG_REAL *WG_RESTRICT, const WG_REAL
    *WG_RESTRICT, const WG_REAL *WG_RESTRICT, WG_REAL *WG_RESTRICT), const WG_REAL *a, size_t a_row, const WG_REAL *b, size_t b_row, const
    WG_REAL *c, size_t c_row, const WG_REAL *d, size_t d_row, WG_REAL *x, size_t x_row) {
    for (; rows > 0; --rows, a += a_row, b += b_row, c += c_row, d += d_row, x += x_row) {
        f(a, b, c, d, x);
    }
}

WG_CALLED size_t WG_NAME(wg_each_2_1_told_batch)(size_t rows, int32_t (*f)(const WG_REAL *WG_RESTRICT, const WG_REAL *WG_RESTRICT, WG_REAL
    *WG_RESTRICT), const WG_REAL *a, size_t a_row, const WG_REAL *b, size_t b_row, WG_REAL *x, size_t x_row, int32_t *status) {
    size_t bad = 0;
    for (; rows > 0; --rows, ++status, a += a_row, b += b_row, x += x_row) {
        *status = f(a, b, x);
        bad += *status != WALKGEN_OK;
    }
    return bad;
}

WG_CALLED size_t WG_NAME(wg_each_3_1_told_batch)(size_t rows, int32_t (*f)(const WG_REAL *WG_RESTRICT, const WG_REAL *WG_RESTRICT, const
    WG_REAL *WG_RESTRICT, WG_REAL *WG_RESTRICT), const WG_REAL *a, size_t a_row, const WG_REAL *b, size_t b_row, const WG_REAL *c, size_t
    c_row, WG_REAL *x, size_t x_row, int32_t *status) {
    size_t bad = 0;
    for (; rows > 0; --rows, ++status, a += a_row, b += b_row, c += c_row, x += x_row) {
        *status = f(a, b, c, x);
        bad += *status != WALKGEN_OK;
    }
    return bad;
}

WG_CALLED size_t WG_NAME(wg_each_3_2_told_batch)(size_t rows, int32_t (*f)(const WG_REAL *WG_RESTRICT, const WG_REAL *WG_RESTRICT, const
    WG_REAL *WG_RESTRICT, WG_REAL *WG_RESTRICT, WG_REAL *WG_RESTRICT), const WG_REAL *a, size_t a_row, const WG_REAL *b, size_t b_row,
    const WG_REAL *c, size_t c_row, WG_REAL *x, size_t x_row, WG_REAL *y, size_t y_row, int32_t *status) {
    size_t bad = 0;
    for (; rows > 0; --rows, ++status, a += a_row, b += b_row, c += c_row, x += x_row, y += y_row) {
        *status = f(a, b, c, x, y);
        bad += *status != WALKGEN_OK;
    }
    return bad;
}
#endif
