/* walkgen_left_over.h: what lanes leave over of a block; walkgen_batch.h alone includes this.
 *
 * Rows with an angle beyond its range are computed once more, alone, and rows with a target out of reach by other means.
 */
#if defined(WG_LANES) && ((WG_REAL_BITS == 64 && !defined(WALKGEN_LEFT_OVER_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_LEFT_OVER_F32)))
#if WG_REAL_BITS == 64
#define WALKGEN_LEFT_OVER_F64
#else
#define WALKGEN_LEFT_OVER_F32
#endif

/* Whether any of so many bytes, some lines of the cache, is not 0. Loops over words compilers turn into vectors that they write and read back. */
static inline int WG_NAME(wg_any)(size_t bytes, const void *lanes) {
    const char *at = (const char *)lanes, *const end = at + bytes;
#if defined(WALKGEN_VECTORS)
    wg_bits_4x8 some, any = {0};
    for (; at < end; at += sizeof some) {
        memcpy(&some, at, sizeof some);
        any |= some;
    }
    any |= WG_SHUFFLE(wg_bits_4x8, any, any, 2, 3, 0, 1);
    return (any[0] | any[1]) != 0;
#else
    uint64_t some, any = 0;
    for (; at < end; at += sizeof some) {
        memcpy(&some, at, sizeof some);
        any |= some;
    }
    return any != 0;
#endif
}

/* The same of as few as tell of lost angles: beside sums and products, which leave the units for words free. */
static inline int WG_NAME(wg_any_lost)(const WG_NAME(wg_lost) *lost) {
    uint64_t words[WG_LANES * sizeof *lost / 8], any = 0;
    memcpy(words, lost, sizeof words);
    for (size_t word = 0; word < sizeof words / sizeof *words; ++word) {
        any |= words[word];
    }
    return any != 0;
}

/* One lane of a block by itself. */
WG_CALLED void WG_NAME(wg_lane_alone)(const struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_gathered) *gathered, WG_NAME(wg_alone) alone,
                                      int lane) {
    WG_REAL in[WG_MOST_GIVEN] = {0}, out[WG_MOST_FOUND] = {0}, *number = in;
    const struct WG_NAME(wg_lanes) *lanes = gathered->lanes;
    const struct WG_NAME(wg_port) *port = course->ports;
    for (; port < course->results; ++port, ++lanes) {
        for (int element = 0; element < port->size; ++element) {
            *number++ = lanes->at[element * lanes->step + lane];
        }
    }
    alone(in, out);
    number = out;
    for (; port < course->end; ++port, ++lanes) {
        for (int element = 0; element < port->size; ++element) {
            lanes->at[element * lanes->step + lane] = *number++;
        }
    }
}

/* Whether a row has this status anywhere, of those that follow one another in lanes. */
static inline int WG_NAME(wg_lane_has)(int32_t status, int states, const WG_REAL *lane) {
    int has = 0;
    for (; states > 0; --states, lane += WG_LANES) {
        has |= *lane == (WG_REAL)status;
    }
    return has;
}

/* A block with rows that need more: where angles are lost, and where targets are out of reach, as `told` by its statuses. */
WG_CALLED void WG_NAME(wg_mend)(struct WG_NAME(wg_course) *course, int count, const struct WG_NAME(wg_gathered) *gathered,
                                const WG_REAL (*told)[WG_LANES]) {
    const int states = course->states;
    for (int lane = count > WG_FEW_ROWS && WG_NAME(wg_any_lost)(course->lost) ? 0 : count; lane < count; ++lane) {
        if (course->lost[lane]) {
            WG_NAME(wg_lane_alone)(course, gathered, course->laned->alone, lane);
        }
    }
    for (int lane = course->closest ? 0 : count; lane < count; ++lane) {
        if (WG_NAME(wg_lane_has)(WALKGEN_UNREACHABLE, states, &told[0][lane])) {
            WG_NAME(wg_lane_alone)(course, gathered, course->closest, lane);
        }
    }
    for (int lane = states > 0 ? 0 : count; lane < count; ++lane) {
        course->bad += !WG_NAME(wg_lane_has)(WALKGEN_OK, states, &told[0][lane]);
    }
}

/* All that is to be done about so many rows, few of which were computed alone. Their statuses follow what else was found. */
static inline void WG_NAME(wg_finish)(struct WG_NAME(wg_course) *course, int count, const struct WG_NAME(wg_gathered) *gathered) {
    const WG_REAL(*const told)[WG_LANES] = (const WG_REAL(*)[WG_LANES])(course->found + course->outputs - course->states);
    course->calm = count > WG_FEW_ROWS && !WG_NAME(wg_any_lost)(course->lost) &&
                   !WG_NAME(wg_any)((size_t)course->states * sizeof *told, told);
    if (!course->calm) {
        WG_NAME(wg_mend)(course, count, gathered, told);
    }
}
#endif
