/* walkgen_carry.h: what a batch carries from arrays to lanes and back, block after block; walkgen_batch.h alone includes this.
 *
 * Ports that stay where they are (walkgen_ports.h) are passed by.
 */
#if defined(WG_LANES) && ((WG_REAL_BITS == 64 && !defined(WALKGEN_CARRY_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CARRY_F32)))
#if WG_REAL_BITS == 64
#define WALKGEN_CARRY_F64
#else
#define WALKGEN_CARRY_F32
#endif

/* The numbers of a block that has another one after it, and of the last one. */
static inline void WG_NAME(wg_take)(struct WG_NAME(wg_course) *course, const struct WG_NAME(wg_gathered) *gathered) {
    const struct WG_NAME(wg_lanes) *lanes = gathered->lanes;
    for (struct WG_NAME(wg_port) *port = course->ports; port < course->results; ++port, ++lanes) {
        if (!port->direct) {
            port->move(port, lanes->at);
            port->at += WG_LANES * port->row;
        }
    }
}

static inline void WG_NAME(wg_gather_last)(const struct WG_NAME(wg_port) *port, int count, void *lanes) {
    int first = 0;
#if defined(WALKGEN_TURNED)
    if (port->beyond) {
        first = (count - 1) / 4 * 4;
        wg_rows_to_planes(port->at, port->row, port->size, sizeof(WG_REAL), first, (char *)lanes, sizeof(WG_REAL[WG_LANES]));
    }
#endif
    if (port->kind == WG_NUMBER) {
        WG_NAME(wg_gather)(port, first, count, (WG_REAL(*)[WG_LANES])lanes);
    } else {
        WG_NAME(wg_gather_integers)(port, count, (int32_t *)lanes);
    }
}

WG_CALLED void WG_NAME(wg_take_last)(struct WG_NAME(wg_course) *course, int count, struct WG_NAME(wg_gathered) *gathered) {
    const struct WG_NAME(wg_lanes) *lanes = gathered->lanes;
    if (count < WG_LANES) {
        WG_NAME(wg_prepare)(course, gathered, 0, 1);
        for (struct WG_NAME(wg_port) *port = course->ports; port < course->end; ++port) {
            port->at += port->direct ? course->whole * port->row : 0; /* these are moved now, too */
        }
    }
    for (struct WG_NAME(wg_port) *port = course->ports; port < course->results; ++port, ++lanes) {
        if (count < WG_LANES || port->beyond) {
            WG_NAME(wg_gather_last)(port, count, lanes->at);
        } else if (!port->direct) {
            port->move(port, lanes->at);
        }
    }
}

/* And the results: of a block, or of so many rows that are calm. */
static inline void WG_NAME(wg_give_port)(const struct WG_NAME(wg_port) *port, ptrdiff_t rows, int calm, void *lanes) {
    if (calm && port->filled) {
        WG_NAME(wg_scatter_ok)(port, rows, lanes);
    } else {
        port->move(port, lanes);
    }
}

static inline void WG_NAME(wg_give)(struct WG_NAME(wg_course) *course, ptrdiff_t rows, int calm, const struct WG_NAME(wg_gathered) *gathered) {
    const struct WG_NAME(wg_lanes) *lanes = gathered->lanes + (course->results - course->ports);
    for (struct WG_NAME(wg_port) *port = course->results; course->gives && port < course->end; ++port, ++lanes) {
        if (!port->direct) {
            WG_NAME(wg_give_port)(port, rows, calm, lanes->at);
            port->at += rows * port->row;
        }
    }
    if (!calm) {
        WG_NAME(wg_all_ok)(course);
    }
}

static inline void WG_NAME(wg_give_last)(struct WG_NAME(wg_course) *course, int count, const struct WG_NAME(wg_gathered) *gathered) {
    const struct WG_NAME(wg_lanes) *lanes = gathered->lanes + (course->results - course->ports);
    for (struct WG_NAME(wg_port) *port = course->results; port < course->end; ++port, ++lanes) {
        if (count < WG_LANES || port->beyond) {
            WG_NAME(wg_scatter)(port, count, (WG_REAL(*)[WG_LANES])lanes->at);
        } else if (!port->direct) {
            WG_NAME(wg_give_port)(port, count, course->calm, lanes->at);
        }
    }
}
#endif
