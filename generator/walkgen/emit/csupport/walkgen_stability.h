/* walkgen_stability.h: the margins of static stability of a stance, and their gradients; walkgen_math.h explains the macros.
 *
 * At most 25 kB of stack in double, 14 kB in float (gcc -O2); the routines of walkgen_feasible.h take no more.
 */
#include "walkgen_feasible.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_STABILITY_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_STABILITY_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_STABILITY_F64
#else
#define WALKGEN_STABILITY_F32
#endif

/* Margins in the stance's length, with their gradients by the level axes and up: static, front, rear, height to tip, with friction; the
 * heights of all edges and the lowest one's place. */
struct WG_NAME(wg_margins) {
    WG_REAL value[5], gradient[5][3], height[WALKGEN_MAX_FEET];
    int32_t edge, status;
};

/* The height to tip: the least over the polygon's edges, the first of equal ones. */
static inline void WG_NAME(wg_margins_tip)(const struct WG_NAME(wg_support) * support, struct WG_NAME(wg_margins) * margins) {
    WG_REAL gradient[3];
    int i, j;
    margins->value[3] = WG_INFINITY;
    margins->edge = 0;
    for (i = 0; i < support->stance.feet; ++i) {
        margins->height[i] = i < support->vertices ? WG_NAME(wg_support_height)(support, i, gradient) : WG_INFINITY;
        if (margins->height[i] < margins->value[3]) {
            margins->value[3] = margins->height[i];
            margins->edge = i;
            for (j = 0; j < 3; ++j) {
                margins->gradient[3][j] = gradient[j];
            }
        }
    }
}

/* The static margin where friction is as it is; that of the polygon where all mu are infinite. */
static inline void WG_NAME(wg_margins_rough)(const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                             const struct WG_NAME(wg_support) * support, struct WG_NAME(wg_margins) * margins) {
    struct WG_NAME(wg_shadow) shadow;
    WG_REAL out[2];
    int i, slips = 0;
    for (i = 0; i < support->stance.feet; ++i) {
        slips |= !(mu[i] > WG_HUGE);
    }
    margins->value[4] = margins->value[0];
    margins->gradient[4][0] = margins->gradient[0][0];
    margins->gradient[4][1] = margins->gradient[0][1];
    if (!slips) {
        return;
    }
    margins->status = WG_NAME(wg_feasible_start)(points, normals, mu, support, &shadow);
    if (margins->status == WALKGEN_OK) {
        margins->status = WG_NAME(wg_shadow_margin)(support->com, &margins->value[4], out, &shadow);
    }
    margins->value[4] = margins->status == WALKGEN_OK ? margins->value[4] : WG_NAN;
    margins->gradient[4][0] = -out[0];
    margins->gradient[4][1] = -out[1];
}

/* No margins. */
static inline void WG_NAME(wg_margins_none)(struct WG_NAME(wg_support) * support, struct WG_NAME(wg_margins) * margins) {
    int i;
    for (i = 0; i < 5; ++i) {
        margins->value[i] = WG_NAN;
    }
    support->vertices = 0;
    margins->edge = 0;
    margins->status = WALKGEN_BAD_INPUT;
}

/* All of them. Of fewer than three feet, or feet on a line as seen from above, only the static one. */
WG_CALLED void WG_NAME(wg_margins_read)(int32_t k, const WG_REAL *points, const WG_REAL *com, const WG_REAL *direction,
                                        const WG_REAL *mu, const WG_REAL *normals, const WG_REAL *gravity, WG_REAL mass,
                                        struct WG_NAME(wg_support) * support, struct WG_NAME(wg_margins) * margins) {
    WG_REAL back[2];
    int i, j;
    for (i = 0; i < 5; ++i) {
        for (j = 0; j < 3; ++j) {
            margins->gradient[i][j] = WG_C(0.0);
        }
    }
    WG_NAME(wg_margins_none)(support, margins);
    if (!WG_NAME(wg_support_read)(k, points, gravity, support) || !WG_NAME(wg_support_aim)(com, direction, support) ||
        !(mass >= WG_C(0.0) && mass * WG_NAME(wg_norm)(gravity) <= WG_HUGE)) {
        return;
    }
    for (i = 0; i < k; ++i) {
        if (!(mu[i] >= WG_C(0.0))) {
            return;
        }
    }
    margins->status = WALKGEN_OK;
    WG_NAME(wg_support_hull)(support);
    margins->value[0] = WG_NAME(wg_support_static)(support, margins->gradient[0]);
    if (support->vertices < 3) {
        margins->status = WALKGEN_SINGULAR;
        return;
    }
    back[0] = -support->ahead[0];
    back[1] = -support->ahead[1];
    margins->value[1] = WG_NAME(wg_support_way)(support, support->ahead, margins->gradient[1]);
    margins->value[2] = WG_NAME(wg_support_way)(support, back, margins->gradient[2]);
    WG_NAME(wg_margins_tip)(support, margins);
    WG_NAME(wg_margins_rough)(points, normals, mu, support, margins);
    if (margins->status == WALKGEN_BAD_INPUT) {
        WG_NAME(wg_margins_none)(support, margins);
    }
}

/* The margins (m) of a centre of mass [3] over k feet [k, 3]. Static: signed distance of its projection along gravity from the border of
 * the support polygon, negative outside. Longitudinal [2]: how far it can go along the level part of a direction [3], and against it,
 * before the line of an edge, negative past one. Energy (J) and the height (m) by which it must rise to tip over the easiest edge,
 * negative past one (Messuri and Klein 1985; normalised, Hirose et al. 1998). With friction mu [k] and normals [k, 3] (zeros: up): signed
 * distance from the border of the region where they carry the weight; all mu infinite: the static one. The polygon [k]: numbers of feet
 * counterclockwise as seen from above, the lowest first, -1 beyond its vertices; of feet one above another the lowest, none on a line
 * between others. The edge [2] that tips, and the heights [k] of all edges, infinite beyond. gravity [3] and mass (kg): zeros for `own`
 * [4]. SINGULAR with NaN but for the static margin for fewer than three feet, or feet on a line as seen from above; with NaN for the
 * friction's alone INFEASIBLE where friction carries the weight nowhere, SINGULAR where its region has no area, NO_CONVERGENCE; BAD_INPUT
 * with NaN. */
static inline void WG_NAME(wg_stability_margins)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT com,
                                                 const WG_REAL *WG_RESTRICT direction, const WG_REAL *WG_RESTRICT mu,
                                                 const WG_REAL *WG_RESTRICT normals, const WG_REAL *WG_RESTRICT gravity, WG_REAL mass,
                                                 const WG_REAL *WG_RESTRICT own, WG_REAL *WG_RESTRICT static_margin,
                                                 WG_REAL *WG_RESTRICT longitudinal, WG_REAL *WG_RESTRICT energy,
                                                 WG_REAL *WG_RESTRICT height, WG_REAL *WG_RESTRICT friction, int32_t *WG_RESTRICT polygon,
                                                 int32_t *WG_RESTRICT vertices, int32_t *WG_RESTRICT edge, WG_REAL *WG_RESTRICT heights,
                                                 int32_t *WG_RESTRICT status) {
    const int known = k >= 1 && k <= WALKGEN_MAX_FEET ? k : 0;
    struct WG_NAME(wg_support) support;
    struct WG_NAME(wg_margins) margins;
    WG_REAL burden[4], length;
    int i, fine;
    WG_NAME(wg_feasible_burden)(gravity, mass, own, burden);
    WG_NAME(wg_margins_read)(k, points, com, direction, mu, normals, burden, burden[3], &support, &margins);
    fine = support.vertices > 2;
    length = support.vertices > 0 ? support.stance.length : WG_NAN;
    *static_margin = length * margins.value[0];
    longitudinal[0] = length * margins.value[1];
    longitudinal[1] = length * margins.value[2];
    *height = length * margins.value[3];
    *energy = *height * burden[3] * WG_NAME(wg_norm)(burden);
    *friction = length * margins.value[4];
    *vertices = support.vertices;
    edge[0] = fine ? support.polygon[margins.edge] : -1;
    edge[1] = fine ? support.polygon[(margins.edge + 1) % support.vertices] : -1;
    for (i = 0; i < known; ++i) {
        polygon[i] = i < support.vertices ? support.polygon[i] : -1;
        heights[i] = fine ? length * margins.height[i] : WG_NAN;
    }
    *status = margins.status;
}

/* The gradients of these margins by the centre of mass [3]: those of the edges, feet or directions that limit them; where several do, those
 * of the first. Longitudinal [2, 3], energy's in N. Statuses as above; NaN where the margin is. */
static inline void WG_NAME(wg_stability_margins_d_com)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT com,
                                                       const WG_REAL *WG_RESTRICT direction, const WG_REAL *WG_RESTRICT mu,
                                                       const WG_REAL *WG_RESTRICT normals, const WG_REAL *WG_RESTRICT gravity, WG_REAL mass,
                                                       const WG_REAL *WG_RESTRICT own, WG_REAL *WG_RESTRICT static_margin,
                                                       WG_REAL *WG_RESTRICT longitudinal, WG_REAL *WG_RESTRICT energy,
                                                       WG_REAL *WG_RESTRICT height, WG_REAL *WG_RESTRICT friction,
                                                       int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_support) support;
    struct WG_NAME(wg_margins) margins;
    WG_REAL *found[5], burden[4];
    int i, j;
    found[0] = static_margin;
    found[1] = longitudinal;
    found[2] = longitudinal + 3;
    found[3] = height;
    found[4] = friction;
    WG_NAME(wg_feasible_burden)(gravity, mass, own, burden);
    WG_NAME(wg_margins_read)(k, points, com, direction, mu, normals, burden, burden[3], &support, &margins);
    for (i = 0; i < 5; ++i) {
        if (!(margins.value[i] != margins.value[i])) {
            WG_NAME(wg_support_outside)(&support, margins.gradient[i], found[i]);
        } else {
            found[i][0] = found[i][1] = found[i][2] = WG_NAN;
        }
    }
    for (j = 0; j < 3; ++j) {
        energy[j] = height[j] * burden[3] * WG_NAME(wg_norm)(burden);
    }
    *status = margins.status;
}

#endif
