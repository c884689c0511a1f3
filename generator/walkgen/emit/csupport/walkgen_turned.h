/* walkgen_turned.h: whole blocks of rows become planes of lanes, and planes rows, by squares of numbers in vectors, where there are any;
 * walkgen_batch.h alone includes this. Numbers are bits here, of 8 bytes or of 4.
 */
#if defined(WG_LANES) && !defined(WALKGEN_TURNED) && \
    (defined(WALKGEN_VECTORS) || defined(WALKGEN_PAIRS) || (defined(__GNUC__) && defined(__aarch64__) && defined(WALKGEN_BLOCKS)))
#define WALKGEN_TURNED
#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define WALKGEN_SHUFFLEVECTOR
#endif
#endif
typedef uint64_t wg_bits_4x8 __attribute__((vector_size(32)));
typedef uint64_t wg_bits_2x8 __attribute__((vector_size(16)));
typedef uint32_t wg_bits_4x4 __attribute__((vector_size(16)));
typedef uint32_t wg_bits_8x4 __attribute__((vector_size(32)));
#if defined(WALKGEN_SHUFFLEVECTOR)
#define WG_SHUFFLE(bits, a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define WG_SHUFFLE(bits, a, b, ...) __builtin_shuffle(a, b, (bits){__VA_ARGS__})
#endif
/* By twos of numbers: gcc finds the one instruction for them. */
#define WG_PAIRS(bits, pairs, a, b, ...) (bits) WG_SHUFFLE(pairs, (pairs)(a), (pairs)(b), __VA_ARGS__)
/* Bytes of a row up to which processors see for themselves what is written next: wider ones gain a fifth by prefetching, others lose a tenth. */
#define WG_WIDE_ROW 80

/* Four lines `step` bytes apart; of four by four numbers rows become columns. */
#define WG_LINES_AT(bits, from, step, a, b, c, d) \
    bits a, b, c, d; \
    memcpy(&a, from, sizeof a), memcpy(&b, (from) + (step), sizeof b); \
    memcpy(&c, (from) + 2 * (step), sizeof c), memcpy(&d, (from) + 3 * (step), sizeof d)
#define WG_PUT_LINES(to, step, a, b, c, d) \
    memcpy(to, &a, sizeof a), memcpy((to) + (step), &b, sizeof b); \
    memcpy((to) + 2 * (step), &c, sizeof c), memcpy((to) + 3 * (step), &d, sizeof d)

#if defined(WALKGEN_VECTORS)
WG_INLINE void wg_turn_8(const char *from, ptrdiff_t across, char *to, ptrdiff_t step) {
    WG_LINES_AT(wg_bits_4x8, from, across, a, b, c, d);
    const wg_bits_4x8 even_ab = WG_SHUFFLE(wg_bits_4x8, a, b, 0, 4, 2, 6), odd_ab = WG_SHUFFLE(wg_bits_4x8, a, b, 1, 5, 3, 7);
    const wg_bits_4x8 even_cd = WG_SHUFFLE(wg_bits_4x8, c, d, 0, 4, 2, 6), odd_cd = WG_SHUFFLE(wg_bits_4x8, c, d, 1, 5, 3, 7);
    a = WG_SHUFFLE(wg_bits_4x8, even_ab, even_cd, 0, 1, 4, 5), b = WG_SHUFFLE(wg_bits_4x8, odd_ab, odd_cd, 0, 1, 4, 5);
    c = WG_SHUFFLE(wg_bits_4x8, even_ab, even_cd, 2, 3, 6, 7), d = WG_SHUFFLE(wg_bits_4x8, odd_ab, odd_cd, 2, 3, 6, 7);
    WG_PUT_LINES(to, step, a, b, c, d);
}
#else
/* Four pairs, into two lines. */
WG_INLINE void wg_turn_8_pairs(const char *from, ptrdiff_t across, char *to, ptrdiff_t step) {
    WG_LINES_AT(wg_bits_2x8, from, across, a, b, c, d);
    const wg_bits_2x8 even_ab = WG_SHUFFLE(wg_bits_2x8, a, b, 0, 2), odd_ab = WG_SHUFFLE(wg_bits_2x8, a, b, 1, 3);
    const wg_bits_2x8 even_cd = WG_SHUFFLE(wg_bits_2x8, c, d, 0, 2), odd_cd = WG_SHUFFLE(wg_bits_2x8, c, d, 1, 3);
    memcpy(to, &even_ab, 16), memcpy(to + 16, &even_cd, 16), memcpy(to + step, &odd_ab, 16), memcpy(to + step + 16, &odd_cd, 16);
}

WG_INLINE void wg_turn_8(const char *from, ptrdiff_t across, char *to, ptrdiff_t step) {
    wg_turn_8_pairs(from, across, to, step);
    wg_turn_8_pairs(from + 16, across, to + 2 * step, step);
}
#endif

WG_INLINE void wg_turn_4(const char *from, ptrdiff_t across, char *to, ptrdiff_t step) {
    WG_LINES_AT(wg_bits_4x4, from, across, a, b, c, d);
    const wg_bits_4x4 low_ab = WG_SHUFFLE(wg_bits_4x4, a, b, 0, 4, 1, 5), high_ab = WG_SHUFFLE(wg_bits_4x4, a, b, 2, 6, 3, 7);
    const wg_bits_4x4 low_cd = WG_SHUFFLE(wg_bits_4x4, c, d, 0, 4, 1, 5), high_cd = WG_SHUFFLE(wg_bits_4x4, c, d, 2, 6, 3, 7);
    a = WG_PAIRS(wg_bits_4x4, wg_bits_2x8, low_ab, low_cd, 0, 2), b = WG_PAIRS(wg_bits_4x4, wg_bits_2x8, low_ab, low_cd, 1, 3);
    c = WG_PAIRS(wg_bits_4x4, wg_bits_2x8, high_ab, high_cd, 0, 2), d = WG_PAIRS(wg_bits_4x4, wg_bits_2x8, high_ab, high_cd, 1, 3);
    WG_PUT_LINES(to, step, a, b, c, d);
}

/* Two squares side by side, of which the second's columns become the rows after the first's. */
#if defined(WALKGEN_VECTORS)
WG_INLINE void wg_turn_4_twice(const char *from, ptrdiff_t across, char *to, ptrdiff_t step) {
    WG_LINES_AT(wg_bits_8x4, from, across, a, b, c, d);
    const wg_bits_8x4 low_ab = WG_SHUFFLE(wg_bits_8x4, a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    const wg_bits_8x4 high_ab = WG_SHUFFLE(wg_bits_8x4, a, b, 2, 10, 3, 11, 6, 14, 7, 15);
    const wg_bits_8x4 low_cd = WG_SHUFFLE(wg_bits_8x4, c, d, 0, 8, 1, 9, 4, 12, 5, 13);
    const wg_bits_8x4 high_cd = WG_SHUFFLE(wg_bits_8x4, c, d, 2, 10, 3, 11, 6, 14, 7, 15);
    a = WG_PAIRS(wg_bits_8x4, wg_bits_4x8, low_ab, low_cd, 0, 4, 2, 6), b = WG_PAIRS(wg_bits_8x4, wg_bits_4x8, low_ab, low_cd, 1, 5, 3, 7);
    c = WG_PAIRS(wg_bits_8x4, wg_bits_4x8, high_ab, high_cd, 0, 4, 2, 6), d = WG_PAIRS(wg_bits_8x4, wg_bits_4x8, high_ab, high_cd, 1, 5, 3, 7);
    memcpy(to, &a, 16), memcpy(to + step, &b, 16), memcpy(to + 2 * step, &c, 16), memcpy(to + 3 * step, &d, 16);
    to += 4 * step;
    memcpy(to, (char *)&a + 16, 16), memcpy(to + step, (char *)&b + 16, 16);
    memcpy(to + 2 * step, (char *)&c + 16, 16), memcpy(to + 3 * step, (char *)&d + 16, 16);
}
#else
WG_INLINE void wg_turn_4_twice(const char *from, ptrdiff_t across, char *to, ptrdiff_t step) {
    wg_turn_4(from, across, to, step);
    wg_turn_4(from + 16, across, to + 4 * step, step);
}
#endif

/* Where the four columns from `element` on begin: the last of more than four reach back. */
WG_INLINE int wg_group_start(int element, int size) { return size < 4 || element + 4 <= size ? element : size - 4; }

/* Rows of three numbers or more, side by side, to planes `across` bytes apart. Of three a fourth is read too: there is a row after. */
WG_INLINE void wg_rows_to_planes(const char *rows, ptrdiff_t step, int size, int bytes, int lanes, char *planes, ptrdiff_t across) {
    for (int element = 0; element < size; element += 4) {
        const int start = wg_group_start(element, size);
        const char *from = rows + start * bytes;
        char *to = planes + start * across;
        for (int lane = 0; lane < lanes; lane += 4, from += 4 * step, to += 4 * bytes) {
            if (bytes == 8) {
                wg_turn_8(from, step, to, across);
            } else {
                wg_turn_4(from, step, to, across);
            }
        }
    }
}

/* One column of `lanes` rows. */
WG_INLINE void wg_column(const char *plane, int bytes, int lanes, char *to, ptrdiff_t step) {
    for (; lanes > 0; --lanes, plane += bytes, to += step) {
        memcpy(to, plane, (size_t)bytes);
    }
}

/* The same back, of `lanes` rows, by fours of columns; a single last one is left. Of three columns a fourth number is the next row's
 * first, which is set later: rows are written in order. */
WG_INLINE void wg_planes_to_rows(const char *planes, ptrdiff_t across, int size, int bytes, int lanes, char *rows, ptrdiff_t step) {
    const ptrdiff_t each = bytes == 8 ? 4 : 8;
    for (int element = 0; element < size - (size % 4 == 1); element += 4) {
        const int start = wg_group_start(element, size);
        const char *from = planes + start * across;
        char *to = rows + start * bytes;
        for (int lane = 0; lane < lanes; lane += (int)each, from += each * bytes, to += each * step) {
            if (bytes == 8) {
                wg_turn_8(from, across, to, step);
            } else {
                wg_turn_4_twice(from, across, to, step);
            }
        }
    }
    if (size % 4 == 1) {
        wg_column(planes + (size - 1) * across, bytes, lanes, rows + (size - 1) * bytes, step);
    }
}
#endif
