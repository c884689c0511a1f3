/* walkgen_feasible.h: where a centre of mass may be, and which level forces a stance withstands, with friction as it is; walkgen_math.h
 * explains the macros. */
#include "walkgen_shadow_margin.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_FEASIBLE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_FEASIBLE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_FEASIBLE_F64
#define WG_FAIR WG_C(1e-7)
#define WG_ROUGHEST WG_C(1e9)
#else
#define WALKGEN_FEASIBLE_F32
#define WG_FAIR WG_C(2e-3)
#define WG_ROUGHEST WG_C(1e5)
#endif

/* Coefficients of friction and normals as they count: a normal of zeros is up. Whether they are some. */
static inline int WG_NAME(wg_feasible_ground)(int32_t k, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL up[3], WG_REAL *ground) {
    int i, j, fine = 1;
    for (i = 0; i < k; ++i) {
        const WG_REAL *normal = normals + 3 * i;
        const int none = normal[0] == WG_C(0.0) && normal[1] == WG_C(0.0) && normal[2] == WG_C(0.0);
        for (j = 0; j < 3; ++j) {
            ground[3 * i + j] = none ? up[j] : normal[j];
        }
        fine &= mu[i] >= WG_C(0.0) && mu[i] <= WG_ROUGHEST;
    }
    return fine && WG_NAME(wg_stance_unit)(k, ground);
}

/* The region of centres of mass under weight alone, along the level axes in the stance's length from the feet's centre: four directions. */
WG_CALLED int32_t WG_NAME(wg_feasible_start)(const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                             const struct WG_NAME(wg_support) * support, struct WG_NAME(wg_shadow) * shadow) {
    WG_REAL ground[3 * WALKGEN_MAX_FEET], wrench[6], plane[2][6];
    const int32_t k = support->stance.feet;
    int32_t status;
    int i, j;
    for (j = 0; j < 3; ++j) {
        wrench[j] = -support->up[j];
        for (i = 0; i < 2; ++i) {
            plane[i][j] = WG_C(0.0);
            plane[i][3 + j] = i == 0 ? support->axis[1][j] : -support->axis[0][j]; /* axis x -up */
        }
    }
    WG_NAME(wg_cross)(support->stance.centre, wrench, wrench + 3);
    if (!WG_NAME(wg_feasible_ground)(k, normals, mu, support->up, ground) ||
        !WG_NAME(wg_friction_read)(k, points, ground, wrench, &shadow->friction)) {
        return WALKGEN_BAD_INPUT;
    }
    status = WG_NAME(wg_shadow_read)(mu, plane, shadow);
    return status == WALKGEN_OK ? WG_NAME(wg_shadow_start)(2, shadow) : status;
}

/* How far the region may reach over the polygon's side after a point: the height of the triangle of that and the two lines. */
static inline WG_REAL WG_NAME(wg_feasible_gap)(const struct WG_NAME(wg_shadow) * shadow, int side, WG_REAL normal[2]) {
    const WG_REAL *u = shadow->direction[side], *v = shadow->direction[(side + 1) % shadow->count];
    const WG_REAL length = WG_NAME(wg_shadow_side)(shadow, side, normal);
    const WG_REAL before = u[0] * normal[1] - u[1] * normal[0], after = normal[0] * v[1] - normal[1] * v[0];
    return before > WG_C(0.0) && after > WG_C(0.0) ? length * before * after / (u[0] * v[1] - u[1] * v[0]) : WG_C(0.0);
}

/* The polygon brought within `tolerance` of the region, in its units: how far it may be from it, infinite where a direction is open. */
static inline WG_REAL WG_NAME(wg_feasible_refine)(WG_REAL tolerance, struct WG_NAME(wg_shadow) * shadow) {
    WG_REAL normal[2], next[2] = {WG_C(0.0), WG_C(0.0)}, largest = WG_C(0.0);
    int turn, i, open = 0;
    for (turn = 0; turn <= WALKGEN_MAX_DIRECTIONS; ++turn) {
        largest = WG_C(0.0);
        for (i = 0; i < shadow->count; ++i) {
            const WG_REAL gap = WG_NAME(wg_feasible_gap)(shadow, i, normal);
            if (gap > largest) {
                largest = gap;
                next[0] = normal[0];
                next[1] = normal[1];
            }
        }
        if (!(largest > tolerance) || !WG_NAME(wg_shadow_look)(next, shadow)) {
            break;
        }
    }
    for (i = 0; i < shadow->count; ++i) {
        open |= shadow->open[i];
    }
    return open ? WG_INFINITY : largest;
}

/* Points of the polygon that are no corners, to rounding, left out: the others' number. */
static inline int WG_NAME(wg_feasible_corners)(const struct WG_NAME(wg_shadow) * shadow, int corner[WALKGEN_MAX_DIRECTIONS]) {
    WG_REAL back[2];
    int i, count = 0, turn, left = 0;
    for (i = 0; i < shadow->count; ++i) {
        corner[count++] = i;
    }
    for (turn = 0; turn < shadow->count && left < count && count > 1; ++turn) {
        const WG_REAL *here = shadow->point[corner[left]];
        const WG_REAL *before = shadow->point[corner[(left + count - 1) % count]], *after = shadow->point[corner[(left + 1) % count]];
        if (WG_NAME(wg_support_apart)(before, after, here, back) > WG_FAIR) {
            ++left;
            continue;
        }
        --count;
        for (i = left; i < count; ++i) {
            corner[i] = corner[i + 1];
        }
    }
    return count;
}

/* The gravity [3] and the mass that count: those given, or where they are 0 the robot's own [4]. */
static inline void WG_NAME(wg_feasible_burden)(const WG_REAL *gravity, WG_REAL mass, const WG_REAL *own, WG_REAL burden[4]) {
    const int none = gravity[0] == WG_C(0.0) && gravity[1] == WG_C(0.0) && gravity[2] == WG_C(0.0);
    int j;
    for (j = 0; j < 3; ++j) {
        burden[j] = none ? own[j] : gravity[j];
    }
    burden[3] = mass == WG_C(0.0) ? own[3] : mass;
}

/* Where the centre of mass may be for k feet [k, 3] to carry the weight within their friction cones (normals [k, 3], zeros for up; mu [k]):
 * the corners [WALKGEN_MAX_DIRECTIONS, 3] of a polygon inside that region, counterclockwise as seen from above, at the height of the feet's
 * centre, their number, and how far the region reaches beyond at most; what is left over repeats the last. All heights are alike. gravity
 * [3]: zeros for `own` [4]. OK where
 * that is no more than `tolerance`; NO_CONVERGENCE with the polygon where it is, infinite where normal forces of 1e3 weights in sum, by
 * which feet press against each other, limit it; INFEASIBLE where the region is empty, SINGULAR where it has no area or BAD_INPUT, with
 * NaN and none. */
static inline void WG_NAME(wg_feasible_region)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT mu,
                                               const WG_REAL *WG_RESTRICT normals, const WG_REAL *WG_RESTRICT gravity,
                                               const WG_REAL *WG_RESTRICT own, WG_REAL tolerance, WG_REAL *WG_RESTRICT polygon,
                                               int32_t *WG_RESTRICT vertices, WG_REAL *WG_RESTRICT error,
                                               int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_support) support;
    struct WG_NAME(wg_shadow) shadow;
    WG_REAL burden[4];
    int corner[WALKGEN_MAX_DIRECTIONS], i, j;
    WG_NAME(wg_feasible_burden)(gravity, WG_C(0.0), own, burden);
    *vertices = 0;
    *error = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    if (tolerance > WG_C(0.0) && WG_NAME(wg_support_read)(k, points, burden, &support)) {
        *status = WG_NAME(wg_feasible_start)(points, normals, mu, &support, &shadow);
    }
    if (*status == WALKGEN_OK) {
        *error = support.stance.length * WG_NAME(wg_feasible_refine)(tolerance / support.stance.length, &shadow);
        *vertices = WG_NAME(wg_feasible_corners)(&shadow, corner);
        *status = *error <= tolerance ? WALKGEN_OK : WALKGEN_NO_CONVERGENCE;
    }
    for (i = 0; i < WALKGEN_MAX_DIRECTIONS; ++i) {
        const WG_REAL *at = *vertices > 0 ? shadow.point[corner[i < *vertices ? i : *vertices - 1]] : burden;
        for (j = 0; j < 3; ++j) {
            const WG_REAL from = *vertices > 0 ? at[0] * support.axis[0][j] + at[1] * support.axis[1][j] : WG_NAN;
            polygon[3 * i + j] = *vertices > 0 ? support.stance.centre[j] + support.stance.length * from : WG_NAN;
        }
    }
}

/* The wrenches about the feet's centre of unit forces along the level axes at a point, in the stance's length. */
static inline void WG_NAME(wg_feasible_pushes)(const struct WG_NAME(wg_support) * support, const WG_REAL at[3], WG_REAL plane[2][6]) {
    WG_REAL arm[3];
    int i;
    WG_NAME(wg_support_outside)(support, at, arm);
    for (i = 0; i < 2; ++i) {
        WG_NAME(wg_add)(support->axis[i], WG_C(0.0), arm, plane[i]);
        WG_NAME(wg_cross)(arm, plane[i], plane[i] + 3);
    }
}

/* The greatest level force (N) at a point [3] that k feet withstand together with the weight of `mass` at the centre of mass, whatever its
 * direction, before one slips or lifts off; the direction [3] in which they withstand no more. Infinite, with the direction 0, where feet
 * that press against each other by 1e3 weights set the limit. INFEASIBLE where they do not even carry the weight; else as
 * wg_feasible_region says, with NaN. */
static inline void WG_NAME(wg_disturbance_margin)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT com,
                                                  const WG_REAL *WG_RESTRICT mu, const WG_REAL *WG_RESTRICT point,
                                                  const WG_REAL *WG_RESTRICT normals, const WG_REAL *WG_RESTRICT gravity, WG_REAL mass,
                                                  const WG_REAL *WG_RESTRICT own, WG_REAL *WG_RESTRICT force,
                                                  WG_REAL *WG_RESTRICT direction, int32_t *WG_RESTRICT status) {
    const WG_REAL here[2] = {WG_C(0.0), WG_C(0.0)};
    struct WG_NAME(wg_support) support;
    struct WG_NAME(wg_shadow) shadow;
    WG_REAL ground[3 * WALKGEN_MAX_FEET], wrench[6], plane[2][6], burden[4], out[2];
    WG_REAL at[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    int j, fine;
    *force = direction[0] = direction[1] = direction[2] = WG_NAN;
    *status = WALKGEN_BAD_INPUT;
    WG_NAME(wg_feasible_burden)(gravity, mass, own, burden);
    for (j = 0; j < 3; ++j) {
        wrench[j] = burden[3] * burden[j];
    }
    fine = burden[3] > WG_C(0.0) && WG_NAME(wg_support_read)(k, points, burden, &support) &&
           WG_NAME(wg_support_place)(&support, com, support.com) && WG_NAME(wg_support_place)(&support, point, at) &&
           WG_NAME(wg_feasible_ground)(k, normals, mu, support.up, ground);
    WG_NAME(wg_cross)(com, wrench, wrench + 3);
    if (!fine || !WG_NAME(wg_friction_read)(k, points, ground, wrench, &shadow.friction)) {
        return;
    }
    WG_NAME(wg_feasible_pushes)(&support, at, plane);
    *status = WG_NAME(wg_shadow_read)(mu, plane, &shadow);
    *status = *status == WALKGEN_OK ? WG_NAME(wg_shadow_start)(0, &shadow) : *status;
    *status = *status == WALKGEN_OK ? WG_NAME(wg_shadow_margin)(here, force, out, &shadow) : *status;
    if (*status != WALKGEN_OK) {
        *force = WG_NAN;
        return;
    }
    *force = WG_MAX(*force, WG_C(0.0)) * shadow.friction.stance.force;
    for (j = 0; j < 3; ++j) {
        direction[j] = out[0] * support.axis[0][j] + out[1] * support.axis[1][j];
    }
}

#undef WG_FAIR
#undef WG_ROUGHEST
#endif
