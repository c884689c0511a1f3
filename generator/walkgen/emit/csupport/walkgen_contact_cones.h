/* walkgen_contact_cones.h: the forces nearest to vectors that feet can exert, and how they change with them; walkgen_math.h explains the
 * macros.
 *
 * A foot pushes by f = N n + T with 0 <= N <= n_max and |T| <= mu N, or T in the regular polygon of `facets` corners inside that circle.
 * The polygon's first side looks along the frame's first axis as seen along n (its second axis, where n is nearly parallel to the first).
 * By the polygon's symmetry the nearest force lies in the sector of the vector, so that no number of sides costs more.
 *
 * All feet at once, component by component and without a jump, so that compilers use vector instructions; a row of numbers has room for
 * WALKGEN_MAX_FEET, a multiple of 4, and feet that fill up a group of 4 have no friction and no ease.
 */
#include "walkgen_contact_work.h"
#include "walkgen_spatial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_CONES_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_CONES_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_CONES_F64
#define WG_NOTHING WG_C(1e-90) /* its cube's inverse is a number */
#else
#define WALKGEN_CONTACT_CONES_F32
#define WG_NOTHING WG_C(1e-9)
#endif
#ifndef WG_CONTACT_STICK
#define WG_CONTACT_STICK 0
#define WG_CONTACT_SLIDE 1
#define WG_CONTACT_FREE 2
#endif

/* What feet can exert. `circle` and `flat` are 1 / (1 + s^2) for the slope s of the circle's cone and of a side. With facets, `along` and
 * `aside` are the first side's direction and the one a quarter turn on, `side` its distance from the axis and `corner` half its length, for
 * mu N = 1. */
struct WG_NAME(wg_contact_cones) {
    WG_REAL n[3][WALKGEN_MAX_FEET], mu[WALKGEN_MAX_FEET], n_max[WALKGEN_MAX_FEET], circle[WALKGEN_MAX_FEET], flat[WALKGEN_MAX_FEET];
    WG_REAL along[3][WALKGEN_MAX_FEET], aside[3][WALKGEN_MAX_FEET], side, corner;
    int32_t facets, rows; /* rows: feet and those that fill up */
};

/* Nearest forces, their derivatives (xx, xy, xz, yy, yz, zz), whether the vector lies inside (1 or 0), and how far N + mu |T| of the vector
 * is above 0: with n_max, the most that the vector's product with a force can be. */
struct WG_NAME(wg_contact_images) {
    WG_REAL f[3][WALKGEN_MAX_FEET], slope[6][WALKGEN_MAX_FEET], inside[WALKGEN_MAX_FEET], lack[WALKGEN_MAX_FEET];
};

/* Room for four feet that fill up. */
WG_INLINE void WG_NAME(wg_contact_fill)(WG_REAL *row) {
    int i;
    for (i = 0; i < 4; ++i) {
        row[i] = WG_C(0.0);
    }
}

/* A foot's friction. */
static inline void WG_NAME(wg_contact_rub)(WG_REAL mu, int i, struct WG_NAME(wg_contact_cones) * cones) {
    const WG_REAL side = mu * cones->side;
    cones->mu[i] = mu;
    cones->circle[i] = WG_C(1.0) / (WG_C(1.0) + mu * mu);
    cones->flat[i] = WG_C(1.0) / (WG_C(1.0) + side * side);
}

/* The cones' directions, those of the polygons' sides. */
static inline void WG_NAME(wg_contact_aim)(struct WG_NAME(wg_contact_cones) * cones) {
    const int32_t rows = (cones->rows + 3) & ~3;
    WG_REAL size[WALKGEN_MAX_FEET];
    int i;
    for (i = 0; i < rows; ++i) {
        const WG_REAL along = WG_ABS(cones->n[0][i]) > WG_C(0.9) ? cones->n[1][i] : cones->n[0][i];
        size[i] = WG_C(1.0) - along * along;
    }
    for (i = 0; i < rows; ++i) { /* alone, since a root may set errno */
        size[i] = WG_SQRT(size[i]);
    }
    for (i = 0; i < rows; ++i) {
        const WG_REAL x = cones->n[0][i], y = cones->n[1][i], z = cones->n[2][i], inverse = WG_C(1.0) / size[i];
        const WG_REAL other = WG_ABS(x) > WG_C(0.9) ? WG_C(1.0) : WG_C(0.0), along = WG_ABS(x) > WG_C(0.9) ? y : x;
        const WG_REAL ex = (WG_C(1.0) - other - along * x) * inverse, ey = (other - along * y) * inverse, ez = -along * z * inverse;
        cones->along[0][i] = ex;
        cones->along[1][i] = ey;
        cones->along[2][i] = ez;
        cones->aside[0][i] = y * ez - z * ey;
        cones->aside[1][i] = z * ex - x * ez;
        cones->aside[2][i] = x * ey - y * ex;
    }
}

/* Cosine and sine of the direction of the polygon's side nearest to (a, b). */
WG_INLINE void WG_NAME(wg_contact_side)(int32_t facets, WG_REAL a, WG_REAL b, WG_REAL *cosine, WG_REAL *sine) {
    if (facets == 4) {
        const WG_REAL across = a < WG_C(0.0) ? -WG_C(1.0) : WG_C(1.0), up = b < WG_C(0.0) ? -WG_C(1.0) : WG_C(1.0);
        const int first = WG_ABS(a) >= WG_ABS(b);
        *cosine = first ? across : WG_C(0.0);
        *sine = first ? WG_C(0.0) : up;
    } else {
        const WG_REAL sides = (WG_REAL)facets, turn = WG_ATAN2(b, a) * (sides / (WG_C(2.0) * WG_PI));
        const WG_REAL angle = (WG_REAL)(int32_t)(turn + (turn < WG_C(0.0) ? WG_C(-0.5) : WG_C(0.5))) * (WG_C(2.0) * WG_PI / sides);
        *cosine = WG_COS(angle);
        *sine = WG_SIN(angle);
    }
}

/* How far a force is from its cone's axis, so that mu N is the edge: |T|, or as far as the nearest side of a polygon. */
WG_INLINE WG_REAL WG_NAME(wg_contact_width)(const struct WG_NAME(wg_contact_cones) * cones, int i, const WG_REAL f[3], WG_REAL N) {
    const WG_REAL a = cones->along[0][i] * f[0] + cones->along[1][i] * f[1] + cones->along[2][i] * f[2];
    const WG_REAL b = cones->aside[0][i] * f[0] + cones->aside[1][i] * f[1] + cones->aside[2][i] * f[2];
    WG_REAL T[3], c, s;
    if (cones->facets) {
        WG_NAME(wg_contact_side)(cones->facets, a, b, &c, &s);
        return (c * a + s * b) / cones->side;
    }
    T[0] = f[0] - N * cones->n[0][i];
    T[1] = f[1] - N * cones->n[1][i];
    T[2] = f[2] - N * cones->n[2][i];
    return WG_NAME(wg_norm)(T);
}

/* The directions of the polygons' sides nearest to vectors: cosines and sines. */
WG_INLINE void WG_NAME(wg_contact_sides)(const struct WG_NAME(wg_contact_cones) * WG_RESTRICT cones, int32_t facets,
                                         WG_REAL z[3][WALKGEN_MAX_FEET], WG_REAL turn[2][WALKGEN_MAX_FEET]) {
    const int32_t rows = (cones->rows + 3) & ~3;
    int i;
    for (i = 0; i < rows; ++i) {
        const WG_REAL a = cones->along[0][i] * z[0][i] + cones->along[1][i] * z[1][i] + cones->along[2][i] * z[2][i];
        const WG_REAL b = cones->aside[0][i] * z[0][i] + cones->aside[1][i] * z[1][i] + cones->aside[2][i] * z[2][i];
        WG_NAME(wg_contact_side)(facets, a, b, &turn[0][i], &turn[1][i]);
    }
}

/* The nearest forces within polygons: a n + u e + v w, e and w across and along the nearest side; the derivative has the squares of e and w
 * where they are free, and that of q, the direction in which what is bound to n moves. */
WG_INLINE void WG_NAME(wg_contact_within_polygons)(const struct WG_NAME(wg_contact_cones) * WG_RESTRICT cones, int32_t facets,
                                                   WG_REAL z[3][WALKGEN_MAX_FEET], struct WG_NAME(wg_contact_images) * WG_RESTRICT images) {
    const int32_t rows = (cones->rows + 3) & ~3;
    WG_REAL turn[2][WALKGEN_MAX_FEET];
    int i;
    WG_NAME(wg_contact_sides)(cones, facets, z, turn);
    for (i = 0; i < rows; ++i) {
        const WG_REAL nx = cones->n[0][i], ny = cones->n[1][i], nz = cones->n[2][i], c = turn[0][i], s = turn[1][i], zero = WG_C(0.0);
        const WG_REAL side = cones->mu[i] * cones->side, corner = cones->mu[i] * cones->corner, top = cones->n_max[i], one = WG_C(1.0);
        const WG_REAL ex = c * cones->along[0][i] + s * cones->aside[0][i], wx = c * cones->aside[0][i] - s * cones->along[0][i];
        const WG_REAL ey = c * cones->along[1][i] + s * cones->aside[1][i], wy = c * cones->aside[1][i] - s * cones->along[1][i];
        const WG_REAL ez = c * cones->along[2][i] + s * cones->aside[2][i], wz = c * cones->aside[2][i] - s * cones->along[2][i];
        const WG_REAL N = nx * z[0][i] + ny * z[1][i] + nz * z[2][i], u = ex * z[0][i] + ey * z[1][i] + ez * z[2][i];
        const WG_REAL v = wx * z[0][i] + wy * z[1][i] + wz * z[2][i], size = WG_ABS(v), bent = v < zero ? -corner : corner;
        const WG_REAL on_side = (N + side * u) * cones->flat[i], sum = N + side * u + corner * size, lack = sum > zero ? sum : zero;
        const WG_REAL rough = cones->mu[i] > zero ? lack : zero, loaded = rough > zero ? one : zero, low = N < top ? N : top;
        const WG_REAL inside = u <= side * low ? loaded : zero, low_side = on_side < top ? on_side : top;
        const WG_REAL on_flat = size <= corner * low_side ? loaded : zero, flat = inside > zero ? inside : on_flat;
        const WG_REAL bound = flat > zero ? on_side : lack * cones->circle[i], reached = inside > zero ? N : bound;
        const WG_REAL share = flat > zero ? cones->flat[i] : cones->circle[i], some = inside > zero ? one : share;
        const WG_REAL borne = lack > zero ? some : zero, p = reached <= top ? borne : zero;
        const WG_REAL a = reached < top ? reached : top, slope = inside > zero ? zero : side, rise = flat > zero ? zero : bent;
        const WG_REAL fu = inside > zero ? u : side * a, fv = flat > zero ? v : bent * a;
        const WG_REAL qx = nx + slope * ex + rise * wx, qy = ny + slope * ey + rise * wy, qz = nz + slope * ez + rise * wz;
        const WG_REAL px = p * qx, py = p * qy, gx = flat * wx, gy = flat * wy, hx = inside * ex, hy = inside * ey;
        images->f[0][i] = a * nx + fu * ex + fv * wx;
        images->f[1][i] = a * ny + fu * ey + fv * wy;
        images->f[2][i] = a * nz + fu * ez + fv * wz;
        images->slope[0][i] = px * qx + gx * wx + hx * ex;
        images->slope[1][i] = px * qy + gx * wy + hx * ey;
        images->slope[2][i] = px * qz + gx * wz + hx * ez;
        images->slope[3][i] = py * qy + gy * wy + hy * ey;
        images->slope[4][i] = py * qz + gy * wz + hy * ez;
        images->slope[5][i] = p * qz * qz + flat * wz * wz + inside * ez * ez;
        images->inside[i] = inside;
        images->lack[i] = lack;
    }
}

/* The normal parts N of vectors N n + T, T and its length. */
WG_INLINE void WG_NAME(wg_contact_parts)(const struct WG_NAME(wg_contact_cones) * WG_RESTRICT cones, WG_REAL z[3][WALKGEN_MAX_FEET],
                                         WG_REAL T[3][WALKGEN_MAX_FEET], WG_REAL *WG_RESTRICT normal, WG_REAL *WG_RESTRICT length) {
    const int32_t rows = (cones->rows + 3) & ~3;
    int i;
    for (i = 0; i < rows; ++i) {
        const WG_REAL N = cones->n[0][i] * z[0][i] + cones->n[1][i] * z[1][i] + cones->n[2][i] * z[2][i];
        const WG_REAL x = z[0][i] - N * cones->n[0][i], y = z[1][i] - N * cones->n[1][i], h = z[2][i] - N * cones->n[2][i];
        T[0][i] = x;
        T[1][i] = y;
        T[2][i] = h;
        normal[i] = N;
        length[i] = x * x + y * y + h * h;
    }
    for (i = 0; i < rows; ++i) { /* alone, since a root may set errno */
        length[i] = WG_SQRT(length[i]);
    }
}

/* The nearest forces within circles: a n + b T of the vector's N n + T. */
static inline void WG_NAME(wg_contact_within_circles)(const struct WG_NAME(wg_contact_cones) * WG_RESTRICT cones,
                                                      WG_REAL z[3][WALKGEN_MAX_FEET],
                                                      struct WG_NAME(wg_contact_images) * WG_RESTRICT images) {
    const int32_t rows = (cones->rows + 3) & ~3;
    WG_REAL T[3][WALKGEN_MAX_FEET], normal[WALKGEN_MAX_FEET], length[WALKGEN_MAX_FEET];
    int i;
    WG_NAME(wg_contact_parts)(cones, z, T, normal, length);
    for (i = 0; i < rows; ++i) {
        const WG_REAL nx = cones->n[0][i], ny = cones->n[1][i], nz = cones->n[2][i], x = T[0][i], y = T[1][i], h = T[2][i], N = normal[i];
        const WG_REAL mu = cones->mu[i], top = cones->n_max[i], circle = cones->circle[i], one = WG_C(1.0), zero = WG_C(0.0);
        const WG_REAL sum = N + mu * length[i], lack = sum > zero ? sum : zero, low = N < top ? N : top;
        const WG_REAL rough = mu > zero ? lack : zero, loaded = rough > zero ? one : zero;
        const WG_REAL inside = length[i] <= mu * low ? loaded : zero, outside = one - inside, bent = outside / (length[i] + WG_NOTHING);
        const WG_REAL reached = inside > zero ? N : lack * circle, a = reached < top ? reached : top, slope = mu * bent;
        const WG_REAL share = inside > zero ? one : circle, borne = lack > zero ? share : zero, c = reached <= top ? borne : zero;
        const WG_REAL b = inside + slope * a, p = c - b, q = c * slope, s = q * slope - b * bent * bent;
        const WG_REAL gx = p * nx + q * x, gy = p * ny + q * y, gz = p * nz + q * h;
        const WG_REAL kx = q * nx + s * x, ky = q * ny + s * y, kz = q * nz + s * h;
        images->f[0][i] = a * nx + b * x;
        images->f[1][i] = a * ny + b * y;
        images->f[2][i] = a * nz + b * h;
        images->slope[0][i] = b + gx * nx + kx * x;
        images->slope[1][i] = gx * ny + kx * y;
        images->slope[2][i] = gx * nz + kx * h;
        images->slope[3][i] = b + gy * ny + ky * y;
        images->slope[4][i] = gy * nz + ky * h;
        images->slope[5][i] = b + gz * nz + kz * h;
        images->inside[i] = inside;
        images->lack[i] = lack;
    }
}

/* The nearest forces to vectors. */
WG_CALLED void WG_NAME(wg_contact_nearest)(const struct WG_NAME(wg_contact_cones) * cones, WG_REAL z[3][WALKGEN_MAX_FEET],
                                               struct WG_NAME(wg_contact_images) * images) {
    if (cones->facets == 0) {
        WG_NAME(wg_contact_within_circles)(cones, z, images);
    } else if (cones->facets == 4) {
        WG_NAME(wg_contact_within_polygons)(cones, 4, z, images);
    } else {
        WG_NAME(wg_contact_within_polygons)(cones, cones->facets, z, images);
    }
}

#undef WG_NOTHING
#endif
