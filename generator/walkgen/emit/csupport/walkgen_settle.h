/* walkgen_settle.h: the stable pose that a tripod slides to on a terrain, and the path; walkgen_math.h explains the macros.
 *
 * From the start, the robot, rigid with its feet on the ground, follows the flow of walkgen_settle_flow.h in steps by the midpoint rule, after
 * each of which its feet are put back on the surface. A step that ends where the robot sticks, or would slide back, is halved: so the path ends
 * where it stops, at full friction, and not beyond.
 */
#include "walkgen_settle_flow.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SETTLE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SETTLE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SETTLE_F64
#define WG_LEAST WG_C(1e-7)
#define WG_TOUCHING WG_C(1e-13)
#define WG_CLOSE WG_C(1e-9)
#else
#define WALKGEN_SETTLE_F32
#define WG_LEAST WG_C(1e-4)
#define WG_TOUCHING WG_C(1e-6)
#define WG_CLOSE WG_C(1e-4)
#endif

/* The ground near a point: its height over the surface along the normal, at least to first order, and there the unit normal and the friction
 * [5]. */
typedef void (*WG_NAME(wg_ground))(const WG_REAL point[3], WG_REAL surface[5], const void *data);

/* Robot, ground and the present pose (rotation by rows, position) with its feet. */
struct WG_NAME(wg_settling) {
    const WG_REAL *centre_of_mass, *weight, *wrench;
    WG_NAME(wg_ground) ground;
    const void *data;
    WG_REAL feet[9], R[3][3], p[3], points[9], normals[9], mu[3], gap[3];
    struct WG_NAME(wg_tripod) slip;
};

/* A point of the robot in the world. */
static inline void WG_NAME(wg_settle_point)(const struct WG_NAME(wg_settling) * settle, const WG_REAL local[3], WG_REAL point[3]) {
    int i;
    for (i = 0; i < 3; ++i) {
        point[i] = WG_NAME(wg_dot)(settle->R[i], local) + settle->p[i];
    }
}

/* Feet, ground and load at the present pose: what wg_slip_read says. */
static inline int WG_NAME(wg_settle_read)(struct WG_NAME(wg_settling) * settle) {
    WG_REAL surface[5], at[3], moment[3], load[6];
    int foot, i;
    for (foot = 0; foot < 3; ++foot) {
        WG_NAME(wg_settle_point)(settle, settle->feet + 3 * foot, settle->points + 3 * foot);
        settle->ground(settle->points + 3 * foot, surface, settle->data);
        settle->gap[foot] = surface[0];
        settle->mu[foot] = surface[4];
        WG_NAME(wg_add)(surface + 1, WG_C(0.0), surface + 1, settle->normals + 3 * foot);
        if (!(surface[4] >= WG_C(0.0) && surface[4] <= WG_HUGE && WG_ABS(surface[0]) <= WG_HUGE)) {
            return -1;
        }
    }
    WG_NAME(wg_settle_point)(settle, settle->centre_of_mass, at);
    WG_NAME(wg_cross)(at, settle->weight, moment);
    for (i = 0; i < 3; ++i) {
        load[i] = settle->weight[i] + settle->wrench[i];
        load[3 + i] = moment[i] + settle->wrench[3 + i];
    }
    return WG_NAME(wg_slip_read)(3, settle->points, settle->normals, load, &settle->slip);
}

/* The pose moved by a twist about the feet's centre in the stance's units. */
static inline void WG_NAME(wg_settle_move)(const WG_REAL twist[6], struct WG_NAME(wg_settling) * settle) {
    const struct WG_NAME(wg_stance) *stance = &settle->slip.stance;
    const WG_REAL angle = WG_NAME(wg_norm)(twist + 3), c = WG_COS(angle), s = WG_SIN(angle);
    WG_REAL axis[3], column[3], arm[3];
    int i, j;
    WG_NAME(wg_add)(settle->p, WG_C(-1.0), stance->centre, arm);
    WG_NAME(wg_add)(twist + 3, angle > WG_C(0.0) ? WG_C(1.0) / angle - WG_C(1.0) : WG_C(0.0), twist + 3, axis);
    WG_NAME(wg_turn)(axis, c, s, arm);
    for (j = 0; j < 3; ++j) {
        settle->p[j] = stance->centre[j] + arm[j] + stance->length * twist[j];
        for (i = 0; i < 3; ++i) {
            column[i] = settle->R[i][j];
        }
        WG_NAME(wg_turn)(axis, c, s, column);
        for (i = 0; i < 3; ++i) {
            settle->R[i][j] = column[i];
        }
    }
}

/* Feet put on the surface by the least twist, Newton; read there. Whether they are: 1, else what wg_settle_read says, or 0. */
static inline int WG_NAME(wg_settle_touch)(struct WG_NAME(wg_settling) * settle) {
    WG_REAL rows[8][9], twist[6];
    int turn, i, j, found = 1;
    for (turn = 0; turn < 20; ++turn) {
        WG_REAL worst = WG_C(0.0);
        found = WG_NAME(wg_settle_read)(settle);
        if (found <= 0) {
            return found;
        }
        for (i = 0; i < 3; ++i) {
            worst = WG_MAX(worst, WG_ABS(settle->gap[i]) / settle->slip.stance.length);
            rows[i][3] = -settle->gap[i] / settle->slip.stance.length;
            for (j = 0; j < 3; ++j) {
                rows[i][j] = WG_NAME(wg_stance_product)(settle->slip.press[i], settle->slip.press[j]);
            }
        }
        if (worst <= WG_TOUCHING || (turn == 19 && worst <= WG_CLOSE)) {
            return 1;
        }
        if (!WG_NAME(wg_slip_eliminate)(3, rows)) {
            return 0;
        }
        for (i = 0; i < 6; ++i) {
            twist[i] = rows[0][3] * settle->slip.press[0][i] + rows[1][3] * settle->slip.press[1][i] + rows[2][3] * settle->slip.press[2][i];
        }
        WG_NAME(wg_settle_move)(twist, settle);
    }
    return 0;
}

/* The twist of the flow, as long as makes the fastest foot go `far`. */
static inline void WG_NAME(wg_settle_twist)(const struct WG_NAME(wg_settling) * settle, WG_REAL far, WG_REAL twist[6]) {
    const struct WG_NAME(wg_tripod) *slip = &settle->slip;
    int i;
    for (i = 0; i < 6; ++i) {
        twist[i] = far * (slip->tau[0] * slip->B[0][i] + slip->tau[1] * slip->B[1][i] + slip->tau[2] * slip->B[2][i]);
    }
}

/* One step by the midpoint rule: 1 where the robot slides on, 0 where it would stick or slide back, less else. */
static inline int WG_NAME(wg_settle_step)(WG_REAL far, struct WG_NAME(wg_settling) * settle) {
    struct WG_NAME(wg_settling) middle = *settle;
    WG_REAL twist[6], next[6];
    int found;
    WG_NAME(wg_settle_twist)(settle, WG_C(0.5) * far, twist);
    middle.slip.normals = middle.normals;
    WG_NAME(wg_settle_move)(twist, &middle);
    found = WG_NAME(wg_settle_touch)(&middle);
    found = found > 0 ? WG_NAME(wg_settle_flow)(middle.mu, &middle.slip) : -1;
    if (found <= 0) {
        return found;
    }
    WG_NAME(wg_settle_twist)(&middle, far, next);
    if (!(WG_NAME(wg_stance_product)(next, twist) > WG_C(0.0))) {
        return 0;
    }
    WG_NAME(wg_settle_move)(next, settle);
    found = WG_NAME(wg_settle_touch)(settle);
    found = found > 0 ? WG_NAME(wg_settle_flow)(settle->mu, &settle->slip) : -1;
    WG_NAME(wg_settle_twist)(settle, far, twist);
    return found > 0 && !(WG_NAME(wg_stance_product)(next, twist) > WG_C(0.0)) ? 0 : found;
}

/* The pose as a homogeneous matrix, 1 last. */
static inline void WG_NAME(wg_settle_pose)(const struct WG_NAME(wg_settling) * settle, WG_REAL pose[16]) {
    int i, j;
    for (i = 0; i < 3; ++i) {
        for (j = 0; j < 3; ++j) {
            pose[4 * i + j] = settle->R[i][j];
        }
        pose[4 * i + 3] = settle->p[i];
        pose[12 + i] = WG_C(0.0);
    }
    pose[15] = WG_C(1.0);
}

/* The three feet among the k of the robot in its platform's frame [k, 3], and the pose at the start; whether there are such feet. */
static inline int WG_NAME(wg_settle_place)(int32_t k, const WG_REAL *points, const int32_t *feet, const WG_REAL *start,
                                           struct WG_NAME(wg_settling) * settle) {
    int i, j;
    for (i = 0; i < 3; ++i) {
        if (feet[i] < 0 || feet[i] >= k) {
            return 0;
        }
        for (j = 0; j < 3; ++j) {
            settle->feet[3 * i + j] = points[3 * feet[i] + j];
            settle->R[i][j] = start[4 * i + j];
        }
        settle->p[i] = start[4 * i + 3];
    }
    return WG_NAME(wg_stance_finite)(start, 16);
}

/* Steps in which the fastest foot goes `far`, or less, until the robot rests: the status. The poses before the last go into path [poses, 4, 4]. */
static inline int32_t WG_NAME(wg_settle_follow)(WG_REAL far, int32_t most_steps, int32_t poses, struct WG_NAME(wg_settling) * settle,
                                                WG_REAL *path, int32_t *steps) {
    struct WG_NAME(wg_settling) next;
    int found = WG_NAME(wg_settle_flow)(settle->mu, &settle->slip);
    if (found <= 0) {
        return found < 0 ? WALKGEN_INFEASIBLE : WALKGEN_OK;
    }
    while (*steps < most_steps) {
        next = *settle;
        next.slip.normals = next.normals;
        found = WG_NAME(wg_settle_step)(far, &next);
        if (found > 0) {
            if (*steps < poses) {
                WG_NAME(wg_settle_pose)(settle, path + 16 * (size_t)*steps);
            }
            *settle = next;
            settle->slip.normals = settle->normals;
            ++*steps;
            continue;
        }
        far *= WG_C(0.5);
        if (far < WG_LEAST) {
            return found < 0 ? WALKGEN_INFEASIBLE : WALKGEN_OK;
        }
    }
    return WALKGEN_NO_CONVERGENCE;
}

/* From start, world_T_platform [4, 4], to the stable pose of a robot on three of its k feet: `feet` are their numbers, points [k, 3] and
 * centre_of_mass [3] are in the platform's frame; under its weight [3] (a force in the world) and a constant wrench [6] (in the world, about its
 * origin), on `ground`, which is given `data`. `step`: how far the fastest foot goes in a step, m, at most a fifth of the feet's root mean square
 * distance from their centre; most_steps of them. normal_forces [3]. path [poses, 4, 4]: the first poses on the way, of `steps` + 1; rows beyond
 * repeat the last. OK where it came to rest; INFEASIBLE where a foot lifted off or left the ground: the last pose before; NO_CONVERGENCE where
 * steps were too few; SINGULAR where feet are on a line; BAD_INPUT; with NaN. */
static inline void WG_NAME(wg_settle)(int32_t k, const WG_REAL *points, const int32_t *feet, const WG_REAL *centre_of_mass,
                                      const WG_REAL *weight, const WG_REAL *wrench, const WG_REAL *start, WG_NAME(wg_ground) ground,
                                      const void *data, WG_REAL step, int32_t most_steps, int32_t poses, WG_REAL *pose,
                                      WG_REAL *normal_forces, WG_REAL *path, int32_t *steps, int32_t *status) {
    struct WG_NAME(wg_settling) settle;
    int32_t row;
    int i, found;
    settle.centre_of_mass = centre_of_mass;
    settle.weight = weight;
    settle.wrench = wrench;
    settle.ground = ground;
    settle.data = data;
    *steps = 0;
    found = step > WG_C(0.0) && step <= WG_HUGE && most_steps >= 0 && WG_NAME(wg_settle_place)(k, points, feet, start, &settle)
                ? WG_NAME(wg_settle_touch)(&settle)
                : -1;
    *status = found < 0 ? WALKGEN_BAD_INPUT : WALKGEN_SINGULAR;
    if (found > 0) {
        const WG_REAL far = WG_MIN(step / settle.slip.stance.length, WG_C(0.2));
        *status = WG_NAME(wg_settle_follow)(far, most_steps, poses, &settle, path, steps);
        WG_NAME(wg_settle_pose)(&settle, pose);
    }
    for (i = 0; i < 16 && found <= 0; ++i) {
        pose[i] = WG_NAN;
    }
    for (i = 0; i < 3; ++i) {
        normal_forces[i] = found > 0 ? settle.slip.N[i] * settle.slip.stance.force : WG_NAN;
    }
    for (row = *steps; row < poses; ++row) {
        for (i = 0; i < 16; ++i) {
            path[16 * (size_t)row + (size_t)i] = pose[i];
        }
    }
}

#undef WG_LEAST
#undef WG_TOUCHING
#undef WG_CLOSE
#endif
