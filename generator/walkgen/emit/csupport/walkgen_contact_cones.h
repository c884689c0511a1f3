/* walkgen_contact_cones.h: the force nearest a vector that a foot can exert, and how it changes with it; walkgen_math.h explains the macros.
 *
 * A foot pushes by f = N n + T with 0 <= N <= n_max and |T| <= mu N, or T in the regular polygon of `facets` corners inside that circle.
 * The polygon's sides look along n x (x x n) turned by multiples of 2 pi / facets (x the frame's first axis; its second, where n is nearly
 * parallel to x). By the polygon's symmetry the nearest force lies in the sector of the vector, so that no number of sides costs more.
 */
#include "walkgen_spatial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_CONES_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_CONES_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_CONES_F64
#else
#define WALKGEN_CONTACT_CONES_F32
#endif
#ifndef WG_CONTACT_STICK
#define WG_CONTACT_STICK 0
#define WG_CONTACT_SLIDE 1
#define WG_CONTACT_FREE 2
#endif

/* What a foot can exert; `facets` 0 for the circle, else `t` are the first side's direction and the one a quarter turn on. */
struct WG_NAME(wg_contact_cone) {
    WG_REAL n[3], t[2][3], mu, n_max, side, corner; /* a side's distance from the axis and half its length, for mu N = 1 */
    int32_t facets;
};

/* A nearest force, its derivative full 1 + sum of c v v', and how far N + mu |T| of the vector is above 0: with n_max, the most that the
 * vector's product with a force can be. */
struct WG_NAME(wg_contact_image) {
    WG_REAL f[3], v[2][3], c[2], lack;
    int32_t full, count, state;
};

/* The sides of the polygon, whose directions depend on n alone. */
static inline void WG_NAME(wg_contact_sides)(int32_t facets, struct WG_NAME(wg_contact_cone) * cone) {
    const WG_REAL *n = cone->n;
    const int other = WG_ABS(n[0]) > WG_C(0.9);
    const WG_REAL angle = WG_PI / (WG_REAL)(facets > 0 ? facets : 4), along = n[other];
    WG_REAL length;
    int i;
    cone->facets = facets;
    cone->side = facets == 4 ? WG_C(0.7071067811865476) : WG_COS(angle);
    cone->corner = facets == 4 ? WG_C(0.7071067811865476) : WG_SIN(angle);
    for (i = 0; i < 3; ++i) {
        cone->t[0][i] = (i == other ? WG_C(1.0) : WG_C(0.0)) - along * n[i];
    }
    length = WG_NAME(wg_norm)(cone->t[0]);
    for (i = 0; i < 3; ++i) {
        cone->t[0][i] /= length;
    }
    WG_NAME(wg_cross)(n, cone->t[0], cone->t[1]);
}

/* Where the direction of a vector meets the polygon: the unit vector of the nearest side, the one along it towards the vector, and the
 * vector's parts in both. */
static inline void WG_NAME(wg_contact_sector)(const struct WG_NAME(wg_contact_cone) * cone, const WG_REAL z[3], WG_REAL e[3], WG_REAL w[3],
                                              WG_REAL *u, WG_REAL *v) {
    const WG_REAL a = WG_NAME(wg_dot)(cone->t[0], z), b = WG_NAME(wg_dot)(cone->t[1], z);
    WG_REAL c, s;
    int i;
    if (cone->facets == 4) {
        const int first = WG_ABS(a) >= WG_ABS(b);
        c = first ? (a < WG_C(0.0) ? WG_C(-1.0) : WG_C(1.0)) : WG_C(0.0);
        s = first ? WG_C(0.0) : (b < WG_C(0.0) ? WG_C(-1.0) : WG_C(1.0));
    } else {
        const WG_REAL sides = (WG_REAL)cone->facets, turn = WG_ATAN2(b, a) * (sides / (WG_C(2.0) * WG_PI));
        const WG_REAL angle = (WG_REAL)(int32_t)(turn + (turn < WG_C(0.0) ? WG_C(-0.5) : WG_C(0.5))) * (WG_C(2.0) * WG_PI / sides);
        c = WG_COS(angle);
        s = WG_SIN(angle);
    }
    *u = c * a + s * b;
    *v = c * b - s * a;
    for (i = 0; i < 3; ++i) {
        const WG_REAL along = c * cone->t[1][i] - s * cone->t[0][i];
        e[i] = c * cone->t[0][i] + s * cone->t[1][i];
        w[i] = *v < WG_C(0.0) ? -along : along;
    }
    *v = WG_ABS(*v);
}

/* f = N n + a e + b w and the derivative's vectors: `first` along n + slope e + rise w, `second` along w. */
static inline void WG_NAME(wg_contact_set)(const WG_REAL n[3], const WG_REAL e[3], const WG_REAL w[3], const WG_REAL parts[3], WG_REAL slope,
                                           WG_REAL rise, WG_REAL first, WG_REAL second, struct WG_NAME(wg_contact_image) * image) {
    int i;
    for (i = 0; i < 3; ++i) {
        image->f[i] = parts[0] * n[i] + parts[1] * e[i] + parts[2] * w[i];
        image->v[0][i] = n[i] + slope * e[i] + rise * w[i];
        image->v[1][i] = w[i];
    }
    image->c[0] = first;
    image->c[1] = second;
    image->full = 0;
    image->count = 2;
    image->state = parts[0] > WG_C(0.0) ? WG_CONTACT_SLIDE : WG_CONTACT_FREE;
}

/* No force. */
static inline void WG_NAME(wg_contact_unloaded)(struct WG_NAME(wg_contact_image) * image) {
    image->f[0] = image->f[1] = image->f[2] = WG_C(0.0);
    image->full = image->count = 0;
    image->state = WG_CONTACT_FREE;
}

/* The vector itself, or N cut to n_max. */
static inline void WG_NAME(wg_contact_inside)(const struct WG_NAME(wg_contact_cone) * cone, const WG_REAL z[3], WG_REAL N,
                                              struct WG_NAME(wg_contact_image) * image) {
    const WG_REAL excess = N > cone->n_max ? N - cone->n_max : WG_C(0.0);
    int i;
    for (i = 0; i < 3; ++i) {
        image->f[i] = z[i] - excess * cone->n[i];
        image->v[0][i] = cone->n[i];
    }
    image->full = 1;
    image->count = N > cone->n_max;
    image->c[0] = WG_C(-1.0);
    image->state = WG_CONTACT_STICK;
}

/* The nearest force within the polygon. */
static inline void WG_NAME(wg_contact_nearest_faceted)(const struct WG_NAME(wg_contact_cone) * cone, const WG_REAL z[3],
                                                       struct WG_NAME(wg_contact_image) * image) {
    const WG_REAL N = WG_NAME(wg_dot)(cone->n, z), side = cone->mu * cone->side, corner = cone->mu * cone->corner, top = cone->n_max;
    WG_REAL e[3], w[3], u, v, parts[3], on_side, on_corner;
    WG_NAME(wg_contact_sector)(cone, z, e, w, &u, &v);
    image->lack = WG_MAX(N + side * u + corner * v, WG_C(0.0));
    on_side = (N + side * u) / (WG_C(1.0) + side * side);
    on_corner = (N + side * u + corner * v) / (WG_C(1.0) + side * side + corner * corner);
    if (!(on_corner > WG_C(0.0))) {
        WG_NAME(wg_contact_unloaded)(image);
    } else if (cone->mu > WG_C(0.0) && u <= side * WG_MIN(N, top)) {
        WG_NAME(wg_contact_inside)(cone, z, N, image);
    } else if (cone->mu > WG_C(0.0) && v <= corner * WG_MIN(on_side, top)) {
        const int below = on_side <= top;
        parts[0] = below ? on_side : top;
        parts[1] = side * parts[0];
        parts[2] = v;
        WG_NAME(wg_contact_set)(cone->n, e, w, parts, side, WG_C(0.0), below ? WG_C(1.0) / (WG_C(1.0) + side * side) : WG_C(0.0),
                                WG_C(1.0), image);
    } else {
        const int below = on_corner <= top;
        parts[0] = below ? on_corner : top;
        parts[1] = side * parts[0];
        parts[2] = corner * parts[0];
        WG_NAME(wg_contact_set)(cone->n, e, w, parts, side, corner,
                                below ? WG_C(1.0) / (WG_C(1.0) + side * side + corner * corner) : WG_C(0.0), WG_C(0.0), image);
    }
}

/* The nearest force within the circle. */
static inline void WG_NAME(wg_contact_nearest)(const struct WG_NAME(wg_contact_cone) * cone, const WG_REAL z[3],
                                               struct WG_NAME(wg_contact_image) * image) {
    const WG_REAL *n = cone->n, mu = cone->mu, N = WG_NAME(wg_dot)(n, z), top = cone->n_max;
    WG_REAL e[3], w[3], t, inverse, along, scale, parts[3];
    int i;
    for (i = 0; i < 3; ++i) {
        e[i] = z[i] - N * n[i];
    }
    t = WG_NAME(wg_norm)(e);
    along = N + mu * t;
    image->lack = WG_MAX(along, WG_C(0.0));
    if (!(mu * t > -N)) {
        WG_NAME(wg_contact_unloaded)(image);
        return;
    }
    if (t <= mu * WG_MIN(N, top) && mu > WG_C(0.0)) {
        WG_NAME(wg_contact_inside)(cone, z, N, image);
        return;
    }
    scale = WG_C(1.0) / (WG_C(1.0) + mu * mu);
    inverse = t > WG_C(0.0) ? WG_C(1.0) / t : WG_C(0.0);
    for (i = 0; i < 3; ++i) {
        e[i] *= inverse;
    }
    WG_NAME(wg_cross)(n, e, w);
    along *= scale;
    scale = along <= top ? scale : WG_C(0.0);
    parts[0] = along <= top ? along : top;
    parts[1] = mu * parts[0];
    parts[2] = WG_C(0.0);
    WG_NAME(wg_contact_set)(n, e, w, parts, mu, WG_C(0.0), scale, parts[1] * inverse, image);
}

#endif
