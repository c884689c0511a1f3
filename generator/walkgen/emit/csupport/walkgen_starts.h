/* walkgen_starts.h: joint values to start a search from, in closed form where three joints of a chain allow it; walkgen_math.h explains
 * the macros.
 *
 * Three joints next to each other, the others at rest, bring a point to its target by the general inverse. The points: the foot; for a
 * pose, a point on the last axis, which the last joint does not move; the centre of a wrist, where the last three axes meet, whose angles
 * follow in closed form too. A chain seen from its foot (wg_serial_reversed) has its first joints last.
 */
#include "walkgen_inverse_general.h"
#include "walkgen_resting.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_STARTS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_STARTS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_STARTS_F64
#define WG_MEETING WG_C(1e-9)
#else
#define WALKGEN_STARTS_F32
#define WG_MEETING WG_C(1e-5)
#endif
#ifndef WG_MOST_ROWS
#define WG_MOST_ROWS 8
#endif

/* Joint values, some of them solved for. */
struct WG_NAME(wg_rows) {
    int count;
    WG_REAL q[WG_MOST_ROWS][WG_MOST_JOINTS];
};

/* Where a joint takes a point, in place. */
static inline void WG_NAME(wg_serial_moved)(const struct WG_NAME(wg_serial) * arm, int joint, WG_REAL q, WG_REAL point[3]) {
    if (arm->slides[joint]) {
        WG_NAME(wg_add)(point, q, arm->axis[joint], point);
        return;
    }
    WG_NAME(wg_add)(point, WG_C(-1.0), arm->point[joint], point);
    WG_NAME(wg_turn)(arm->axis[joint], WG_COS(q), WG_SIN(q), point);
    WG_NAME(wg_add)(point, WG_C(1.0), arm->point[joint], point);
}

/* The arm that leads the target back to the foot by the same joint values, last joint first. */
static inline void WG_NAME(wg_serial_reversed)(const struct WG_NAME(wg_serial) * arm, struct WG_NAME(wg_serial) * back) {
    int i, j;
    *back = *arm;
    for (i = 0; i < 3; ++i) {
        back->foot[i] = arm->target[i];
        back->target[i] = arm->foot[i];
        for (j = 0; j < 3 && arm->rows == 6; ++j) {
            back->rotation[3 * i + j] = arm->rotation[3 * j + i];
        }
        for (j = 0; j < arm->n; ++j) {
            back->slides[j] = arm->slides[arm->n - 1 - j];
            back->axis[j][i] = -arm->axis[arm->n - 1 - j][i];
            back->point[j][i] = arm->point[arm->n - 1 - j][i];
        }
    }
}

/* Where the target has a point of the foot's body, given at q = 0. */
static inline void WG_NAME(wg_serial_goal)(const struct WG_NAME(wg_serial) * arm, const WG_REAL point[3], WG_REAL goal[3]) {
    WG_REAL arm_of[3];
    int i;
    WG_NAME(wg_add)(point, WG_C(-1.0), arm->foot, arm_of);
    for (i = 0; i < 3; ++i) {
        goal[i] = arm->target[i] + (arm->rows == 6 ? WG_NAME(wg_dot)(arm->rotation + 3 * i, arm_of) : arm_of[i]);
    }
}

/* Rows of q whose joints first .. first + 2 bring a point, given at q = 0, to where the target has it; the closest where they cannot. */
static inline void WG_NAME(wg_three_joints)(const struct WG_NAME(wg_serial) * arm, int first, const WG_REAL point[3], const WG_REAL *q,
                                            struct WG_NAME(wg_rows) * rows) {
    WG_REAL geometry[21], goal[3], found[12];
    int32_t sequence = 1, status[4];
    int i, j, count = 0;
    WG_NAME(wg_serial_goal)(arm, point, goal);
    for (i = 0; i < 3; ++i) {
        geometry[18 + i] = point[i];
        for (j = 0; j < 3; ++j) {
            geometry[6 * j + i] = arm->axis[first + j][i];
            geometry[6 * j + 3 + i] = arm->point[first + j][i];
        }
        sequence = 2 * sequence + arm->slides[first + i];
    }
    for (j = arm->n - 1; j > first + 2; --j) {
        WG_NAME(wg_serial_moved)(arm, j, q[j], geometry + 18);
    }
    for (j = 0; j < first; ++j) {
        WG_NAME(wg_serial_moved)(arm, j, -q[j], goal);
    }
    WG_NAME(wg_inverse_general)(geometry, goal, sequence, found, status);
    for (i = 0; i < WG_NAME(wg_slots_of)(sequence); ++i) {
        if (status[i] == WALKGEN_BAD_INPUT || status[i] == WALKGEN_DUPLICATE || (i > 0 && status[i] == WALKGEN_UNREACHABLE)) {
            continue;
        }
        for (j = 0; j < arm->n; ++j) {
            rows->q[count][j] = j < first || j > first + 2 ? q[j] : found[3 * i + j - first];
        }
        ++count;
    }
    rows->count = count;
}

/* The point where the last three axes meet, all of them turning; whether there is one. */
static inline int WG_NAME(wg_wrist_centre)(const struct WG_NAME(wg_serial) * arm, WG_REAL centre[3]) {
    const int n = arm->n;
    WG_REAL across[3], between[3], arm_of[3], square;
    int j;
    if (n < 6 || arm->slides[n - 1] || arm->slides[n - 2] || arm->slides[n - 3]) {
        return 0;
    }
    WG_NAME(wg_cross)(arm->axis[n - 2], arm->axis[n - 1], across);
    square = WG_NAME(wg_dot)(across, across);
    WG_NAME(wg_add)(arm->point[n - 2], WG_C(-1.0), arm->point[n - 1], between);
    WG_NAME(wg_cross)(arm->axis[n - 2], between, arm_of);
    if (!(square > WG_C(1e-6))) {
        return 0;
    }
    WG_NAME(wg_add)(arm->point[n - 1], WG_NAME(wg_dot)(arm_of, across) / square, arm->axis[n - 1], centre);
    for (j = n - 3; j < n; ++j) {
        WG_NAME(wg_add)(centre, WG_C(-1.0), arm->point[j], between);
        WG_NAME(wg_cross)(arm->axis[j], between, arm_of);
        if (!(WG_NAME(wg_norm)(arm_of) <= WG_MEETING * arm->reach)) {
            return 0;
        }
    }
    return 1;
}

/* A direction of the foot as the target has it, seen by joint `before` where the joints before it have the values q. */
static inline void WG_NAME(wg_seen_by)(const struct WG_NAME(wg_serial) * arm, int before, const WG_REAL *q, const WG_REAL direction[3],
                                       WG_REAL seen[3]) {
    int i, j;
    for (i = 0; i < 3; ++i) {
        seen[i] = WG_NAME(wg_dot)(arm->rotation + 3 * i, direction);
    }
    for (j = 0; j < before; ++j) {
        if (!arm->slides[j]) {
            WG_NAME(wg_turn)(arm->axis[j], WG_COS(q[j]), -WG_SIN(q[j]), seen);
        }
    }
}

/* The last joint's angle that turns the foot as near as it can to what the target wants, after the other joints. */
static inline void WG_NAME(wg_last_angle)(const struct WG_NAME(wg_serial) * arm, WG_REAL *q) {
    const int last = arm->n - 1;
    WG_REAL mark[3], unused[3], seen[3];
    WG_NAME(wg_across)(arm->axis[last], mark, unused);
    WG_NAME(wg_seen_by)(arm, last, q, mark, seen);
    q[last] = arm->slides[last] ? q[last] : WG_NAME(wg_angle_about)(arm->axis[last], mark, seen);
}

/* The last three joints, two ways, that turn the foot as the target wants it, after the other joints of `row`: rows `row` and `twin`.
 * With the axes a, b, c and B(q) the turn about b: a . B(q) c is known. */
static inline void WG_NAME(wg_wrist_angles)(const struct WG_NAME(wg_serial) * arm, WG_REAL *row, WG_REAL *twin) {
    const int n = arm->n;
    const WG_REAL *a = arm->axis[n - 3], *b = arm->axis[n - 2], *c = arm->axis[n - 1];
    const WG_REAL along = WG_NAME(wg_dot)(a, b) * WG_NAME(wg_dot)(b, c), across = WG_NAME(wg_dot)(a, c) - along;
    WG_REAL side[3], aim[3], sine, cosine, middle, spread;
    int i, j;
    WG_NAME(wg_seen_by)(arm, n - 3, row, c, aim);
    WG_NAME(wg_cross)(b, c, side);
    sine = WG_NAME(wg_dot)(a, side);
    middle = WG_ATAN2(sine, across);
    cosine = (WG_NAME(wg_dot)(a, aim) - along) / WG_MAX(WG_HYPOT(sine, across), WG_TINY);
    cosine = WG_MIN(WG_MAX(cosine, WG_C(-1.0)), WG_C(1.0));
    spread = WG_ATAN2(WG_SQRT((WG_C(1.0) - cosine) * (WG_C(1.0) + cosine)), cosine);
    for (j = 0; j < n; ++j) {
        twin[j] = row[j];
    }
    for (i = 0; i < 2; ++i) {
        WG_REAL *q = i == 0 ? row : twin, turned[3];
        q[n - 2] = i == 0 ? middle + spread : middle - spread;
        WG_NAME(wg_add)(c, WG_C(0.0), c, turned);
        WG_NAME(wg_turn)(b, WG_COS(q[n - 2]), WG_SIN(q[n - 2]), turned);
        q[n - 3] = WG_NAME(wg_angle_about)(a, turned, aim);
        WG_NAME(wg_last_angle)(arm, q);
    }
}

/* Rows for an arm with a wrist; joints before the three that move its centre are as in q. */
static inline void WG_NAME(wg_wrist_rows)(const struct WG_NAME(wg_serial) * arm, const WG_REAL centre[3], const WG_REAL *q,
                                          struct WG_NAME(wg_rows) * rows) {
    int i, j;
    WG_NAME(wg_three_joints)(arm, arm->n - 6, centre, q, rows);
    for (i = rows->count - 1; i >= 0; --i) {
        for (j = 0; j < arm->n; ++j) {
            rows->q[2 * i][j] = rows->q[i][j];
        }
        WG_NAME(wg_wrist_angles)(arm, rows->q[2 * i], rows->q[2 * i + 1]);
    }
    rows->count *= 2;
}

/* Whether the closed form that follows gives all solutions, but for those with a free joint. */
static inline int WG_NAME(wg_all_in_rows)(const struct WG_NAME(wg_serial) * arm) {
    WG_REAL unused[3];
    if (arm->motion || arm->rows == 3) {
        return !arm->motion && arm->n == 3;
    }
    return (arm->n == 4 && !arm->slides[3]) || (arm->n == 6 && WG_NAME(wg_wrist_centre)(arm, unused));
}

/* Rows by the best closed form of the arm as it is seen, joints that it does not solve for as in q; none for too few joints. */
static inline void WG_NAME(wg_forward_rows)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *q, struct WG_NAME(wg_rows) * rows) {
    WG_REAL centre[3];
    int i;
    rows->count = 0;
    if (arm->rows == 3 && arm->n >= 3) {
        WG_NAME(wg_three_joints)(arm, arm->n - 3, arm->foot, q, rows);
    } else if (arm->rows == 6 && WG_NAME(wg_wrist_centre)(arm, centre)) {
        WG_NAME(wg_wrist_rows)(arm, centre, q, rows);
    } else if (arm->rows == 6 && arm->n >= 4) {
        WG_NAME(wg_three_joints)(arm, arm->n - 4, arm->point[arm->n - 1], q, rows);
        for (i = 0; i < rows->count; ++i) {
            WG_NAME(wg_last_angle)(arm, rows->q[i]);
        }
    }
}

/* The same of the arm seen from its foot: `back`. */
static inline void WG_NAME(wg_backward_rows)(const struct WG_NAME(wg_serial) * back, const WG_REAL *q, struct WG_NAME(wg_rows) * rows) {
    const int n = back->n;
    WG_REAL mirrored[WG_MOST_JOINTS];
    int i, j;
    for (j = 0; j < n; ++j) {
        mirrored[j] = q[n - 1 - j];
    }
    WG_NAME(wg_forward_rows)(back, mirrored, rows);
    for (i = 0; i < rows->count; ++i) {
        for (j = 0; j < n; ++j) {
            mirrored[j] = rows->q[i][j];
        }
        for (j = 0; j < n; ++j) {
            rows->q[i][j] = mirrored[n - 1 - j];
        }
    }
}

#undef WG_MEETING
#endif
