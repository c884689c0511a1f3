/* walkgen_contact_inside.h: forces while no cone is active: a rigid body's, f_i = a + alpha x r_i about the feet's centre, one 3 by 3
 * system; walkgen_math.h explains the macros. */
#include "walkgen_contact_work.h"
#include "walkgen_spatial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_INSIDE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_INSIDE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_INSIDE_F64
#define WG_UNIT WG_C(1e-9)
#define WG_SAFE WG_C(1e40)
#else
#define WALKGEN_CONTACT_INSIDE_F32
#define WG_UNIT WG_C(1e-5)
#define WG_SAFE WG_C(1e5)
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

/* Forces in the inside of all cones with equal weights (of |T| <= share mu N, `square`: of squares whose half sides these are): whether
 * they are the answer. Numbers far from 1 are left to the scaled search. */
static inline int WG_NAME(wg_contact_inactive)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                               const WG_REAL *wrench, const WG_REAL *weight, const WG_REAL *n_max, WG_REAL share,
                                               int square,
                                               WG_REAL *f, WG_REAL *violation) {
    const WG_REAL each = WG_C(1.0) / (WG_REAL)k;
    WG_REAL c[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, s[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    WG_REAL m[3], a[3], lacking[6], load, length, worst = WG_C(0.0);
    int i, j, fine;
    for (i = 0; i < k; ++i) {
        c[0] += each * points[3 * i];
        c[1] += each * points[3 * i + 1];
        c[2] += each * points[3 * i + 2];
    }
    for (i = 0; i < k; ++i) {
        const WG_REAL x = points[3 * i] - c[0], y = points[3 * i + 1] - c[1], z = points[3 * i + 2] - c[2];
        s[0] += x * x;
        s[1] += y * y;
        s[2] += z * z;
        s[3] += x * y;
        s[4] += x * z;
        s[5] += y * z;
    }
    WG_NAME(wg_cross)(c, wrench, m);
    for (j = 0; j < 3; ++j) {
        m[j] -= wrench[3 + j];
        lacking[j] = wrench[j];
        lacking[3 + j] = -m[j];
    }
    fine = WG_NAME(wg_contact_turning)(s, m, a);
    length = s[0] + s[1] + s[2];
    load = WG_NAME(wg_dot)(wrench, wrench);
    fine &= length > WG_C(1.0) / WG_SAFE && length < WG_SAFE && load > WG_C(1.0) / (WG_SAFE * WG_SAFE) &&
            load < WG_SAFE * WG_SAFE;
    for (i = 0; i < k; ++i) {
        const WG_REAL *n = normals + 3 * i, x = points[3 * i] - c[0], y = points[3 * i + 1] - c[1], z = points[3 * i + 2] - c[2];
        const WG_REAL fx = a[1] * z - a[2] * y - each * wrench[0], fy = a[2] * x - a[0] * z - each * wrench[1];
        const WG_REAL fz = a[0] * y - a[1] * x - each * wrench[2], N = fx * n[0] + fy * n[1] + fz * n[2];
        const WG_REAL tx = fx - N * n[0], ty = fy - N * n[1], tz = fz - N * n[2], most = share * mu[i] * N;
        const int other = WG_ABS(n[0]) > WG_C(0.9); /* u and v: T across and along the first side, times the size of its direction */
        const WG_REAL u = other ? ty : tx, v = other ? tz * n[0] - tx * n[2] : ty * n[2] - tz * n[1], axis = n[other];
        const WG_REAL T = square ? WG_MAX(u * u, v * v) : tx * tx + ty * ty + tz * tz, size = square ? WG_C(1.0) - axis * axis : WG_C(1.0);
        const WG_REAL unit = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - WG_C(1.0);
        fine &= (N > WG_C(0.0)) & (N <= n_max[i]) & (mu[i] > WG_C(0.0)) & (T <= most * most * size);
        fine &= (WG_ABS(unit) <= WG_C(2.0) * WG_UNIT) & (mu[i] < WG_C(1.0) / WG_UNIT) & (weight[i] >= weight[0]) & (weight[i] <= weight[0]);
        f[3 * i] = fx;
        f[3 * i + 1] = fy;
        f[3 * i + 2] = fz;
        lacking[0] += fx;
        lacking[1] += fy;
        lacking[2] += fz;
        lacking[3] += y * fz - z * fy;
        lacking[4] += z * fx - x * fz;
        lacking[5] += x * fy - y * fx;
    }
    for (j = 0; j < 6; ++j) {
        worst = WG_MAX(worst, WG_ABS(lacking[j]));
    }
    *violation = worst;
    return fine && weight[0] > WG_C(0.0) && weight[0] <= WG_HUGE;
}

#undef WG_UNIT
#undef WG_SAFE
#endif
