/* walkgen_friction.h: the loads that feet can carry with more or less friction, as a problem of walkgen_conic.h; walkgen_math.h explains
 * the macros.
 *
 * f_i = s n_i + x_i with x_i in the cone |T| <= mu N: s is the normal force that every foot has above what its friction needs, N_i - |T_i|
 * / mu_i >= s. The load can be carried if and only if the greatest s is not negative; else the multipliers are a twist with which the load
 * gains what no foot can take: every foot's velocity V has V . n >= mu |V - n V . n|.
 */
#include "walkgen_conic.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_FRICTION_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_FRICTION_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_FRICTION_F64
#define WG_UNIT WG_C(1e-9)
#define WG_STEEP WG_C(1e-7)
#define WG_NONE WG_C(1e-11)
#else
#define WALKGEN_FRICTION_F32
#define WG_UNIT WG_C(1e-5)
#define WG_STEEP WG_C(1e-4)
#define WG_NONE WG_C(2e-5)
#endif

/* Wrenches about the feet's centre of unit forces along normals and two tangents; the orthonormal basis of wrenches in use, and the
 * problem. */
struct WG_NAME(wg_friction) {
    struct WG_NAME(wg_stance) stance;
    WG_REAL tangent[2][WALKGEN_MAX_FEET][3], push[3 * WALKGEN_MAX_FEET][6], basis[6][6];
    struct WG_NAME(wg_conic) conic;
};

/* The stance read: 0 where it is none. */
static inline int WG_NAME(wg_friction_read)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *wrench,
                                            struct WG_NAME(wg_friction) * friction) {
    int i;
    if (!WG_NAME(wg_stance_place)(k, points, &friction->stance) || !WG_NAME(wg_stance_unit)(k, normals) ||
        !WG_NAME(wg_stance_load)(wrench, &friction->stance)) {
        return 0;
    }
    for (i = 0; i < k; ++i) {
        WG_NAME(wg_across)(normals + 3 * i, friction->tangent[0][i], friction->tangent[1][i]);
        WG_NAME(wg_stance_push)(&friction->stance, i, normals + 3 * i, friction->push[3 * i]);
        WG_NAME(wg_stance_push)(&friction->stance, i, friction->tangent[0][i], friction->push[3 * i + 1]);
        WG_NAME(wg_stance_push)(&friction->stance, i, friction->tangent[1][i], friction->push[3 * i + 2]);
    }
    friction->conic.cones = k;
    friction->conic.mass = NULL;
    return 1;
}

/* An orthonormal basis, after its first `count` vectors, of what some wrenches of the feet span, the longest rest first: the new count.
 * `first` and `last`: of every foot's three, which count. */
static inline int WG_NAME(wg_friction_span)(int first, int last, WG_REAL least, int count, struct WG_NAME(wg_friction) * friction) {
    WG_REAL along[6], rest[6];
    int i, j;
    for (; count < 6; ++count) {
        WG_REAL longest = least;
        for (i = 0; i < 3 * friction->conic.cones; ++i) {
            WG_REAL length;
            if (i % 3 < first || i % 3 > last) {
                continue;
            }
            for (j = 0; j < 6; ++j) {
                rest[j] = friction->push[i][j];
            }
            length = WG_NAME(wg_stance_across)(friction->basis, count, rest, along);
            for (j = 0; j < 6 && length > longest; ++j) {
                friction->basis[count][j] = rest[j] / length;
            }
            longest = WG_MAX(longest, length);
        }
        if (!(longest > least)) {
            break;
        }
    }
    return count;
}

/* The problem's equations along basis vectors `from` to `to`, tangents counted factor mu [k] times (mu 1 where NULL). */
static inline void WG_NAME(wg_friction_pose)(int from, int to, const WG_REAL *mu, WG_REAL factor, struct WG_NAME(wg_friction) * friction) {
    struct WG_NAME(wg_conic) *conic = &friction->conic;
    int i, j;
    conic->rows = to - from;
    for (j = 0; j < conic->rows; ++j) {
        const WG_REAL *direction = friction->basis[from + j];
        conic->b[j] = -WG_NAME(wg_stance_product)(direction, friction->stance.load);
        conic->a[j] = WG_C(0.0);
        for (i = 0; i < 3 * conic->cones; ++i) {
            const WG_REAL size = i % 3 == 0 ? WG_C(1.0) : mu ? factor * mu[i / 3] : factor;
            conic->column[i][j] = size > WG_C(0.0) ? size * WG_NAME(wg_stance_product)(direction, friction->push[i]) : WG_C(0.0);
            conic->a[j] += i % 3 == 0 ? conic->column[i][j] : WG_C(0.0);
        }
    }
}

/* A twist about the centre inside becomes one about the frame's origin for the load as given. */
static inline void WG_NAME(wg_friction_outside)(const struct WG_NAME(wg_stance) * stance, const WG_REAL y[6], WG_REAL factor,
                                                WG_REAL twist[6]) {
    WG_REAL shift[3];
    int i;
    WG_NAME(wg_cross)(y + 3, stance->centre, shift);
    for (i = 0; i < 3; ++i) {
        twist[i] = factor * (y[i] - shift[i] / stance->length);
        twist[3 + i] = factor * y[3 + i] / stance->length;
    }
}

/* The multipliers as a twist inside. */
static inline void WG_NAME(wg_friction_twist)(const struct WG_NAME(wg_friction) * friction, int from, WG_REAL y[6]) {
    int i, j;
    for (i = 0; i < 6; ++i) {
        y[i] = WG_C(0.0);
        for (j = 0; j < friction->conic.rows; ++j) {
            y[i] += friction->conic.y[j] * friction->basis[from + j][i];
        }
    }
}

/* The forces found, in the stance's unit, with tangents mu [k] (1 where NULL) times their size. */
static inline void WG_NAME(wg_friction_forces)(const struct WG_NAME(wg_friction) * friction, const WG_REAL *normals, const WG_REAL *mu,
                                               WG_REAL factor, WG_REAL *f) {
    int i, j;
    for (i = 0; i < friction->conic.cones; ++i) {
        const WG_REAL *x = friction->conic.x + 3 * i, size = mu ? factor * mu[i] : factor;
        for (j = 0; j < 3; ++j) {
            f[3 * i + j] = (x[0] + friction->conic.s) * normals[3 * i + j] +
                           size * (x[1] * friction->tangent[0][i][j] + x[2] * friction->tangent[1][i][j]);
        }
    }
}

/* Whether any friction carries the load: 1, with all wrenches of the feet in the basis, `*rank` of them; else 0 with the twist that proves
 * it not, or -1 with none. Wrenches that only tangents steeper than 1e7 reach count as none. */
static inline int WG_NAME(wg_friction_helps)(struct WG_NAME(wg_friction) * friction, int *rank, WG_REAL y[6]) {
    WG_REAL along[6];
    const WG_REAL least = friction->stance.blur <= WG_C(1.0) ? friction->stance.blur : WG_C(0.5);
    int tangents, j;
    tangents = WG_NAME(wg_friction_span)(1, 2, WG_MAX(WG_STEEP, least), 0, friction);
    *rank = WG_NAME(wg_friction_span)(0, 2, WG_MAX(WG_STEEP, least), tangents, friction);
    for (j = 0; j < 6; ++j) {
        y[j] = friction->stance.load[j];
    }
    if (WG_NAME(wg_stance_across)(friction->basis, *rank, y, along) > WG_MAX(WG_NONE, friction->stance.noise)) {
        return 0;
    }
    if (tangents == *rank) {
        return 1;
    }
    WG_NAME(wg_friction_pose)(tangents, *rank, NULL, WG_C(0.0), friction);
    if (!WG_NAME(wg_conic_solve)(WG_C(1.0), &friction->conic) && !(friction->conic.s > WG_C(1.0))) {
        return -1;
    }
    WG_NAME(wg_friction_twist)(friction, tangents, y);
    return friction->conic.s >= -WG_NONE;
}

#undef WG_UNIT
#undef WG_STEEP
#undef WG_NONE
#endif
