/* walkgen_adapt_legs.h: legs that follow their platform, each foot on its target; walkgen_math.h explains the macros.
 *
 * A leg is continued by Newton from its last pose; where that does not reach the target to rounding, or leads far away, the closed form
 * (walkgen_inverse_general.h, or a function of the leg) gives all poses, of which the nearest on the same sheet (sign of det J) counts.
 */
#include "walkgen_inverse_general.h"
#include "walkgen_tree.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_LEGS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_LEGS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_LEGS_F64
#define WG_LIBM(name) name
#define WG_REGULAR WG_C(1e-9)
#else
#define WALKGEN_ADAPT_LEGS_F32
#define WG_LIBM(name) name##f
#define WG_REGULAR WG_C(1e-5)
#endif

#ifndef WG_DRIVEN_ROWS
#define WG_DRIVEN_ROWS 96
#endif

/* Joint values [n][3] that bring a foot to a target, given with a seed [6], and their statuses [n]. */
typedef void (*WG_NAME(wg_driven_rows))(const WG_REAL *aim, WG_REAL *rows, int32_t *states, const void *data);

/* A leg that functions describe instead of its axes (no motion: axes do), in the frame of its platform: its foot; at most WG_DRIVEN_ROWS
 * poses, of which there are `slots`; one pose somewhere, for where none of those is known. */
struct WG_NAME(wg_driven_leg) {
    WG_NAME(wg_driven_foot) motion;
    WG_NAME(wg_driven_rows) rows, somewhere;
    int32_t slots, platform;
};

/* A foot's last three joints at q = 0, as wg_inverse_general takes them too. reach: the longest lever of a turning joint, or 1; spans: the
 * unit of each joint's distance; driven: what has the poses where the chain has a function. */
struct WG_NAME(wg_adapt_leg) {
    struct WG_NAME(wg_chain) chain;
    const struct WG_NAME(wg_driven_leg) * driven;
    WG_REAL geometry[21], reach, spans[3];
    int32_t sequence;
    int base;
};

/* Joint values, how far the foot is from its target (root platform's axes), and the sign of det J, 0 near singular poses. */
struct WG_NAME(wg_adapt_pose) {
    WG_REAL q[3], gap[3];
    int sheet;
};

/* The leg of a foot; half: the unit of every joint's distance [nq]; driven: what describes it instead of axes, or NULL. */
static inline void WG_NAME(wg_adapt_leg_of)(const struct WG_NAME(wg_tree) * tree, int foot, const WG_REAL *half,
                                            const struct WG_NAME(wg_driven_leg) * driven, const void *data,
                                            struct WG_NAME(wg_adapt_leg) * leg) {
    WG_REAL arm[3], swept[3];
    int i, j;
    leg->driven = driven;
    leg->chain.motion = driven != NULL ? driven->motion : NULL;
    leg->chain.data = data;
    leg->chain.frame = leg->chain.motion != NULL ? tree->frames + 12 * driven->platform : NULL;
    leg->base = tree->base[foot];
    leg->sequence = 1;
    leg->reach = WG_C(0.0);
    leg->chain.n = 3;
    for (i = 0; i < 3; ++i) {
        leg->chain.foot[i] = leg->geometry[18 + i] = tree->footholds[3 * foot + i];
    }
    for (j = 0; j < 3; ++j) {
        const int joint = tree->leg[foot][j];
        for (i = 0; i < 3; ++i) {
            leg->chain.axis[j][i] = leg->geometry[6 * j + i] = tree->joints[6 * joint + i];
            leg->chain.point[j][i] = leg->geometry[6 * j + 3 + i] = tree->joints[6 * joint + 3 + i];
        }
        leg->spans[j] = half[joint];
        leg->chain.slides[j] = tree->slides[joint] == 1;
        leg->sequence = 2 * leg->sequence + leg->chain.slides[j];
        WG_NAME(wg_add)(leg->chain.foot, WG_C(-1.0), leg->chain.point[j], arm);
        WG_NAME(wg_cross)(leg->chain.axis[j], arm, swept);
        leg->reach = leg->chain.slides[j] ? leg->reach : WG_MAX(WG_NAME(wg_norm)(swept), leg->reach);
    }
    leg->reach = leg->reach > WG_C(0.0) ? leg->reach : WG_C(1.0);
}

/* The sign of det J, 0 where it is small against the leg's reach. */
static inline int WG_NAME(wg_adapt_sheet)(const struct WG_NAME(wg_adapt_leg) * leg, const struct WG_NAME(wg_motion) * at) {
    WG_REAL minor[3], determinant;
    int j;
    WG_NAME(wg_cross)(at->column[1], at->column[2], minor);
    determinant = WG_NAME(wg_dot)(at->column[0], minor);
    for (j = 0; j < 3; ++j) {
        determinant /= leg->chain.slides[j] ? WG_C(1.0) : leg->reach;
    }
    return !(WG_ABS(determinant) > WG_REGULAR) ? 0 : determinant > WG_C(0.0) ? 1 : -1;
}

/* The sum of squares of joint differences over their units. */
static inline WG_REAL WG_NAME(wg_adapt_distance)(const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL a[3], const WG_REAL b[3]) {
    WG_REAL total = WG_C(0.0);
    int j;
    for (j = 0; j < 3; ++j) {
        total += (a[j] - b[j]) / leg->spans[j] * ((a[j] - b[j]) / leg->spans[j]);
    }
    return total;
}

/* Turning joints by full turns as near to the reference as they come. */
static inline void WG_NAME(wg_adapt_unwound)(const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL row[3], const WG_REAL reference[3],
                                             WG_REAL q[3]) {
    int j;
    for (j = 0; j < 3; ++j) {
        const WG_REAL turns = leg->chain.slides[j] ? WG_C(0.0) : WG_LIBM(rint)((row[j] - reference[j]) / (WG_C(2.0) * WG_PI));
        q[j] = row[j] - WG_C(2.0) * WG_PI * turns;
    }
}

/* All poses at a target, turned back to q = 0: their number. A leg's own function has them in the frame of its platform, near a seed where
 * it does not know them all; where its drives stand in a dead point they hold no foot there, and the pose is INFEASIBLE. */
static inline int WG_NAME(wg_adapt_rows)(const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL target[3], const WG_REAL seed[3],
                                         int somewhere, WG_REAL rows[3 * WG_DRIVEN_ROWS], int32_t status[WG_DRIVEN_ROWS]) {
    const WG_REAL *frame = leg->chain.frame;
    struct WG_NAME(wg_motion) here;
    WG_REAL aim[6], arm[3];
    int i, slots;
    if (leg->chain.motion == NULL) {
        WG_NAME(wg_inverse_general)(leg->geometry, target, leg->sequence, rows, status);
        return WG_NAME(wg_slots_of)(leg->sequence);
    }
    WG_NAME(wg_add)(target, WG_C(-1.0), frame + 9, arm);
    for (i = 0; i < 3; ++i) {
        aim[i] = frame[i] * arm[0] + frame[3 + i] * arm[1] + frame[6 + i] * arm[2];
        aim[3 + i] = seed[i];
    }
    (somewhere ? leg->driven->somewhere : leg->driven->rows)(aim, rows, status, leg->chain.data);
    slots = somewhere ? 1 : leg->driven->slots;
    for (i = 0; i < slots; ++i) {
        if (status[i] == WALKGEN_OK || status[i] == WALKGEN_SINGULAR) {
            WG_NAME(wg_motion_at)(&leg->chain, rows + 3 * i, &here);
            WG_NAME(wg_add)(here.foot, WG_C(-1.0), target, arm);
            status[i] = WG_NAME(wg_norm)(arm) <= WG_REGULAR * leg->reach ? status[i] : WALKGEN_INFEASIBLE;
        }
    }
    return slots;
}

/* Down to rounding. */
static inline int WG_NAME(wg_adapt_there)(const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL aim[3], WG_REAL gap) {
    WG_REAL size = WG_C(0.0);
    int i;
    for (i = 0; i < 3; ++i) {
        size += WG_ABS(leg->chain.foot[i]) + WG_ABS(aim[i]);
    }
    return gap <= WG_C(64.0) * WG_EPSILON * size;
}

/* Of a driven leg, none of whose rows reaches the target: the first row becomes a pose that comes as close as any nearby, from that of the
 * rows and of the reference, or of somewhere else, that is closest. How many rows there are: 1, or 0 where there is no foot. */
static inline int WG_NAME(wg_adapt_nearby)(const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL aim[3], const WG_REAL reference[3],
                                           int slots, WG_REAL rows[3 * WG_DRIVEN_ROWS], int32_t status[WG_DRIVEN_ROWS]) {
    struct WG_NAME(wg_motion) here;
    WG_REAL away[3], tried[3], q[3], least = WG_INFINITY;
    int i;
    for (i = -1; i <= slots; ++i) {
        if (i == slots && (least < WG_INFINITY || !WG_NAME(wg_adapt_rows)(leg, aim, reference, 1, rows, status))) {
            break;
        }
        WG_NAME(wg_adapt_unwound)(leg, i < 0 ? reference : i < slots ? rows + 3 * i : rows, reference, tried);
        WG_NAME(wg_motion_at)(&leg->chain, tried, &here);
        WG_NAME(wg_add)(here.foot, WG_C(-1.0), aim, away);
        if (WG_NAME(wg_norm)(away) < least) {
            least = WG_NAME(wg_norm)(away);
            WG_NAME(wg_add)(tried, WG_C(0.0), tried, q);
        }
    }
    if (!(least < WG_INFINITY)) {
        return 0;
    }
    least = WG_NAME(wg_nearest)(&leg->chain, aim, 3, q);
    WG_NAME(wg_add)(q, WG_C(0.0), q, rows);
    status[0] = WG_NAME(wg_adapt_there)(leg, aim, least) ? WALKGEN_OK : WALKGEN_UNREACHABLE;
    return 1;
}

/* What a foot has to choose from at a target: all rows, or the one nearby of a driven leg that does not reach; how many there are. */
static inline int WG_NAME(wg_adapt_choices)(const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL aim[3], const WG_REAL reference[3],
                                            WG_REAL rows[3 * WG_DRIVEN_ROWS], int32_t status[WG_DRIVEN_ROWS], int *reaching) {
    int i, slots = WG_NAME(wg_adapt_rows)(leg, aim, reference, 0, rows, status);
    *reaching = 0;
    for (i = 0; i < slots; ++i) {
        *reaching |= status[i] == WALKGEN_OK || status[i] == WALKGEN_SINGULAR;
    }
    if (!*reaching && leg->chain.motion != NULL && status[0] != WALKGEN_BAD_INPUT) {
        slots = WG_NAME(wg_adapt_nearby)(leg, aim, reference, slots, rows, status);
        *reaching = slots > 0 && status[0] == WALKGEN_OK;
    }
    return slots;
}

/* The pose of the closed form nearest to a reference: one that reaches the target, a regular one first. 0 where q is no number. */
static inline int WG_NAME(wg_adapt_closed)(const struct WG_NAME(wg_adapt_leg) * leg, const struct WG_NAME(wg_tree_motion) * at,
                                           const WG_REAL target[3], const WG_REAL reference[3], struct WG_NAME(wg_adapt_pose) * pose) {
    struct WG_NAME(wg_motion) here;
    WG_REAL aim[3], rows[3 * WG_DRIVEN_ROWS], q[3], least = WG_INFINITY;
    int32_t status[WG_DRIVEN_ROWS];
    int i, k, rank, slots, reaching, best = 3;
    WG_NAME(wg_tree_moved_back)(at, leg->base, target, aim);
    slots = WG_NAME(wg_adapt_choices)(leg, aim, reference, rows, status, &reaching);
    for (i = 0; i < slots; ++i) {
        WG_REAL distance;
        int sheet;
        if (status[i] == WALKGEN_BAD_INPUT) {
            return 0;
        }
        if (reaching && status[i] != WALKGEN_OK && status[i] != WALKGEN_SINGULAR) {
            continue;
        }
        WG_NAME(wg_adapt_unwound)(leg, rows + 3 * i, reference, q);
        WG_NAME(wg_motion_at)(&leg->chain, q, &here);
        sheet = WG_NAME(wg_adapt_sheet)(leg, &here);
        distance = WG_NAME(wg_adapt_distance)(leg, q, reference);
        rank = sheet == 0;
        if (best == 3 || rank < best || (rank == best && distance < least)) {
            best = rank;
            least = distance;
            pose->sheet = sheet;
            WG_NAME(wg_tree_moved)(at, leg->base, here.foot, pose->gap);
            for (k = 0; k < 3; ++k) {
                pose->q[k] = q[k];
                pose->gap[k] = reaching ? WG_C(0.0) : pose->gap[k] - target[k];
            }
        }
    }
    return best < 3;
}

/* Newton on the foot's position as long as the gap halves: whether it is down to rounding, and where that is. */
static inline int WG_NAME(wg_adapt_newton)(const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL aim[3], WG_REAL q[3],
                                           struct WG_NAME(wg_motion) * here) {
    WG_REAL away[3], step[3], gap;
    int turn;
    WG_NAME(wg_motion_at)(&leg->chain, q, here);
    WG_NAME(wg_add)(here->foot, WG_C(-1.0), aim, away);
    gap = WG_NAME(wg_norm)(away);
    for (turn = 0; turn < 8 && gap > WG_C(0.0); ++turn) {
        const WG_REAL before = gap;
        if (!WG_NAME(wg_exact_step)(here, away, step) || !WG_NAME(wg_try_step)(&leg->chain, aim, step, q, here, away, &gap) ||
            gap > WG_C(0.5) * before) {
            break;
        }
    }
    return WG_NAME(wg_adapt_there)(leg, aim, gap);
}

/* The pose that continues the last one, on its sheet: whether there is one. */
static inline int WG_NAME(wg_adapt_followed)(const struct WG_NAME(wg_adapt_leg) * leg, const struct WG_NAME(wg_tree_motion) * at,
                                             const WG_REAL target[3], const struct WG_NAME(wg_adapt_pose) * last,
                                             struct WG_NAME(wg_adapt_pose) * pose) {
    struct WG_NAME(wg_motion) here;
    WG_REAL aim[3], rows[3 * WG_DRIVEN_ROWS], q[3], most = WG_C(0.0), least = WG_INFINITY;
    int32_t status[WG_DRIVEN_ROWS];
    int i, reached, slots, found = 0;
    WG_NAME(wg_tree_moved_back)(at, leg->base, target, aim);
    *pose = *last;
    pose->gap[0] = pose->gap[1] = pose->gap[2] = WG_C(0.0);
    reached = WG_NAME(wg_adapt_newton)(leg, aim, pose->q, &here);
    for (i = 0; i < 3; ++i) {
        most = WG_MAX(most, WG_ABS(pose->q[i] - last->q[i]) / (leg->chain.slides[i] ? leg->reach : WG_C(1.0)));
    }
    if (reached && most <= WG_C(0.5) && WG_NAME(wg_adapt_sheet)(leg, &here) == last->sheet) {
        return 1;
    }
    slots = WG_NAME(wg_adapt_rows)(leg, aim, last->q, 0, rows, status);
    for (i = 0; i < slots; ++i) {
        WG_NAME(wg_adapt_unwound)(leg, rows + 3 * i, last->q, q);
        WG_NAME(wg_motion_at)(&leg->chain, q, &here);
        if (status[i] == WALKGEN_OK && WG_NAME(wg_adapt_sheet)(leg, &here) == last->sheet &&
            WG_NAME(wg_adapt_distance)(leg, q, last->q) < least) {
            least = WG_NAME(wg_adapt_distance)(leg, q, last->q);
            WG_NAME(wg_add)(q, WG_C(0.0), q, pose->q);
            found = 1;
        }
    }
    return found;
}

#undef WG_REGULAR
#undef WG_LIBM
#endif
