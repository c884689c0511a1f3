/* walkgen_boxed.h: joint values of a chain led to its target inside a box of limits; walkgen_math.h explains the macros.
 *
 * Levenberg and Marquardt's damped Gauss-Newton steps with the exact Jacobian. Joints at a bound that the step would cross stay there, and
 * joints that the step would take across one stop at it while the others make up for them.
 */
#include "walkgen_serial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_BOXED_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_BOXED_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_BOXED_F64
#else
#define WALKGEN_BOXED_F32
#endif
#ifndef WG_USUAL_STEPS
#define WG_USUAL_STEPS 60 /* of a descent */
#define WG_MOST_STEPS 300 /* of one that came near its target */
#endif

/* Bounds of the joint values; infinite where there are none. */
struct WG_NAME(wg_box) {
    WG_REAL low[WG_MOST_JOINTS], high[WG_MOST_JOINTS];
};

/* The joints that a step may move, and what it minimises: its normal equations. */
struct WG_NAME(wg_normal) {
    int count, free[WG_MOST_JOINTS];
    WG_REAL A[WG_MOST_JOINTS][WG_MOST_JOINTS], b[WG_MOST_JOINTS];
};

/* A x = b for the first k rows by L D L' of a symmetric matrix, given below its diagonal; how many pivots are positive: k, or no x. */
static inline int WG_NAME(wg_solve_positive)(int k, struct WG_NAME(wg_normal) * normal) {
    WG_REAL *b = normal->b;
    int i, j, m;
    for (j = 0; j < k; ++j) {
        WG_REAL *row = normal->A[j], pivot = row[j];
        for (m = 0; m < j; ++m) {
            pivot -= row[m] * normal->A[m][j];
        }
        if (!(pivot > WG_EPSILON * WG_EPSILON * row[j])) {
            row[j] = pivot;
            return j;
        }
        row[j] = WG_C(1.0) / pivot;
        for (i = j + 1; i < k; ++i) {
            WG_REAL sum = normal->A[i][j];
            for (m = 0; m < j; ++m) {
                sum -= normal->A[i][m] * normal->A[m][j];
            }
            row[i] = sum; /* D L' above the diagonal, L below */
            normal->A[i][j] = sum * row[j];
        }
        for (m = 0; m < j; ++m) {
            b[j] -= row[m] * b[m];
        }
    }
    for (i = k - 1; i >= 0; --i) {
        b[i] *= normal->A[i][i];
        for (m = i + 1; m < k; ++m) {
            b[i] -= normal->A[m][i] * b[m];
        }
    }
    return k;
}

/* Of errors, Jacobian columns: 3 or 6 rows. */
static inline WG_REAL WG_NAME(wg_along)(int rows, const WG_REAL a[6], const WG_REAL b[6]) {
    return rows == 3 ? WG_NAME(wg_dot)(a, b) : WG_NAME(wg_dot)(a, b) + WG_NAME(wg_dot)(a + 3, b + 3);
}

/* The joints that may move downhill; how steep that is, as a vector's length. */
static inline WG_REAL WG_NAME(wg_free_joints)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                              const struct WG_NAME(wg_arm_state) * at, struct WG_NAME(wg_normal) * normal) {
    WG_REAL square = WG_C(0.0);
    int j;
    normal->count = 0;
    for (j = 0; j < arm->n; ++j) {
        const WG_REAL slope = WG_NAME(wg_along)(arm->rows, at->column[j], at->error);
        const int down = at->edge[j] >= 0 && at->q[j] > box->low[j], up = at->edge[j] <= 0 && at->q[j] < box->high[j];
        if ((slope >= WG_C(0.0) && down) || (slope <= WG_C(0.0) && up)) {
            normal->free[normal->count++] = j;
            square += slope * slope;
        }
    }
    return WG_SQRT(square);
}

/* The damped step of the free joints that makes up for an error best and shortest, by the smaller of the two normal equations. */
static inline int WG_NAME(wg_gauss_step)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_arm_state) * at,
                                         struct WG_NAME(wg_normal) * normal, const WG_REAL error[6], WG_REAL damping,
                                         WG_REAL step[WG_MOST_JOINTS]) {
    const int rows = arm->rows, few = normal->count < rows, k = few ? normal->count : rows, *free = normal->free;
    int i, j, m;
    for (i = 0; i < k; ++i) {
        normal->b[i] = few ? -WG_NAME(wg_along)(rows, at->column[free[i]], error) : -error[i];
        for (j = 0; j <= i; ++j) {
            WG_REAL sum = i == j ? damping : WG_C(0.0);
            for (m = 0; m < normal->count && !few; ++m) {
                sum += at->column[free[m]][i] * at->column[free[m]][j];
            }
            normal->A[i][j] = few ? sum + WG_NAME(wg_along)(rows, at->column[free[i]], at->column[free[j]]) : sum;
        }
    }
    if (WG_NAME(wg_solve_positive)(k, normal) < k) {
        return 0;
    }
    for (m = 0; m < normal->count; ++m) {
        step[free[m]] = few ? normal->b[m] : WG_NAME(wg_along)(rows, at->column[free[m]], normal->b);
    }
    return 1;
}

/* q plus a step, cut so that no joint turns by more than 2, in the box; the longest part of the step. */
static inline WG_REAL WG_NAME(wg_stepped)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box, const WG_REAL *q,
                                          const WG_REAL *step, WG_REAL *after) {
    WG_REAL longest = WG_C(0.0), turn = WG_C(2.0);
    int j;
    for (j = 0; j < arm->n; ++j) {
        longest = WG_MAX(longest, WG_ABS(step[j]));
        turn = arm->slides[j] ? turn : WG_MAX(turn, WG_ABS(step[j]));
    }
    for (j = 0; j < arm->n; ++j) {
        after[j] = WG_MIN(WG_MAX(q[j] + step[j] * (WG_C(2.0) / turn), box->low[j]), box->high[j]);
    }
    return longest;
}

/* q after a damped step inside the box: its longest part; 1 where there is none and q stays. Joints that would cross a bound stop there. */
static inline WG_REAL WG_NAME(wg_boxed_step)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                             const struct WG_NAME(wg_arm_state) * at, struct WG_NAME(wg_normal) * normal, WG_REAL damping,
                                             WG_REAL *after) {
    WG_REAL error[6], step[WG_MOST_JOINTS];
    int i, j, kept, crossing = 1;
    for (i = 0; i < arm->rows; ++i) {
        error[i] = at->error[i];
    }
    for (j = 0; j < arm->n; ++j) {
        step[j] = WG_C(0.0);
        after[j] = at->q[j];
    }
    while (crossing && normal->count > 0) {
        if (!WG_NAME(wg_gauss_step)(arm, at, normal, error, damping, step)) {
            return WG_C(1.0);
        }
        for (i = kept = crossing = 0; i < normal->count; ++i) {
            const int joint = normal->free[i];
            const WG_REAL moved = at->q[joint] + step[joint];
            const WG_REAL inside = WG_MIN(WG_MAX(moved, box->low[joint]), box->high[joint]);
            if (inside == moved) {
                normal->free[kept++] = joint;
                continue;
            }
            crossing = 1;
            step[joint] = inside - at->q[joint];
            for (j = 0; j < arm->rows; ++j) {
                error[j] += at->column[joint][j] * step[joint];
            }
        }
        normal->count = kept;
    }
    return WG_NAME(wg_stepped)(arm, box, at->q, step, after);
}

/* The value of a joint at which the foot ends, between one that has a foot and one that has none; the others as at->q. */
static inline WG_REAL WG_NAME(wg_last_foot)(const struct WG_NAME(wg_serial) * arm, struct WG_NAME(wg_arm_state) at, int joint,
                                            WG_REAL none) {
    WG_REAL there = at.q[joint];
    int i;
    for (i = 0; i < 64; ++i) {
        at.q[joint] = WG_C(0.5) * (there + none);
        if (at.q[joint] == there || at.q[joint] == none) {
            break;
        }
        WG_NAME(wg_serial_at)(arm, &at);
        *(at.gap < WG_INFINITY ? &there : &none) = at.q[joint];
    }
    return there;
}

/* Lead a joint that alone leads to where there is no foot up to where the foot ends, or to a part of this way: there slopes grow with the
 * square root of what is left of it. Whether that is nearer to the target. */
static inline int WG_NAME(wg_meet_edge)(const struct WG_NAME(wg_serial) * arm, int joint, WG_REAL none, struct WG_NAME(wg_arm_state) * at) {
    struct WG_NAME(wg_arm_state) tried = *at;
    const WG_REAL start = at->q[joint], edge = WG_NAME(wg_last_foot)(arm, *at, joint, none);
    WG_REAL root = WG_C(0.0);
    int i, k;
    for (i = 0; i < 8; ++i, root = WG_C(0.5) + WG_C(0.5) * root) {
        tried.q[joint] = edge + root * root * (start - edge);
        WG_NAME(wg_serial_at)(arm, &tried);
        if (tried.gap < at->gap) {
            const WG_REAL on = (none - start) * WG_NAME(wg_along)(arm->rows, tried.column[joint], tried.error);
            for (k = 0; k < arm->n; ++k) {
                tried.edge[k] = k != joint ? at->edge[k] : i > 0 || !(on < WG_C(0.0)) ? 0 : none > start ? 1 : -1;
            }
            *at = tried;
            return 1;
        }
    }
    return 0;
}

/* Where a step leads to where there is no foot: lead every joint that alone does so towards where the foot ends. Whether one was. */
static inline int WG_NAME(wg_meet_edges)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *after, struct WG_NAME(wg_arm_state) * at) {
    int j, met = 0;
    for (j = 0; j < arm->n && arm->along_edges; ++j) {
        struct WG_NAME(wg_arm_state) tried = *at;
        tried.q[j] = after[j];
        WG_NAME(wg_serial_at)(arm, &tried);
        if (!(tried.gap < WG_INFINITY)) {
            met |= WG_NAME(wg_meet_edge)(arm, j, after[j], at);
        }
    }
    return met;
}

/* A stance that is better; joints that have not moved are at the edges where they were. */
static inline void WG_NAME(wg_move_to)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_arm_state) * after,
                                       struct WG_NAME(wg_arm_state) * at) {
    const struct WG_NAME(wg_arm_state) before = *at;
    int j;
    *at = *after;
    for (j = 0; j < arm->n; ++j) {
        at->edge[j] = at->q[j] == before.q[j] ? before.edge[j] : 0;
    }
}

/* Lead at->q, which is inside the box, to the target or to rest; whether the target is reached, and then to its roundings.
 * A descent ends after 60 steps, one that came near the target after 300; earlier where eight steps gain less than a twentieth. */
static inline int WG_NAME(wg_boxed_descent)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                            struct WG_NAME(wg_arm_state) * at) {
    struct WG_NAME(wg_arm_state) after;
    struct WG_NAME(wg_normal) normal;
    WG_REAL factor = WG_C(0.1), before = WG_INFINITY;
    int i, reached = 0, ended = 0;
    WG_NAME(wg_serial_at)(arm, at);
    for (i = 0; i < WG_MOST_STEPS && !ended; ++i) {
        const int near = at->gap < WG_C(1e-3) * arm->reach;
        WG_REAL damping, longest;
        reached = WG_NAME(wg_serial_reaches)(arm, at);
        if (i % 8 == 7) {
            ended = !near && at->gap > WG_C(0.95) * before;
            before = at->gap;
        }
        if (ended || (i >= WG_USUAL_STEPS && !near) || at->gap <= WG_C(2.0) * WG_EPSILON * arm->reach) {
            break;
        }
        (void)WG_NAME(wg_free_joints)(arm, box, at, &normal);
        damping = reached ? WG_C(0.0) : factor * at->gap * at->gap;
        longest = WG_NAME(wg_boxed_step)(arm, box, at, &normal, damping + WG_EPSILON * WG_EPSILON * arm->reach, after.q);
        WG_NAME(wg_serial_at)(arm, &after);
        if (after.gap < at->gap) {
            ended = reached && after.gap > WG_C(0.25) * at->gap;
            factor = WG_MAX(WG_C(0.3) * factor, WG_C(1e-3));
            WG_NAME(wg_move_to)(arm, &after, at);
        } else if (after.gap < WG_INFINITY || !WG_NAME(wg_meet_edges)(arm, after.q, at)) {
            ended = reached || !(longest > WG_EPSILON);
            factor *= WG_C(8.0);
        }
    }
    return WG_NAME(wg_serial_reaches)(arm, at);
}

#endif
