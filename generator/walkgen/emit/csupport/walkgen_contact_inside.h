/* walkgen_contact_inside.h: forces while no cone is active: a rigid body's, f_i = a + alpha x r_i about the feet's centre, one 3 by 3
 * system; walkgen_math.h explains the macros. */
#include "walkgen_contact_work.h"
#include "walkgen_spatial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_INSIDE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_INSIDE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_INSIDE_F64
#define WG_UNIT WG_C(1e-9)
#define WG_SAFE WG_C(1e40)
#define WG_FLAT WG_C(1e-6)
#else
#define WALKGEN_CONTACT_INSIDE_F32
#define WG_UNIT WG_C(1e-5)
#define WG_SAFE WG_C(1e5)
#define WG_FLAT WG_C(1e-2)
#endif

/* a = A^-1 m for the symmetric A of points' second moments (xx, yy, zz, xy, xz, yz); whether it is well conditioned. */
static inline int WG_NAME(wg_contact_turning)(const WG_REAL s[6], const WG_REAL m[3], WG_REAL a[3]) {
    const WG_REAL A = s[1] + s[2], B = s[0] + s[2], C = s[0] + s[1], trace = s[0] + s[1] + s[2];
    const WG_REAL xx = B * C - s[5] * s[5], xy = s[3] * C + s[4] * s[5], xz = s[3] * s[5] + s[4] * B;
    const WG_REAL yy = A * C - s[4] * s[4], yz = A * s[5] + s[3] * s[4], zz = A * B - s[3] * s[3];
    const WG_REAL determinant = A * xx - s[3] * xy - s[4] * xz, inverse = WG_C(1.0) / determinant;
    a[0] = (xx * m[0] + xy * m[1] + xz * m[2]) * inverse;
    a[1] = (xy * m[0] + yy * m[1] + yz * m[2]) * inverse;
    a[2] = (xz * m[0] + yz * m[1] + zz * m[2]) * inverse;
    return determinant > WG_C(1e-4) * trace * trace * trace;
}

/* Whether forces are in the inside of the squares in the friction circles, of half side share mu N; normals are unit vectors. */
WG_CALLED int WG_NAME(wg_contact_in_squares)(int32_t k, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *f, WG_REAL share) {
    int i, fine = 1;
    for (i = 0; i < k; ++i) {
        const WG_REAL *n = normals + 3 * i, *g = f + 3 * i, N = WG_NAME(wg_dot)(g, n), most = share * mu[i] * N;
        const WG_REAL tx = g[0] - N * n[0], ty = g[1] - N * n[1], tz = g[2] - N * n[2];
        const int other = WG_ABS(n[0]) > WG_C(0.9); /* u and v: T across and along the first side, times the size of its direction */
        const WG_REAL u = other ? ty : tx, v = other ? tz * n[0] - tx * n[2] : ty * n[2] - tz * n[1], axis = n[other];
        fine &= WG_MAX(u * u, v * v) <= most * most * (WG_C(1.0) - axis * axis);
    }
    return fine;
}

/* The centre c of points and their second moments about it (xx, yy, zz, xy, xz, yz), by one pass about the first point; the least friction
 * too, which also keeps compilers from gathering feet in vectors here: as these sums are rounded in order, that only costs. */
static inline void WG_NAME(wg_contact_moments)(int32_t k, const WG_REAL *points, const WG_REAL *mu, WG_REAL c[3], WG_REAL s[6],
                                               WG_REAL *rub) {
    const WG_REAL each = WG_C(1.0) / (WG_REAL)k, px = points[0], py = points[1], pz = points[2];
    WG_REAL low = mu[0], ex = WG_C(0.0), ey = ex, ez = ex, xx = ex, yy = ex, zz = ex, xy = ex, xz = ex, yz = ex;
    int i;
    for (i = 1; i < k; ++i) {
        const WG_REAL x = points[3 * i] - px, y = points[3 * i + 1] - py, z = points[3 * i + 2] - pz;
        ex += x;
        ey += y;
        ez += z;
        xx += x * x;
        yy += y * y;
        zz += z * z;
        xy += x * y;
        xz += x * z;
        yz += y * z;
        low = WG_MIN(mu[i], low);
    }
    *rub = low;
    s[0] = xx - each * ex * ex;
    s[1] = yy - each * ey * ey;
    s[2] = zz - each * ez * ez;
    s[3] = xy - each * ex * ey;
    s[4] = xz - each * ex * ez;
    s[5] = yz - each * ey * ez;
    c[0] = px + each * ex;
    c[1] = py + each * ey;
    c[2] = pz + each * ez;
}

/* Whether normals, the sum of friction and weights are those that this way is for. Here and below by sums, least and greatest values rather
 * than by a comparison for each foot, and in loops whose results fit into registers: these weigh most. A sum does not pass over a NaN. */
static inline int WG_NAME(wg_contact_usual)(int32_t k, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *weight) {
    WG_REAL light = weight[0], sum = WG_C(0.0), off = sum, unequal = sum;
    int i;
    for (i = 0; i < k; ++i) {
        const WG_REAL *n = normals + 3 * i, square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - WG_C(1.0), heavier = weight[i] - weight[0];
        off += square * square;
        unequal += heavier * heavier;
        sum += mu[i];
        light = WG_MIN(weight[i], light);
    }
    return (light > WG_C(0.0)) & (sum < WG_C(1.0) / WG_UNIT) & (off <= WG_UNIT * WG_UNIT) & (unequal <= WG_C(0.0)) &
           (weight[0] <= WG_HUGE);
}

/* The forces a x r_i - wrench / k; whether all feet press, no more than they can. `outside`: how far these are outside their cones of
 * |T| <= share mu N, by squares; `lacking`: of the load, added to what it holds. */
static inline int WG_NAME(wg_contact_turned)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                             const WG_REAL *wrench, const WG_REAL *n_max, WG_REAL share, const WG_REAL c[3],
                                             const WG_REAL a[3], WG_REAL *f, WG_REAL lacking[6], WG_REAL *outside) {
    const WG_REAL each = WG_C(1.0) / (WG_REAL)k, ax = each * wrench[0], ay = each * wrench[1], az = each * wrench[2];
    const WG_REAL u = a[0], v = a[1], w = a[2];
    WG_REAL least = WG_INFINITY, over = WG_C(0.0), worst = -least;
    int i;
    for (i = 0; i < k; ++i) {
        const WG_REAL *n = normals + 3 * i, x = points[3 * i] - c[0], y = points[3 * i + 1] - c[1], z = points[3 * i + 2] - c[2];
        const WG_REAL fx = v * z - ax - w * y, fy = w * x - ay - u * z, fz = u * y - az - v * x;
        const WG_REAL N = fx * n[0] + fy * n[1] + fz * n[2], most = share * mu[i] * N;
        worst = WG_MAX(fx * fx + fy * fy + fz * fz - N * N - most * most, worst);
        over += N <= n_max[i] ? WG_C(0.0) : WG_C(1.0);
        least = WG_MIN(N, least);
        f[3 * i] = fx;
        f[3 * i + 1] = fy;
        f[3 * i + 2] = fz;
        lacking[0] += fx;
        lacking[1] += fy;
        lacking[2] += fz;
        lacking[3] = lacking[3] + y * fz - z * fy;
        lacking[4] = lacking[4] + z * fx - x * fz;
        lacking[5] = lacking[5] + x * fy - y * fx;
    }
    *outside = worst;
    return (least > WG_C(0.0)) & (over <= WG_C(0.0));
}

/* Forces in the inside of all cones with equal weights (of |T| <= share mu N, `square`: of squares whose half sides these are): whether
 * they are the answer. Numbers far from 1 are left to the scaled search. */
static inline int WG_NAME(wg_contact_inactive)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                               const WG_REAL *wrench, const WG_REAL *weight, const WG_REAL *n_max, WG_REAL share,
                                               int square,
                                               WG_REAL *f, WG_REAL *violation) {
    WG_REAL c[3], s[6], m[3], a[3], lacking[6], worst = WG_C(0.0), rub, outside;
    int j, fine;
    WG_NAME(wg_contact_moments)(k, points, mu, c, s, &rub);
    WG_NAME(wg_cross)(c, wrench, m);
    for (j = 0; j < 3; ++j) {
        m[j] -= wrench[3 + j];
        lacking[j] = wrench[j];
        lacking[3 + j] = -m[j];
    }
    fine = WG_NAME(wg_contact_turning)(s, m, a) & WG_NAME(wg_contact_usual)(k, normals, mu, weight) & (rub > WG_FLAT);
    const WG_REAL length = s[0] + s[1] + s[2], load = WG_NAME(wg_dot)(wrench, wrench);
    fine &= (length > WG_C(1.0) / WG_SAFE) & (length < WG_SAFE) & (load > WG_C(1.0) / (WG_SAFE * WG_SAFE)) & (load < WG_SAFE * WG_SAFE);
    fine &= WG_NAME(wg_contact_turned)(k, points, normals, mu, wrench, n_max, share, c, a, f, lacking, &outside);
    if (!fine || !(outside <= WG_C(0.0) || (square && WG_NAME(wg_contact_in_squares)(k, normals, mu, f, share)))) {
        return 0;
    }
    for (j = 0; j < 3; ++j) {
        worst = WG_MAX(worst, WG_MAX(WG_ABS(lacking[j]), WG_ABS(lacking[3 + j])));
    }
    *violation = worst;
    return 1;
}

#undef WG_UNIT
#undef WG_SAFE
#undef WG_FLAT
#endif
