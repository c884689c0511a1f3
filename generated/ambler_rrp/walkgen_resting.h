/* walkgen_resting.h: where a chain that does not reach its target comes to rest closest to it; walkgen_math.h explains the macros.
 *
 * Newton's method on half the squared error, with second derivatives, damped as far as its matrix and the error need it.
 */
#include "walkgen_boxed.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_RESTING_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_RESTING_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_RESTING_F64
#define WG_FLAT WG_C(1e-10)
#else
#define WALKGEN_RESTING_F32
#define WG_FLAT WG_C(1e-5)
#endif
#ifndef WG_RESTING_STEPS
#define WG_RESTING_STEPS 200
#define WG_SADDLE_STEPS 16
#endif

/* Half the squared length of a rotation vector, derived along turns a and b: its shape on rotations. */
static inline WG_REAL WG_NAME(wg_bend)(const WG_REAL vector[3], WG_REAL angle, const WG_REAL a[3], const WG_REAL b[3]) {
    const WG_REAL half = WG_C(0.5) * angle, sine = WG_SIN(half);
    const WG_REAL factor = half > WG_C(1e-4) ? half * WG_COS(half) / sine : WG_C(1.0);
    const WG_REAL square = angle * angle, around = WG_NAME(wg_dot)(a, vector) * WG_NAME(wg_dot)(b, vector);
    return factor * WG_NAME(wg_dot)(a, b) + (square > WG_TINY ? (WG_C(1.0) - factor) * around / square : WG_C(0.0));
}

/* Second derivative of half the squared error by joints i <= j; `motion` are the values of the arm's function, if it has one. */
static inline WG_REAL WG_NAME(wg_curvature)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_arm_state) * at,
                                            const WG_REAL *motion, int i, int j) {
    const WG_REAL *a = at->turning[i], *b = at->turning[j];
    WG_REAL second[3], vector[3], sum;
    int k;
    WG_NAME(wg_cross)(a, at->column[j], second);
    for (k = 0; k < 3 && arm->motion; ++k) {
        second[k] = motion[(3 + arm->edges) * (1 + arm->n) + arm->n * (arm->n * k + i) + j];
    }
    sum = WG_NAME(wg_dot)(at->column[i], at->column[j]) + WG_NAME(wg_dot)(at->error, second);
    if (arm->rows == 6) {
        for (k = 0; k < 3; ++k) {
            vector[k] = at->error[3 + k] / arm->length;
        }
        WG_NAME(wg_cross)(a, b, second);
        sum += arm->length * arm->length * (WG_NAME(wg_bend)(vector, WG_NAME(wg_norm)(vector), a, b) +
                                            WG_C(0.5) * WG_NAME(wg_dot)(vector, second));
    }
    return sum;
}

/* The matrix of second derivatives of the free joints, damped, and downhill. */
static inline void WG_NAME(wg_second_order)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_arm_state) * at, WG_REAL damping,
                                            struct WG_NAME(wg_normal) * normal) {
    WG_REAL motion[WG_MOST_MOTION];
    int i, j;
    if (arm->motion) {
        (void)WG_NAME(wg_driven_foot_at)(arm->motion, arm->data, arm->edges, arm->n, arm->slides, arm->size, at->q, motion);
    }
    for (i = 0; i < normal->count; ++i) {
        const int joint = normal->free[i];
        normal->b[i] = -WG_NAME(wg_along)(arm->rows, at->column[joint], at->error);
        for (j = 0; j <= i; ++j) {
            normal->A[i][j] = WG_NAME(wg_curvature)(arm, at, motion, normal->free[j], joint) + (i == j ? damping : WG_C(0.0));
        }
    }
}

/* Newton's damped step; whether there is one. */
static inline int WG_NAME(wg_newton_step)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                          const struct WG_NAME(wg_arm_state) * at, struct WG_NAME(wg_normal) * normal, WG_REAL damping,
                                          WG_REAL *after) {
    WG_REAL step[WG_MOST_JOINTS];
    int i;
    WG_NAME(wg_second_order)(arm, at, damping, normal);
    if (WG_NAME(wg_solve_positive)(normal->count, normal) < normal->count) {
        return 0;
    }
    for (i = 0; i < arm->n; ++i) {
        step[i] = WG_C(0.0);
    }
    for (i = 0; i < normal->count; ++i) {
        step[normal->free[i]] = normal->b[i];
    }
    (void)WG_NAME(wg_stepped)(arm, box, at->q, step, after);
    return 1;
}

/* Leave a saddle along a direction of negative curvature, as far as that helps; whether at->q is one. */
static inline int WG_NAME(wg_leave_saddle)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                           struct WG_NAME(wg_arm_state) * at) {
    struct WG_NAME(wg_arm_state) after;
    struct WG_NAME(wg_normal) normal;
    WG_REAL step[WG_MOST_JOINTS], way[WG_MOST_JOINTS], longest = WG_C(1.0);
    int i, j, m;
    (void)WG_NAME(wg_free_joints)(arm, box, at, &normal);
    WG_NAME(wg_second_order)(arm, at, WG_C(0.0), &normal);
    j = WG_NAME(wg_solve_positive)(normal.count, &normal);
    if (j == normal.count || !(normal.A[j][j] < -WG_C(8.0) * WG_EPSILON * arm->reach * arm->reach)) {
        return 0;
    }
    for (i = 0; i < arm->n; ++i) {
        step[i] = WG_C(0.0);
    }
    way[j] = step[normal.free[j]] = WG_C(1.0);
    for (m = j - 1; m >= 0; --m) { /* L' way = 0 */
        way[m] = WG_C(0.0);
        for (i = m + 1; i <= j; ++i) {
            way[m] -= normal.A[i][m] * way[i];
        }
        step[normal.free[m]] = way[m];
        longest = WG_MAX(longest, WG_ABS(way[m]));
    }
    for (m = 0; m < 2 * WG_SADDLE_STEPS; ++m) {
        for (i = 0; i < arm->n; ++i) {
            after.q[i] = WG_MIN(WG_MAX(at->q[i] + step[i] * (WG_C(0.5) / longest), box->low[i]), box->high[i]);
            step[i] *= m % 2 == 0 ? WG_C(-1.0) : WG_C(-0.3);
        }
        WG_NAME(wg_serial_at)(arm, &after);
        if (after.gap < at->gap) {
            *at = after;
            return 1;
        }
    }
    return 0;
}

/* Lead at->q to where no joint that may move brings the foot nearer, be it a saddle: whether it gets there in 200 steps. */
static inline int WG_NAME(wg_slow_down)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                           struct WG_NAME(wg_arm_state) * at) {
    struct WG_NAME(wg_arm_state) after;
    struct WG_NAME(wg_normal) normal, next;
    const WG_REAL size = WG_MAX(arm->reach, arm->length), flat = size * (at->gap + size), least = WG_EPSILON * arm->rough;
    WG_REAL damping = WG_C(0.0), slope = WG_NAME(wg_free_joints)(arm, box, at, &normal), slope_after;
    const WG_REAL noise = WG_MAX(WG_C(4.0), arm->rough / WG_C(256.0)) * WG_EPSILON * (at->gap + size); /* what roundings leave of a gap */
    int i;
    for (i = 0; i < WG_RESTING_STEPS && slope > least * flat && damping < WG_C(1e6) * flat; ++i) {
        const int found = WG_NAME(wg_newton_step)(arm, box, at, &normal, damping, after.q);
        int better = found;
        if (found) {
            WG_NAME(wg_serial_at)(arm, &after);
            slope_after = WG_NAME(wg_free_joints)(arm, box, &after, &next);
            better = after.gap < at->gap - noise || (after.gap < at->gap + noise && slope_after < WG_C(0.5) * slope);
        }
        if (better) {
            WG_NAME(wg_move_to)(arm, &after, at);
            slope = WG_NAME(wg_free_joints)(arm, box, at, &normal);
            damping = damping < WG_C(1e-6) * flat ? WG_C(0.0) : WG_C(0.1) * damping;
        } else if (found && !(after.gap < WG_INFINITY) && WG_NAME(wg_meet_edges)(arm, after.q, at)) {
            slope = WG_NAME(wg_free_joints)(arm, box, at, &normal);
        } else {
            damping = WG_MAX(WG_C(10.0) * damping, WG_C(1e-7) * flat);
        }
    }
    return slope <= WG_MAX(WG_FLAT, least) * flat;
}

/* Whether the foot ends for a joint at the same value when the others move a little: else a way along the edge may lead down. */
static inline int WG_NAME(wg_edge_stands)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                          const struct WG_NAME(wg_arm_state) * at, int joint) {
    const WG_REAL little = WG_C(1e-3) * (WG_C(0.1) + WG_ABS(at->q[joint])), less = WG_C(1e-3) * little;
    struct WG_NAME(wg_arm_state) tried;
    int k, m, stands = 1;
    for (k = 0; k < 2 * arm->n && stands; ++k) {
        if (k / 2 == joint) {
            continue;
        }
        for (m = -1; m <= 1 && stands; m += 2) {
            tried = *at;
            tried.q[k / 2] = WG_MIN(WG_MAX(at->q[k / 2] + (k % 2 ? little : -little), box->low[k / 2]), box->high[k / 2]);
            tried.q[joint] += (WG_REAL)(m * at->edge[joint]) * less;
            WG_NAME(wg_serial_at)(arm, &tried);
            stands = (tried.gap < WG_INFINITY) == (m < 0);
        }
    }
    return stands;
}

/* The same of all joints at edges. */
static inline int WG_NAME(wg_edges_stand)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                          const struct WG_NAME(wg_arm_state) * at) {
    int j, stand = 1;
    for (j = 0; j < arm->n; ++j) {
        stand = stand && (at->edge[j] == 0 || WG_NAME(wg_edge_stands)(arm, box, at, j));
    }
    return stand;
}

/* Lead at->q to rest where no joint that may move leads down, at most three times past a saddle or on from where it is slow: whether it gets
 * there. */
static inline int WG_NAME(wg_settle_down)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                           struct WG_NAME(wg_arm_state) * at) {
    int i, rests = WG_NAME(wg_slow_down)(arm, box, at);
    for (i = 0; i < 3 && !WG_NAME(wg_serial_reaches)(arm, at) && (!rests || WG_NAME(wg_leave_saddle)(arm, box, at)); ++i) {
        rests = WG_NAME(wg_boxed_descent)(arm, box, at) || WG_NAME(wg_slow_down)(arm, box, at);
    }
    return rests;
}

/* Lead at->q to rest where no way leads down: whether it gets there. */
static inline int WG_NAME(wg_come_to_rest)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                           struct WG_NAME(wg_arm_state) * at) {
    struct WG_NAME(wg_arm_state) along;
    int j, rests = WG_NAME(wg_settle_down)(arm, box, at), plain = rests || WG_NAME(wg_serial_reaches)(arm, at);
    for (j = 0; j < arm->n; ++j) {
        plain = plain && at->edge[j] == 0;
    }
    if (plain || !arm->along_edges) {
        return rests;
    }
    along = *at;
    if (arm->along_edges(arm, box, &along)) {
        *at = along;
        return 1;
    }
    rests = rests && WG_NAME(wg_edges_stand)(arm, box, at);
    *at = !rests && along.gap < at->gap ? along : *at;
    return rests;
}

#undef WG_FLAT
#endif
