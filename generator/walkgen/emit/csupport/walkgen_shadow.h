/* walkgen_shadow.h: which mixtures of two wrenches feet can carry on top of a load, a convex region of a plane, by its points farthest in
 * chosen directions; walkgen_math.h explains the macros.
 *
 * Every direction gives a point of the region's border and a line that it does not cross: the polygon of the points is inside the region,
 * that of the lines around it (Bretl and Lall 2008). A direction is a problem of walkgen_conic.h: the wrench across it is free, and is
 * taken out of the equations by a reflection. Feet that press against each other would leave the region without bound: normal forces count
 * up to WG_FAR loads in sum, and directions in which that is the limit are open.
 */
#include "walkgen_friction.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SHADOW_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SHADOW_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SHADOW_F64
#define WG_STEEP WG_C(1e-7)
#define WG_NONE WG_C(1e-10)
#define WG_SAME WG_C(1e-12)
#define WG_FAR WG_C(1e3)
#define WG_SPARE WG_C(1e-4)
#else
#define WALKGEN_SHADOW_F32
#define WG_STEEP WG_C(1e-4)
#define WG_NONE WG_C(5e-5)
#define WG_SAME WG_C(1e-5)
#define WG_FAR WG_C(1e2)
#define WG_SPARE WG_C(1e-2)
#endif
#ifndef WALKGEN_MAX_DIRECTIONS
#define WALKGEN_MAX_DIRECTIONS 64
#endif

/* What a direction tells of the region: the point farthest in it, how far that is, and whether it is open. */
struct WG_NAME(wg_seen) {
    WG_REAL direction[2], point[2], reach;
    int open;
};

/* The feet's forces in a basis of the `rank` wrenches that they can give; the load and the two wrenches of the plane in it. `push`, `pull`
 * and `whole` are the parts along what a reflection takes out: of the forces, of the wrench that is sought, of the rest. Then what is known
 * of the region, counterclockwise: directions, the points farthest in them, how far these are, and which are open. */
struct WG_NAME(wg_shadow) {
    struct WG_NAME(wg_friction) friction;
    int32_t rank, count;
    WG_REAL column[3 * WALKGEN_MAX_FEET][6], load[6], plane[2][6], push[3 * WALKGEN_MAX_FEET], pull, whole, gone;
    WG_REAL direction[WALKGEN_MAX_DIRECTIONS][2], point[WALKGEN_MAX_DIRECTIONS][2], reach[WALKGEN_MAX_DIRECTIONS];
    int open[WALKGEN_MAX_DIRECTIONS];
};

/* The plane's two wrenches and the load, in the stance's units about the feet's centre, in the basis: OK; SINGULAR where the feet cannot
 * give one of the two, INFEASIBLE where they cannot give the load. */
WG_CALLED int32_t WG_NAME(wg_shadow_read)(const WG_REAL *mu, WG_REAL plane[2][6], struct WG_NAME(wg_shadow) * shadow) {
    struct WG_NAME(wg_friction) *friction = &shadow->friction;
    const WG_REAL blur = friction->stance.blur <= WG_C(1.0) ? friction->stance.blur : WG_C(0.5);
    WG_REAL along[6], rest[6], lost, lacking;
    int i, j, c;
    for (i = 0; i < 3 * friction->stance.feet; ++i) {
        for (j = 0; j < 6 && i % 3 > 0 && !(mu[i / 3] > WG_C(0.0)); ++j) {
            friction->push[i][j] = WG_C(0.0);
        }
    }
    shadow->rank = WG_NAME(wg_friction_span)(0, 2, WG_MAX(WG_STEEP, blur), 0, friction);
    lost = WG_C(0.0);
    for (c = 0; c < 2; ++c) {
        for (j = 0; j < 6; ++j) {
            rest[j] = plane[c][j];
        }
        lost = WG_MAX(lost, WG_NAME(wg_stance_across)(friction->basis, shadow->rank, rest, shadow->plane[c]));
    }
    for (j = 0; j < 6; ++j) {
        rest[j] = friction->stance.load[j];
    }
    lacking = WG_NAME(wg_stance_across)(friction->basis, shadow->rank, rest, shadow->load);
    for (i = 0; i < 3 * friction->stance.feet; ++i) {
        const WG_REAL size = i % 3 == 0 ? WG_C(1.0) : mu[i / 3];
        for (j = 0; j < 6; ++j) {
            rest[j] = friction->push[i][j];
        }
        (void)WG_NAME(wg_stance_across)(friction->basis, shadow->rank, rest, along);
        for (j = 0; j < shadow->rank; ++j) {
            shadow->column[i][j] = size * along[j];
        }
    }
    shadow->count = 0;
    return lacking > WG_MAX(WG_NONE, friction->stance.noise) ? WALKGEN_INFEASIBLE : lost > WG_NONE ? WALKGEN_SINGULAR : WALKGEN_OK;
}

/* The vector m of the reflection 1 - m m' that takes v's parts from `first` on to that one. */
static inline void WG_NAME(wg_shadow_mirror)(int first, int n, const WG_REAL v[6], WG_REAL mirror[6]) {
    WG_REAL length = WG_C(0.0), size;
    int j;
    for (j = 0; j < 6; ++j) {
        mirror[j] = j >= first && j < n ? v[j] : WG_C(0.0);
        length += mirror[j] * mirror[j];
    }
    length = WG_SQRT(length);
    mirror[first] += mirror[first] < WG_C(0.0) ? -length : length;
    size = WG_SQRT(length * WG_ABS(mirror[first]));
    for (j = first; j < n; ++j) {
        mirror[j] = size > WG_C(0.0) ? mirror[j] / size : WG_C(0.0);
    }
}

/* Some reflections of a vector. */
static inline void WG_NAME(wg_shadow_mirrored)(int count, int n, WG_REAL mirrors[2][6], const WG_REAL v[6], WG_REAL found[6]) {
    int i, j;
    for (j = 0; j < 6; ++j) {
        found[j] = j < n ? v[j] : WG_C(0.0);
    }
    for (i = 0; i < count; ++i) {
        WG_REAL part = WG_C(0.0);
        for (j = i; j < n; ++j) {
            part += mirrors[i][j] * found[j];
        }
        for (j = i; j < n; ++j) {
            found[j] -= part * mirrors[i][j];
        }
    }
}

/* The equations without those along `count` free wrenches; `sought`: the wrench whose most is sought, NULL for that of a unit force along
 * all normals. */
static inline void WG_NAME(wg_shadow_pose)(int count, WG_REAL gone[2][6], const WG_REAL *sought, struct WG_NAME(wg_shadow) * shadow) {
    struct WG_NAME(wg_conic) *conic = &shadow->friction.conic;
    WG_REAL mirrors[2][6], other[6], all[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    const int n = shadow->rank;
    int i, j;
    conic->cones = shadow->friction.stance.feet;
    for (i = 0; i < count; ++i) {
        WG_NAME(wg_shadow_mirrored)(i, n, mirrors, gone[i], other);
        WG_NAME(wg_shadow_mirror)(i, n, other, mirrors[i]);
    }
    conic->rows = n - count;
    if (count > 0) {
        WG_NAME(wg_shadow_mirrored)(count, n, mirrors, gone[0], other);
        shadow->gone = other[0];
    }
    for (i = 0; i < 3 * conic->cones; ++i) {
        WG_NAME(wg_shadow_mirrored)(count, n, mirrors, shadow->column[i], other);
        shadow->push[i] = other[0];
        for (j = count; j < n; ++j) {
            conic->column[i][j - count] = other[j];
        }
        for (j = 0; j < n && i % 3 == 0; ++j) {
            all[j] += shadow->column[i][j];
        }
    }
    WG_NAME(wg_shadow_mirrored)(count, n, mirrors, shadow->load, other);
    shadow->whole = -other[0];
    for (j = count; j < n; ++j) {
        conic->b[j - count] = -other[j];
    }
    WG_NAME(wg_shadow_mirrored)(count, n, mirrors, sought ? sought : all, other);
    shadow->pull = other[0];
    for (j = count; j < n; ++j) {
        conic->a[j - count] = other[j];
    }
}

/* Whether there is a region: INFEASIBLE where no mixture of the plane's first `count` wrenches can be carried with the load. `*spare`: the
 * greatest normal force that every foot can have above what its friction needs. */
static inline int32_t WG_NAME(wg_shadow_exists)(int count, WG_REAL *spare, struct WG_NAME(wg_shadow) * shadow) {
    const struct WG_NAME(wg_conic) *conic = &shadow->friction.conic;
    int closed;
    WG_NAME(wg_shadow_pose)(count, shadow->plane, NULL, shadow);
    closed = WG_NAME(wg_conic_solve)(WG_C(1.0), &shadow->friction.conic);
    *spare = conic->s;
    return !closed && !(conic->s > WG_C(1.0)) ? WALKGEN_NO_CONVERGENCE : conic->s < -WG_NONE ? WALKGEN_INFEASIBLE : WALKGEN_OK;
}

/* One more equation and cone, for what is left of the bound on the sum of normal forces. */
static inline void WG_NAME(wg_shadow_bound)(struct WG_NAME(wg_conic) * conic) {
    const int last = conic->rows, slack = 3 * conic->cones;
    int i, j;
    for (i = 0; i < slack; ++i) {
        conic->column[i][last] = i % 3 == 0 ? WG_C(1.0) / WG_FAR : WG_C(0.0);
    }
    for (i = slack; i < slack + 3; ++i) {
        for (j = 0; j <= last; ++j) {
            conic->column[i][j] = WG_INDICATOR(i == slack && j == last);
        }
    }
    conic->a[last] = WG_C(0.0);
    conic->b[last] = WG_C(1.0);
    ++conic->rows;
    ++conic->cones;
}

/* The place of a direction among those known, after the last that it is to the left of; -1 where it is one of them. */
static inline int WG_NAME(wg_shadow_place)(const struct WG_NAME(wg_shadow) * shadow, const WG_REAL u[2]) {
    int i, place = shadow->count;
    for (i = 0; i < shadow->count; ++i) {
        const WG_REAL *here = shadow->direction[i], *after = shadow->direction[(i + 1) % shadow->count];
        const WG_REAL left = here[0] * u[1] - here[1] * u[0], right = u[0] * after[1] - u[1] * after[0];
        if (WG_ABS(left) <= WG_SAME && here[0] * u[0] + here[1] * u[1] > WG_C(0.0)) {
            return -1;
        }
        place = left > WG_C(0.0) && right > WG_C(0.0) ? i + 1 : place;
    }
    return place;
}

/* What a direction tells; whether an answer was found. */
WG_CALLED int WG_NAME(wg_shadow_probe)(const WG_REAL u[2], struct WG_NAME(wg_shadow) * shadow, struct WG_NAME(wg_seen) * seen) {
    const struct WG_NAME(wg_conic) *conic = &shadow->friction.conic;
    const WG_REAL across[2] = {-u[1], u[0]};
    WG_REAL sought[6], gone[2][6], aside;
    int i, j, closed;
    for (j = 0; j < shadow->rank; ++j) {
        sought[j] = u[0] * shadow->plane[0][j] + u[1] * shadow->plane[1][j];
        gone[0][j] = across[0] * shadow->plane[0][j] + across[1] * shadow->plane[1][j];
    }
    WG_NAME(wg_shadow_pose)(1, gone, sought, shadow);
    WG_NAME(wg_shadow_bound)(&shadow->friction.conic);
    closed = WG_NAME(wg_conic_solve)(WG_HUGE, &shadow->friction.conic);
    aside = shadow->whole - conic->s * shadow->pull;
    for (i = 0; i < 3 * shadow->friction.stance.feet; ++i) {
        aside -= shadow->push[i] * conic->x[i];
    }
    aside /= shadow->gone;
    for (j = 0; j < 2; ++j) {
        seen->direction[j] = u[j];
        seen->point[j] = conic->s * u[j] + aside * across[j];
    }
    seen->reach = conic->s;
    seen->open = conic->x[3 * shadow->friction.stance.feet] < WG_SPARE;
    return closed && WG_ABS(aside) <= WG_HUGE;
}

/* One more direction: whether it tells anything. */
static inline int WG_NAME(wg_shadow_look)(const WG_REAL u[2], struct WG_NAME(wg_shadow) * shadow) {
    const int place = WG_NAME(wg_shadow_place)(shadow, u);
    struct WG_NAME(wg_seen) seen;
    int i, j;
    if (place < 0 || shadow->count == WALKGEN_MAX_DIRECTIONS || !WG_NAME(wg_shadow_probe)(u, shadow, &seen)) {
        return 0;
    }
    for (i = shadow->count; i > place; --i) {
        shadow->reach[i] = shadow->reach[i - 1];
        shadow->open[i] = shadow->open[i - 1];
        for (j = 0; j < 2; ++j) {
            shadow->direction[i][j] = shadow->direction[i - 1][j];
            shadow->point[i][j] = shadow->point[i - 1][j];
        }
    }
    for (j = 0; j < 2; ++j) {
        shadow->direction[place][j] = seen.direction[j];
        shadow->point[place][j] = seen.point[j];
    }
    shadow->reach[place] = seen.reach;
    shadow->open[place] = seen.open;
    ++shadow->count;
    return 1;
}

/* Twice the area of the polygon of points. */
static inline WG_REAL WG_NAME(wg_shadow_area)(const struct WG_NAME(wg_shadow) * shadow) {
    WG_REAL sum = WG_C(0.0);
    int i;
    for (i = 0; i < shadow->count; ++i) {
        const WG_REAL *a = shadow->point[i], *b = shadow->point[(i + 1) % shadow->count];
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return sum;
}

/* The region by four directions to begin with, where the first `count` wrenches of the plane are free: OK; INFEASIBLE where it is empty,
 * SINGULAR where it has no area, NO_CONVERGENCE. */
WG_CALLED int32_t WG_NAME(wg_shadow_start)(int count, struct WG_NAME(wg_shadow) * shadow) {
    static const signed char starts[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    WG_REAL spare;
    int32_t status = WG_NAME(wg_shadow_exists)(count, &spare, shadow);
    int i;
    for (i = 0; i < 4 && status == WALKGEN_OK; ++i) {
        const WG_REAL u[2] = {(WG_REAL)starts[i][0], (WG_REAL)starts[i][1]};
        if (!WG_NAME(wg_shadow_look)(u, shadow)) {
            status = spare > WG_NONE ? WALKGEN_NO_CONVERGENCE : WALKGEN_SINGULAR;
        }
    }
    return status == WALKGEN_OK && spare <= WG_NONE && WG_NAME(wg_shadow_area)(shadow) <= WG_NONE ? WALKGEN_SINGULAR : status;
}

/* The outward normal of a side from a to b, and its length. */
static inline WG_REAL WG_NAME(wg_shadow_normal)(const WG_REAL a[2], const WG_REAL b[2], WG_REAL normal[2]) {
    const WG_REAL x = b[0] - a[0], y = b[1] - a[1], length = WG_SQRT(x * x + y * y);
    normal[0] = length > WG_C(0.0) ? y / length : WG_C(0.0);
    normal[1] = length > WG_C(0.0) ? -x / length : WG_C(0.0);
    return length;
}

/* Of the polygon's side after a point. */
static inline WG_REAL WG_NAME(wg_shadow_side)(const struct WG_NAME(wg_shadow) * shadow, int side, WG_REAL normal[2]) {
    return WG_NAME(wg_shadow_normal)(shadow->point[side], shadow->point[(side + 1) % shadow->count], normal);
}

#undef WG_STEEP
#undef WG_NONE
#undef WG_SAME
#undef WG_FAR
#undef WG_SPARE
#endif
