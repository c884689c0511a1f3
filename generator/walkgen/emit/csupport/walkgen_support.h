/* walkgen_support.h: the support polygon of feet at any heights and how far a centre of mass is from tipping over its edges;
 * walkgen_math.h explains the macros.
 *
 * Seen along gravity: the polygon is the convex hull of the feet's projections, its edges are the lines between feet about which the robot
 * tips, level or not. Lengths inside are in units of the feet's distance from their centre (walkgen_stance.h).
 */
#include "walkgen_stance.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SUPPORT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SUPPORT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SUPPORT_F64
#define WG_ACROSS WG_C(1e-12)
#else
#define WALKGEN_SUPPORT_F32
#define WG_ACROSS WG_C(1e-5)
#endif

/* The feet about their centre; up, two level axes that make a right-handed frame with it, and feet, centre of mass and direction of travel
 * along these; the polygon's vertices, numbers of feet counterclockwise as seen from above, the lowest number first. */
struct WG_NAME(wg_support) {
    struct WG_NAME(wg_stance) stance;
    WG_REAL up[3], axis[2][3], flat[WALKGEN_MAX_FEET][3], com[3], ahead[2];
    int32_t polygon[WALKGEN_MAX_FEET], vertices;
};

/* A vector by its parts along the level axes and up. */
static inline void WG_NAME(wg_support_levelled)(const struct WG_NAME(wg_support) * support, const WG_REAL vector[3], WG_REAL flat[3]) {
    flat[0] = WG_NAME(wg_dot)(support->axis[0], vector);
    flat[1] = WG_NAME(wg_dot)(support->axis[1], vector);
    flat[2] = WG_NAME(wg_dot)(support->up, vector);
}

/* A level vector in the frame given. */
static inline void WG_NAME(wg_support_outside)(const struct WG_NAME(wg_support) * support, const WG_REAL flat[3], WG_REAL vector[3]) {
    int j;
    for (j = 0; j < 3; ++j) {
        vector[j] = flat[0] * support->axis[0][j] + flat[1] * support->axis[1][j] + flat[2] * support->up[j];
    }
}

/* a x b of level vectors. */
static inline WG_REAL WG_NAME(wg_support_turn)(const WG_REAL a[2], const WG_REAL b[2]) { return a[0] * b[1] - a[1] * b[0]; }

/* A vector's direction, of any size that is a number: 0 where it has none. */
static inline int WG_NAME(wg_support_direction)(const WG_REAL vector[3], WG_REAL unit[3]) {
    const WG_REAL size = WG_NAME(wg_stance_largest)(vector, 3);
    WG_REAL length;
    int j;
    if (!WG_NAME(wg_stance_finite)(vector, 3) || !(size > WG_C(0.0))) {
        return 0;
    }
    for (j = 0; j < 3; ++j) {
        unit[j] = vector[j] / size;
    }
    length = WG_NAME(wg_norm)(unit);
    for (j = 0; j < 3; ++j) {
        unit[j] /= length;
    }
    return 1;
}

/* The feet, gravity and up read: 0 where they are none. */
static inline int WG_NAME(wg_support_read)(int32_t k, const WG_REAL *points, const WG_REAL gravity[3],
                                           struct WG_NAME(wg_support) * support) {
    int i, j;
    if (!WG_NAME(wg_stance_place)(k, points, &support->stance) || !WG_NAME(wg_support_direction)(gravity, support->up)) {
        return 0;
    }
    for (j = 0; j < 3; ++j) {
        support->up[j] = -support->up[j];
    }
    WG_NAME(wg_across)(support->up, support->axis[0], support->axis[1]);
    for (i = 0; i < k; ++i) {
        WG_NAME(wg_support_levelled)(support, support->stance.r[i], support->flat[i]);
    }
    return 1;
}

/* A point as seen from the feet's centre along the axes: whether it is one. */
static inline int WG_NAME(wg_support_place)(const struct WG_NAME(wg_support) * support, const WG_REAL point[3], WG_REAL flat[3]) {
    WG_REAL from[3];
    int j;
    for (j = 0; j < 3; ++j) {
        from[j] = (point[j] - support->stance.centre[j]) / support->stance.length;
    }
    WG_NAME(wg_support_levelled)(support, from, flat);
    return WG_NAME(wg_dot)(flat, flat) <= WG_HUGE;
}

/* The centre of mass and the direction of travel, which must not be along gravity: whether they are some. */
static inline int WG_NAME(wg_support_aim)(const WG_REAL com[3], const WG_REAL direction[3], struct WG_NAME(wg_support) * support) {
    WG_REAL unit[3], flat[3], length;
    if (!WG_NAME(wg_support_place)(support, com, support->com) || !WG_NAME(wg_support_direction)(direction, unit)) {
        return 0;
    }
    WG_NAME(wg_support_levelled)(support, unit, flat);
    length = WG_SQRT(flat[0] * flat[0] + flat[1] * flat[1]);
    support->ahead[0] = flat[0] / length;
    support->ahead[1] = flat[1] / length;
    return length > WG_ACROSS;
}

/* Whether foot i stands above or below another to rounding, and the other is lower, or as low with a lower number. */
static inline int WG_NAME(wg_support_covers)(const struct WG_NAME(wg_support) * support, WG_REAL blur, int i) {
    const WG_REAL *mine = support->flat[i];
    int j, covered = 0;
    for (j = 0; j < support->stance.feet; ++j) {
        const WG_REAL *other = support->flat[j];
        const WG_REAL x = other[0] - mine[0], y = other[1] - mine[1], z = other[2] - mine[2];
        covered |= WG_SQRT(x * x + y * y) <= blur && (z < -blur || (z <= blur && j < i));
    }
    return covered;
}

/* The next vertex: the foot to the right of whose line from `last` there is none; of feet on one line, to rounding, the farthest. */
static inline int WG_NAME(wg_support_next)(const struct WG_NAME(wg_support) * support, const int *covered, WG_REAL blur, int last) {
    WG_REAL best[2] = {WG_C(0.0), WG_C(0.0)}, far = WG_C(0.0);
    int i, next = last;
    for (i = 0; i < support->stance.feet; ++i) {
        const WG_REAL way[2] = {support->flat[i][0] - support->flat[last][0], support->flat[i][1] - support->flat[last][1]};
        const WG_REAL length = WG_SQRT(way[0] * way[0] + way[1] * way[1]);
        const WG_REAL left = next == last ? WG_C(0.0) : WG_NAME(wg_support_turn)(best, way) / WG_MAX(far, length);
        if (covered[i] || i == last || !(left < -blur || (left <= blur && length > far))) {
            continue;
        }
        next = i;
        far = length;
        best[0] = way[0];
        best[1] = way[1];
    }
    return next;
}

/* The polygon; its number of vertices is below 3 where the feet's projections are on a line or one point, to rounding. */
static inline void WG_NAME(wg_support_hull)(struct WG_NAME(wg_support) * support) {
    const WG_REAL blur = support->stance.blur <= WG_C(1.0) ? support->stance.blur : WG_C(1.0);
    int32_t found[WALKGEN_MAX_FEET];
    int covered[WALKGEN_MAX_FEET], used[WALKGEN_MAX_FEET], i, at = -1, first = 0;
    WG_REAL far = WG_C(-1.0);
    for (i = 0; i < support->stance.feet; ++i) {
        const WG_REAL *foot = support->flat[i], square = foot[0] * foot[0] + foot[1] * foot[1];
        covered[i] = WG_NAME(wg_support_covers)(support, blur, i);
        used[i] = 0;
        at = !covered[i] && square > far ? i : at; /* the farthest from the centre is a vertex */
        far = covered[i] ? far : WG_MAX(far, square);
    }
    support->vertices = 0;
    while (at >= 0 && !used[at] && support->vertices < support->stance.feet) {
        used[at] = 1;
        found[support->vertices] = at;
        first = at < found[first] ? support->vertices : first;
        ++support->vertices;
        at = WG_NAME(wg_support_next)(support, covered, blur, at);
    }
    for (i = 0; i < support->stance.feet; ++i) {
        support->polygon[i] = i < support->vertices ? found[(first + i) % support->vertices] : -1;
    }
}

/* Of an edge: how far the centre of mass is on its inner side, and the direction along it, level. */
static inline WG_REAL WG_NAME(wg_support_inside)(const struct WG_NAME(wg_support) * support, int edge, WG_REAL along[2], WG_REAL *length) {
    const WG_REAL *a = support->flat[support->polygon[edge]];
    const WG_REAL *b = support->flat[support->polygon[(edge + 1) % support->vertices]];
    const WG_REAL from[2] = {support->com[0] - a[0], support->com[1] - a[1]};
    along[0] = b[0] - a[0];
    along[1] = b[1] - a[1];
    *length = WG_SQRT(along[0] * along[0] + along[1] * along[1]);
    along[0] /= *length;
    along[1] /= *length;
    return WG_NAME(wg_support_turn)(along, from);
}

/* How far the centre of mass is from a level segment, and the gradient of minus that. */
static inline WG_REAL WG_NAME(wg_support_apart)(const WG_REAL a[2], const WG_REAL b[2], const WG_REAL com[2], WG_REAL gradient[2]) {
    const WG_REAL x = b[0] - a[0], y = b[1] - a[1], square = x * x + y * y;
    WG_REAL share = square > WG_C(0.0) ? ((com[0] - a[0]) * x + (com[1] - a[1]) * y) / square : WG_C(0.0), away;
    share = WG_MIN(WG_MAX(share, WG_C(0.0)), WG_C(1.0));
    gradient[0] = a[0] + share * x - com[0];
    gradient[1] = a[1] + share * y - com[1];
    away = WG_SQRT(gradient[0] * gradient[0] + gradient[1] * gradient[1]);
    gradient[0] = away > WG_C(0.0) ? gradient[0] / away : WG_C(0.0);
    gradient[1] = away > WG_C(0.0) ? gradient[1] / away : WG_C(0.0);
    return away;
}

/* The static margin: signed distance of the centre of mass from the polygon's border, positive inside, minus the distance from the polygon
 * outside, also where that is a segment or a point; and its gradient. Where several edges or feet are as near, those of the first. */
static inline WG_REAL WG_NAME(wg_support_static)(const struct WG_NAME(wg_support) * support, WG_REAL gradient[2]) {
    WG_REAL least = WG_INFINITY, near = WG_INFINITY, inward[2] = {WG_C(0.0), WG_C(0.0)}, other[2], along[2], length;
    int i;
    gradient[0] = gradient[1] = WG_C(0.0);
    for (i = 0; i < support->vertices; ++i) {
        const int next = support->polygon[(i + 1) % support->vertices];
        const WG_REAL away = WG_NAME(wg_support_apart)(support->flat[support->polygon[i]], support->flat[next], support->com, other);
        const WG_REAL inside = support->vertices > 2 ? WG_NAME(wg_support_inside)(support, i, along, &length) : WG_C(-1.0);
        if (inside < least) {
            inward[0] = support->vertices > 2 ? -along[1] : WG_C(0.0);
            inward[1] = support->vertices > 2 ? along[0] : WG_C(0.0);
            least = inside;
        }
        if (away < near) {
            gradient[0] = other[0];
            gradient[1] = other[1];
            near = away;
        }
    }
    if (least >= WG_C(0.0) || near <= WG_C(0.0)) {
        gradient[0] = inward[0];
        gradient[1] = inward[1];
        return least >= WG_C(0.0) ? least : WG_C(0.0);
    }
    return -near;
}

/* The longitudinal margin along a level unit direction: how far the centre of mass can go that way before the line of an edge, negative by
 * how far it is past one; and its gradient. McGhee and Iswandhi (1979). */
static inline WG_REAL WG_NAME(wg_support_way)(const struct WG_NAME(wg_support) * support, const WG_REAL ahead[2], WG_REAL gradient[2]) {
    WG_REAL least = WG_INFINITY, along[2], length;
    int i;
    gradient[0] = gradient[1] = WG_C(0.0);
    for (i = 0; i < support->vertices; ++i) {
        const WG_REAL inside = WG_NAME(wg_support_inside)(support, i, along, &length);
        const WG_REAL out = -WG_NAME(wg_support_turn)(along, ahead);
        if (out > WG_ACROSS && inside / out < least) {
            least = inside / out;
            gradient[0] = -along[1] / out;
            gradient[1] = along[0] / out;
        }
    }
    return least;
}

/* How much higher the centre of mass must go to pass over an edge, turning about the line between its feet: |R| cos(psi) - R . up of its
 * distance R from a line inclined by psi (Messuri and Klein 1985); past the edge, minus what it takes to come back; and its gradient. */
static inline WG_REAL WG_NAME(wg_support_height)(const struct WG_NAME(wg_support) * support, int edge, WG_REAL gradient[3]) {
    const WG_REAL *a = support->flat[support->polygon[edge]];
    const WG_REAL *b = support->flat[support->polygon[(edge + 1) % support->vertices]];
    WG_REAL e[3], up[3], out[3], from[3], length, steep, high, aside, far, size;
    int j;
    for (j = 0; j < 3; ++j) {
        e[j] = b[j] - a[j];
        from[j] = support->com[j] - a[j];
    }
    length = WG_NAME(wg_norm)(e);
    for (j = 0; j < 3; ++j) {
        e[j] /= length;
    }
    steep = WG_SQRT(e[0] * e[0] + e[1] * e[1]); /* cos(psi) */
    out[0] = e[1] / steep;                      /* level, away from the other feet */
    out[1] = -e[0] / steep;
    out[2] = WG_C(0.0);
    WG_NAME(wg_cross)(out, e, up);
    high = WG_NAME(wg_dot)(from, up);
    aside = WG_NAME(wg_dot)(from, out);
    far = WG_SQRT(high * high + aside * aside);
    size = aside > WG_C(0.0) ? -steep : steep;
    for (j = 0; j < 3; ++j) {
        gradient[j] = size * ((far > WG_C(0.0) ? (high * up[j] + aside * out[j]) / far : WG_C(0.0)) - up[j]);
    }
    return size * (high > WG_C(0.0) ? aside * (aside / (far + high)) : far - high);
}

#undef WG_ACROSS
#endif
