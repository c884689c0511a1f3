/* walkgen_turned.h: whole blocks of rows become lanes, and lanes rows, in squares of four numbers; walkgen_batch.h alone includes this, where
 * WALKGEN_VECTORS is defined.
 */
#if defined(WG_X4)
#if defined(WALKGEN_SHUFFLEVECTOR)
#define WG_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define WG_SHUFFLE(a, b, i, j, k, l) __builtin_shuffle(a, b, (WG_X4_BITS){i, j, k, l})
#endif
/* Bytes of a row up to which processors see for themselves what is written next: wider ones gain a fifth by prefetching, others lose a tenth. */
#define WG_WIDE_ROW 80

#if defined(__clang__)
#define WG_STREAM(to, from) __builtin_nontemporal_store(from, to)
#elif WG_REAL_BITS == 64
#define WG_STREAM(to, from) __builtin_ia32_movntpd256((double *)(to), from)
#else
#define WG_STREAM(to, from) __builtin_ia32_movntps((float *)(to), from)
#endif

/* A plane's lanes past the cache, into which what is written would be read first; `to` begins a line of it. */
WG_INLINE void WG_NAME(wg_stream_lanes)(WG_REAL *to, const WG_REAL *lanes) {
    for (int at = 0; at < WG_LANES; at += 4) {
        WG_X4 four;
        memcpy(&four, lanes + at, sizeof four);
        WG_STREAM((WG_X4 *)(void *)(to + at), four);
    }
}

struct WG_NAME(wg_square) {
    WG_X4 line[4];
};

/* Rows become columns. */
WG_INLINE struct WG_NAME(wg_square) WG_NAME(wg_transposed)(struct WG_NAME(wg_square) s) {
    const WG_X4 low_ab = WG_SHUFFLE(s.line[0], s.line[1], 0, 4, 2, 6), high_ab = WG_SHUFFLE(s.line[0], s.line[1], 1, 5, 3, 7);
    const WG_X4 low_cd = WG_SHUFFLE(s.line[2], s.line[3], 0, 4, 2, 6), high_cd = WG_SHUFFLE(s.line[2], s.line[3], 1, 5, 3, 7);
    s.line[0] = WG_SHUFFLE(low_ab, low_cd, 0, 1, 4, 5);
    s.line[1] = WG_SHUFFLE(high_ab, high_cd, 0, 1, 4, 5);
    s.line[2] = WG_SHUFFLE(low_ab, low_cd, 2, 3, 6, 7);
    s.line[3] = WG_SHUFFLE(high_ab, high_cd, 2, 3, 6, 7);
    return s;
}

WG_INLINE struct WG_NAME(wg_square) WG_NAME(wg_square_at)(const WG_REAL *from, ptrdiff_t step) {
    struct WG_NAME(wg_square) s;
    memcpy(&s.line[0], from, sizeof s.line[0]);
    memcpy(&s.line[1], from + step, sizeof s.line[1]);
    memcpy(&s.line[2], from + 2 * step, sizeof s.line[2]);
    memcpy(&s.line[3], from + 3 * step, sizeof s.line[3]);
    return s;
}

/* The first lines, all four where `lines` is at least 4. */
WG_INLINE void WG_NAME(wg_put_square)(struct WG_NAME(wg_square) s, WG_REAL *to, ptrdiff_t step, int lines) {
    memcpy(to, &s.line[0], sizeof s.line[0]);
    memcpy(to + step, &s.line[1], sizeof s.line[1]);
    memcpy(to + 2 * step, &s.line[2], sizeof s.line[2]);
    if (lines > 3) {
        memcpy(to + 3 * step, &s.line[3], sizeof s.line[3]);
    }
}

/* A whole block of rows of three numbers or more, side by side, four rows at a time. Of three a fourth is read too: there is a row after. */
WG_INLINE void WG_NAME(wg_gather_turned)(const WG_REAL *numbers, ptrdiff_t step, int size, WG_REAL (*WG_RESTRICT given)[WG_LANES]) {
    for (int element = 0; element < size; element += 4) {
        const int start = size < 4 || element + 4 <= size ? element : size - 4;
        for (int lane = 0; lane < WG_LANES; lane += 4) {
            const struct WG_NAME(wg_square) rows = WG_NAME(wg_square_at)(numbers + lane * step + start, step);
            WG_NAME(wg_put_square)(WG_NAME(wg_transposed)(rows), &given[start][lane], WG_LANES, size);
        }
    }
}

/* Some elements of some rows, one after another. */
WG_INLINE void WG_NAME(wg_scatter_each)(WG_REAL *numbers, ptrdiff_t step, int element, int size, int lane,
                                        const WG_REAL (*WG_RESTRICT found)[WG_LANES]) {
    for (; element < size; ++element) {
        for (int row = lane; row < WG_LANES; ++row) {
            numbers[row * step + element] = found[element][row];
        }
    }
}

/* The same back. A fourth number after three is the next row's first, which that row then sets; the last rows are not written so. */
WG_INLINE void WG_NAME(wg_scatter_turned)(WG_REAL *numbers, ptrdiff_t step, int size, const WG_REAL (*WG_RESTRICT found)[WG_LANES]) {
    const int lanes = size < 4 ? WG_LANES - 4 : WG_LANES, single = size % 4 == 1;
    const ptrdiff_t beyond = step * (ptrdiff_t)sizeof(WG_REAL) > WG_WIDE_ROW ? WG_LANES * step : 0;
    for (ptrdiff_t ahead = 0; ahead < beyond; ahead += (ptrdiff_t)(64 / sizeof(WG_REAL))) {
        __builtin_prefetch(numbers + WG_LANES * step + ahead, 1); /* the next block's */
    }
    for (int element = 0; element < size - single; element += 4) {
        const int start = size < 4 || element + 4 <= size ? element : size - 4;
        for (int lane = 0; lane < lanes; lane += 4) {
            const struct WG_NAME(wg_square) columns = WG_NAME(wg_square_at)(&found[start][lane], WG_LANES);
            WG_NAME(wg_put_square)(WG_NAME(wg_transposed)(columns), numbers + lane * step + start, step, 4);
        }
    }
    WG_NAME(wg_scatter_each)(numbers, step, single ? size - 1 : 0, single ? size : 3, single ? 0 : lanes, found);
}

/* Statuses of four branches or more, those of a row side by side. */
WG_INLINE void WG_NAME(wg_scatter_statuses)(int32_t *start, int size, const WG_REAL (*WG_RESTRICT found)[WG_LANES]) {
    WG_ALIGNED WG_REAL numbers[WG_LANES * WG_MOST_STATUSES];
    WG_NAME(wg_scatter_turned)(numbers, size, size, found);
    for (int block = 0; block < size * WG_LANES; block += WG_LANES) {
        for (int at = 0; at < WG_LANES; ++at) {
            start[block + at] = (int32_t)numbers[block + at];
        }
    }
}

#undef WG_SHUFFLE
#undef WG_STREAM
#undef WG_WIDE_ROW
#endif
