/* walkgen_left_over.h: what lanes leave over of a block; walkgen_batch.h alone includes this.
 *
 * Rows with an angle beyond its range, or with a status other than OK, are computed once more, alone; where a target is out of reach, or
 * unusual, by other means.
 */
#if defined(WG_LANES) && ((WG_REAL_BITS == 64 && !defined(WALKGEN_LEFT_OVER_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_LEFT_OVER_F32)))
#if WG_REAL_BITS == 64
#define WALKGEN_LEFT_OVER_F64
#else
#define WALKGEN_LEFT_OVER_F32
#endif

/* Whether any lane is left over. By words: sums and products leave the units for them free. */
static inline int WG_NAME(wg_any_left)(const WG_NAME(wg_left) *left) {
    uint64_t words[WG_LANES * sizeof *left / 8], any = 0;
    memcpy(words, left, sizeof words);
    for (size_t word = 0; word < sizeof words / sizeof *words; ++word) {
        any |= words[word];
    }
    return any != 0;
}

/* Whether a row has this status anywhere. */
static inline int WG_NAME(wg_row_has)(int32_t status, int states, const WG_REAL *row) {
    int has = 0;
    for (int state = 0; state < states; ++state) {
        has |= row[state] == (WG_REAL)status;
    }
    return has;
}

/* How far a lane is from where its port's begin: what lies in between is of no block but this. */
static inline ptrdiff_t WG_NAME(wg_place)(const struct WG_NAME(wg_port) *port, ptrdiff_t first, int lane) {
    return (port->direct ? first : 0) + lane;
}

/* One lane of a block by itself. */
WG_CALLED void WG_NAME(wg_lane_alone)(struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_lanes) *lanes, ptrdiff_t first, int lane) {
    WG_REAL in[WG_MOST_GIVEN] = {0}, out[WG_MOST_FOUND] = {0}, *number = in;
    const WG_REAL *const told = out + course->outputs - course->states;
    const struct WG_NAME(wg_port) *port = course->ports;
    for (; port < course->results; ++port, ++lanes) {
        if (port->kind != WG_NUMBER) {
            *number++ = WG_NAME(wg_integer)(WG_STATUS, (const char *)((const int32_t *)lanes->at + WG_NAME(wg_place)(port, first, lane)));
        }
        for (int element = 0; port->kind == WG_NUMBER && element < port->size; ++element) {
            *number++ = ((const WG_REAL *)lanes->at)[element * lanes->step + WG_NAME(wg_place)(port, first, lane)];
        }
    }
    course->laned->alone(in, out);
    if (course->closest && WG_NAME(wg_row_has)(WALKGEN_UNREACHABLE, course->states, told)) {
        course->closest(in, out);
    }
    course->bad += course->states > 0 && !WG_NAME(wg_row_has)(WALKGEN_OK, course->states, told);
    number = out;
    for (; port < course->end; ++port, ++lanes) {
        for (int element = 0; element < port->size; ++element) {
            ((WG_REAL *)lanes->at)[element * lanes->step + WG_NAME(wg_place)(port, first, lane)] = *number++;
        }
    }
}

/* Every lane's statuses, which no block writes: they are so but for lanes that are left over. They follow what else was found. */
static inline void WG_NAME(wg_all_ok)(struct WG_NAME(wg_course) *course) {
    const WG_REAL ok[WG_LANES] = {0};
    for (int state = course->outputs - course->states; state < course->outputs; ++state) {
        memcpy(course->found[state], ok, sizeof ok);
    }
}

/* A block of so many rows with some that are left over, or `all` of them. */
WG_CALLED void WG_NAME(wg_mend)(struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_lanes) *lanes, ptrdiff_t first, int count, int all) {
    for (int lane = 0; lane < count; ++lane) {
        if (all || course->left[lane]) {
            WG_NAME(wg_lane_alone)(course, lanes, first, lane);
        }
    }
}
#endif
