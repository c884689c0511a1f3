/* walkgen_driven.h: joint values of a chain whose foot a function describes, such as a leg of closed loops, for a position of the foot;
 * walkgen_math.h explains the macros.
 *
 * The searches of walkgen_within.h and walkgen_reach.h, with as many steps at most; where there is no foot, no step goes.
 */
#include "walkgen_edges.h"
#include "walkgen_reach.h"
#include "walkgen_within.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_DRIVEN_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_DRIVEN_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_DRIVEN_F64
#define WG_LIBM(name) name
#define WG_TOLERANCE WG_C(1e-12)
#else
#define WALKGEN_DRIVEN_F32
#define WG_LIBM(name) name##f
#define WG_TOLERANCE (WG_C(16.0) * WG_EPSILON)
#endif

/* No axes and no foot: a function knows them. */
static inline void WG_NAME(wg_no_geometry)(struct WG_NAME(wg_serial) * arm) {
    int i, j;
    for (i = 0; i < 9; ++i) {
        arm->rotation[i] = WG_C(0.0);
    }
    for (i = 0; i < 3; ++i) {
        arm->foot[i] = WG_C(0.0);
        for (j = 0; j < WG_MOST_JOINTS; ++j) {
            arm->axis[j][i] = arm->point[j][i] = arm->lever[j][i] = WG_C(0.0);
        }
    }
}

/* The arm from its function and its target, lengths scaled by a power of 2 to about 1; a target very far away comes nearer: only its
 * direction counts. Whether there is one. */
static inline int WG_NAME(wg_driven_read)(const WG_REAL p[3], WG_REAL reach, int32_t sequence, int32_t edges,
                                          WG_NAME(wg_driven_foot) motion, const void *data, struct WG_NAME(wg_serial) * arm) {
    WG_REAL farthest = WG_C(0.0);
    int i, far, fine = sequence > 1 && sequence < (2 << WG_MOST_JOINTS) && edges >= 0 && edges <= WG_MOST_EDGES && reach > WG_C(0.0) && reach <= WG_HUGE;
    for (i = 0; i < 3; ++i) {
        fine = fine && isfinite(p[i]);
        farthest = WG_MAX(farthest, WG_ABS(p[i]));
    }
    if (!fine) {
        return 0;
    }
    WG_NAME(wg_no_geometry)(arm);
    arm->n = WG_NAME(wg_joints_of)(sequence);
    arm->rows = 3;
    arm->edges = edges;
    arm->rough = WG_C(1024.0);
    arm->along_edges = WG_NAME(wg_along_edges);
    arm->motion = motion;
    arm->data = data;
    (void)WG_LIBM(frexp)(reach, &arm->size);
    (void)WG_LIBM(frexp)(farthest, &far);
    far = far - arm->size > 20 ? far - 20 : arm->size;
    for (i = 0; i < 3; ++i) {
        arm->target[i] = WG_LIBM(ldexp)(p[i], -far);
    }
    for (i = 0; i < arm->n; ++i) {
        arm->slides[i] = (sequence >> (arm->n - 1 - i)) % 2 == 1;
    }
    arm->reach = WG_LIBM(ldexp)(reach, -arm->size);
    arm->tolerance = WG_TOLERANCE * arm->reach;
    arm->length = WG_C(0.25) * arm->reach;
    return 1;
}

/* As wg_closest_within: where the status is UNREACHABLE, q [n] becomes the joint values within the limits [n, 2] that bring the foot
 * closest to p, from a guess. `reach` is about how far the foot gets. Where no q that is tried has a foot the guess stays, NO_CONVERGENCE. */
static inline void WG_NAME(wg_closest_driven)(const WG_REAL *WG_RESTRICT p, const WG_REAL *WG_RESTRICT limits, WG_REAL reach,
                                              int32_t sequence, int32_t edges, WG_NAME(wg_driven_foot) motion, const void *data, WG_REAL *WG_RESTRICT q,
                                              int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_serial) arm;
    if (*status == WALKGEN_UNREACHABLE) {
        if (WG_NAME(wg_driven_read)(p, reach, sequence, edges, motion, data, &arm)) {
            WG_NAME(wg_closest)(&arm, limits, q, status);
        } else {
            WG_NAME(wg_no_row)(WG_NAME(wg_joints_of)(sequence), q, status);
        }
    }
}

/* As wg_inverse_reach: joint values [n] near a seed [n] that bring the foot to p, within the limits [n, 2] if that can be. */
static inline void WG_NAME(wg_inverse_driven)(const WG_REAL *WG_RESTRICT p, const WG_REAL *WG_RESTRICT seed,
                                              const WG_REAL *WG_RESTRICT limits, WG_REAL reach, int32_t sequence,
                                              int32_t edges, WG_NAME(wg_driven_foot) motion, const void *data, WG_REAL *WG_RESTRICT q,
                                              int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_serial) arm;
    if (WG_NAME(wg_driven_read)(p, reach, sequence, edges, motion, data, &arm)) {
        WG_NAME(wg_inverse_near)(&arm, seed, limits, q, status);
    } else {
        WG_NAME(wg_no_row)(WG_NAME(wg_joints_of)(sequence), q, status);
    }
}

/* A solution q [n] of the status, if it is one, or one that a descent from the seed comes to, whichever is nearer to the seed; where
 * neither is one, what wg_inverse_driven finds. */
static inline void WG_NAME(wg_nearer_driven)(const WG_REAL *WG_RESTRICT p, const WG_REAL *WG_RESTRICT seed,
                                             const WG_REAL *WG_RESTRICT limits, WG_REAL reach, int32_t sequence,
                                             int32_t edges, WG_NAME(wg_driven_foot) motion, const void *data, WG_REAL *WG_RESTRICT q,
                                             int32_t *WG_RESTRICT status) {
    const int known = *status == WALKGEN_OK || *status == WALKGEN_SINGULAR;
    struct WG_NAME(wg_serial) arm;
    struct WG_NAME(wg_search) search;
    struct WG_NAME(wg_box) bounds;
    WG_REAL row[WG_MOST_JOINTS], apart;
    int j;
    if (!WG_NAME(wg_driven_read)(p, reach, sequence, edges, motion, data, &arm) || !WG_NAME(wg_read_limits)(&arm, limits, &bounds) ||
        !WG_NAME(wg_read_seed)(&arm, &bounds, seed, search.seed)) {
        WG_NAME(wg_no_row)(WG_NAME(wg_joints_of)(sequence), q, status);
        return;
    }
    search.arm = search.back = &arm;
    for (j = 0; j < arm.n; ++j) {
        row[j] = arm.slides[j] ? WG_LIBM(ldexp)(q[j], -arm.size) : q[j];
        search.box.low[j] = -WG_INFINITY;
        search.box.high[j] = WG_INFINITY;
    }
    WG_NAME(wg_search_anew)(&search);
    WG_NAME(wg_attempt)(&search, search.seed);
    (void)WG_NAME(wg_from_seed)(&search, row, &apart);
    if (search.reached && !(known && apart <= search.apart)) {
        const int32_t state = WG_NAME(wg_rank_lost)(&arm, &search.best) ? WALKGEN_SINGULAR : WALKGEN_OK;
        WG_NAME(wg_write_arm)(&arm, &bounds, search.seed, &search.best, state, q, status);
    } else if (!search.reached && !known) {
        WG_NAME(wg_inverse_near)(&arm, seed, limits, q, status);
    }
}

#undef WG_LIBM
#undef WG_TOLERANCE
#endif
