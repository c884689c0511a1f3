/* walkgen_ports.h: how a block's numbers come from an array of rows into lanes, and results go back; walkgen_batch.h alone includes this.
 *
 * Whole blocks are moved by what suits the array's strides, chosen once for all rows; anything else goes number by number. Numbers whose
 * rows lie together are lanes as they are.
 */
#if defined(WG_LANES) && ((WG_REAL_BITS == 64 && !defined(WALKGEN_PORTS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_PORTS_F32)))
#if WG_REAL_BITS == 64
#define WALKGEN_PORTS_F64
#else
#define WALKGEN_PORTS_F32
#endif

/* An array on its way: where its next block begins, and what moves whole blocks between it and lanes; `beyond` where that reaches into the row
 * after, `direct` where whole blocks stay where they are, `filled` where statuses lie together, so that those of many rows can be set at once.
 */
struct WG_NAME(wg_port) {
    char *at;
    void (*move)(const struct WG_NAME(wg_port) *port, void *lanes);
    ptrdiff_t row, element;
    int32_t size, kind, rows, beyond, direct, filled;
};

/* An integer of this kind as a number; beyond 2^24, which a float counts to, it may be any such. */
static inline WG_REAL WG_NAME(wg_integer)(int32_t kind, const char *from) {
    const int32_t most = 1 << 24;
    int32_t narrow;
    int64_t integer;
    if (kind == WG_LONG) {
        memcpy(&integer, from, sizeof integer);
    } else {
        memcpy(&narrow, from, sizeof narrow);
        integer = narrow;
    }
    return (WG_REAL)(int32_t)(integer > most ? most : integer < -most ? -most : integer);
}

/* Numbers of so many rows to lanes, one by one. */
static inline void WG_NAME(wg_gather)(const struct WG_NAME(wg_port) *port, int first, int count, WG_REAL (*given)[WG_LANES]) {
    const char *at = port->at + first * port->row;
    for (int element = 0; element < port->size; ++element, at += port->element) {
        const char *from = at;
        int lane = first;
        for (; lane + 4 <= count; lane += 4, from += 4 * port->row) {
            WG_REAL four[4]; /* all are read before any is written: nothing says that they are apart */
            memcpy(&four[0], from, sizeof(WG_REAL)), memcpy(&four[1], from + port->row, sizeof(WG_REAL));
            memcpy(&four[2], from + 2 * port->row, sizeof(WG_REAL)), memcpy(&four[3], from + 3 * port->row, sizeof(WG_REAL));
            memcpy(&given[element][lane], four, sizeof four);
        }
        for (; lane < count; ++lane, from += port->row) {
            memcpy(&given[element][lane], from, sizeof(WG_REAL));
        }
    }
}

/* Integers, of which a port has one. */
static inline void WG_NAME(wg_gather_integers)(const struct WG_NAME(wg_port) *port, int count, int32_t *given) {
    const char *from = port->at;
    for (int lane = 0; lane < count; ++lane, from += port->row) {
        given[lane] = (int32_t)WG_NAME(wg_integer)(port->kind, from);
    }
}

/* The first row's once more in all lanes from this one on. */
static inline void WG_NAME(wg_repeat)(const struct WG_NAME(wg_port) *port, int from, void *lanes) {
    WG_REAL(*const given)[WG_LANES] = (WG_REAL(*)[WG_LANES])lanes;
    int32_t *const integers = (int32_t *)lanes;
    for (int lane = from; lane < WG_LANES; ++lane) {
        if (port->kind != WG_NUMBER) {
            integers[lane] = integers[0];
        }
        for (int element = 0; port->kind == WG_NUMBER && element < port->size; ++element) {
            given[element][lane] = given[element][0];
        }
    }
}

/* And from lanes. */
static inline void WG_NAME(wg_scatter)(const struct WG_NAME(wg_port) *port, int count, WG_REAL (*found)[WG_LANES]) {
    char *at = port->at;
    for (int element = 0; element < port->size; ++element, at += port->element) {
        char *to = at;
        int lane = 0;
        for (; lane + 4 <= count && port->kind == WG_NUMBER; lane += 4, to += 4 * port->row) {
            const WG_REAL *const from = &found[element][lane];
            memcpy(to, from, sizeof *from), memcpy(to + port->row, from + 1, sizeof *from);
            memcpy(to + 2 * port->row, from + 2, sizeof *from), memcpy(to + 3 * port->row, from + 3, sizeof *from);
        }
        for (; lane < count && port->kind == WG_NUMBER; ++lane, to += port->row) {
            memcpy(to, &found[element][lane], sizeof(WG_REAL));
        }
        for (; lane < count && port->kind == WG_STATUS; ++lane, to += port->row) {
            const int32_t status = (int32_t)found[element][lane];
            memcpy(to, &status, sizeof status);
        }
    }
}

/* Whole blocks so; a number of rows that is known would be written out, row after row. */
WG_CALLED void WG_NAME(wg_gather_any)(const struct WG_NAME(wg_port) *port, void *lanes) {
    WG_NAME(wg_gather)(port, 0, port->rows, (WG_REAL(*)[WG_LANES])lanes);
}

WG_CALLED void WG_NAME(wg_gather_any_integers)(const struct WG_NAME(wg_port) *port, void *lanes) {
    WG_NAME(wg_gather_integers)(port, port->rows, (int32_t *)lanes);
}

WG_CALLED void WG_NAME(wg_scatter_any)(const struct WG_NAME(wg_port) *port, void *lanes) {
    WG_NAME(wg_scatter)(port, port->rows, (WG_REAL(*)[WG_LANES])lanes);
}

/* Statuses as integers. */
static inline void WG_NAME(wg_integers)(const WG_REAL *WG_RESTRICT found, int32_t *WG_RESTRICT states) {
    for (int lane = 0; lane < WG_LANES; ++lane) {
        states[lane] = (int32_t)found[lane];
    }
}

/* Where an element's rows lie together; of numbers, and of integers that are inputs, such are lanes as they are. */
WG_CALLED void WG_NAME(wg_scatter_status_planes)(const struct WG_NAME(wg_port) *port, void *lanes) {
    WG_REAL(*const found)[WG_LANES] = (WG_REAL(*)[WG_LANES])lanes;
    char *to = port->at;
    for (int element = 0; element < port->size; ++element, to += port->element) {
        int32_t states[WG_LANES];
        WG_NAME(wg_integers)(found[element], states);
        memcpy(to, states, sizeof states);
    }
}

/* Rows of whole blocks without any status but OK, which is 0: of no bits as an integer and as the number that lanes have. */
static inline void WG_NAME(wg_scatter_ok)(const struct WG_NAME(wg_port) *port, ptrdiff_t rows, const void *lanes) {
    const int apart = port->row == (ptrdiff_t)sizeof(int32_t); /* each element's */
    const int runs = apart ? port->size : 1;
    const ptrdiff_t together = apart ? rows : rows * port->size;
    for (int run = 0; run < runs; ++run) {
        char *to = port->at + run * port->element;
        for (ptrdiff_t status = 0; status < together; status += WG_LANES, to += sizeof(int32_t[WG_LANES])) {
            memcpy(to, lanes, sizeof(int32_t[WG_LANES]));
        }
    }
}

#if defined(WALKGEN_TURNED)
/* Where a row's elements do. */
WG_CALLED void WG_NAME(wg_gather_rows)(const struct WG_NAME(wg_port) *port, void *lanes) {
    wg_rows_to_planes(port->at, port->row, port->size, sizeof(WG_REAL), WG_LANES, (char *)lanes, sizeof(WG_REAL[WG_LANES]));
}

WG_CALLED void WG_NAME(wg_scatter_rows)(const struct WG_NAME(wg_port) *port, void *lanes) {
    const ptrdiff_t beyond = port->row > WG_WIDE_ROW ? port->rows * port->row : 0;
    for (ptrdiff_t ahead = 0; ahead < beyond; ahead += WG_LINE) {
        __builtin_prefetch(port->at + port->rows * port->row + ahead, 1); /* the next block's */
    }
    wg_planes_to_rows((const char *)lanes, sizeof(WG_REAL[WG_LANES]), port->size, sizeof(WG_REAL), WG_LANES, port->at, port->row);
}

WG_CALLED void WG_NAME(wg_scatter_status_rows)(const struct WG_NAME(wg_port) *port, void *lanes) {
    WG_REAL(*const found)[WG_LANES] = (WG_REAL(*)[WG_LANES])lanes;
    WG_ALIGNED int32_t states[WG_MOST_STATUSES][WG_LANES];
    for (int element = 0; element < port->size; ++element) {
        WG_NAME(wg_integers)(found[element], states[element]);
    }
    wg_planes_to_rows((const char *)states, sizeof *states, port->size, sizeof(int32_t), WG_LANES, port->at, port->row);
}
#endif

/* How whole blocks of an array are read, or written; integers of functions without `statuses` are results like others. */
static inline void WG_NAME(wg_choose)(struct WG_NAME(wg_port) *port, int written, int statuses) {
    const int integer = port->kind != WG_NUMBER;
    const ptrdiff_t bytes = integer ? (ptrdiff_t)sizeof(int32_t) : (ptrdiff_t)sizeof(WG_REAL);
    port->rows = WG_LANES, port->beyond = port->filled = 0;
    port->direct = port->kind != WG_LONG && !(integer && written) && port->row == bytes &&
                   (((uintptr_t)port->at | (uintptr_t)port->element) & (uintptr_t)(bytes - 1)) == 0;
    if (port->direct) {
        return;
    }
    port->filled = integer && written && statuses && (port->row == bytes || (port->element == bytes && port->row == port->size * bytes));
    port->move = written ? WG_NAME(wg_scatter_any) : integer ? WG_NAME(wg_gather_any_integers) : WG_NAME(wg_gather_any);
    if (integer && written && port->row == bytes) {
        port->move = WG_NAME(wg_scatter_status_planes);
    }
#if defined(WALKGEN_TURNED)
    const int turns = written ? port->size > 3 || port->row == 3 * bytes : !integer;
    if (port->element == bytes && port->row >= port->size * bytes && port->size >= 3 && turns) {
        port->move = integer ? WG_NAME(wg_scatter_status_rows) : written ? WG_NAME(wg_scatter_rows) : WG_NAME(wg_gather_rows);
        port->beyond = port->size == 3;
    }
#endif
}
#endif
