/* walkgen_adapt_stand.h: a robot whose feet stand on their targets while its chain joints move: what wg_adapt compares. */
#include "walkgen_adapt_criterion.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_STAND_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_STAND_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_STAND_F64
#else
#define WALKGEN_ADAPT_STAND_F32
#endif

/* One task. half (of the criterion) is the unit of every joint's distance; reference: what legs stay near to, and where the chains start;
 * free: whether a chain joint's limits are apart. 15 kB (double). */
struct WG_NAME(wg_adapt_problem) {
    struct WG_NAME(wg_adapt_criterion) criterion;
    struct WG_NAME(wg_adapt_leg) legs[WG_TREE_FEET];
    const WG_REAL *limits, *targets;
    WG_REAL reference[WG_TREE_JOINTS];
};

/* Joint values, the legs' poses, Phi, and what led legs miss: the sum of their squared gaps. 2 kB (double). */
struct WG_NAME(wg_adapt_stand) {
    WG_REAL q[WG_TREE_JOINTS], cost, missed;
    struct WG_NAME(wg_adapt_pose) legs[WG_TREE_FEET];
};

/* A joint value within its limits. */
static inline WG_REAL WG_NAME(wg_adapt_clamped)(const struct WG_NAME(wg_adapt_problem) * problem, int joint, WG_REAL q) {
    return WG_MIN(WG_MAX(q, problem->limits[2 * joint]), problem->limits[2 * joint + 1]);
}

/* The tree at q; feet of driven legs are moved as their functions say. */
static inline void WG_NAME(wg_adapt_motion_at)(const struct WG_NAME(wg_adapt_problem) * problem, const WG_REAL *q,
                                               struct WG_NAME(wg_tree_motion) * at) {
    const struct WG_NAME(wg_tree) *tree = &problem->criterion.tree;
    int foot, i;
    WG_NAME(wg_tree_motion_at)(tree, q, at);
    for (foot = 0; foot < tree->feet; ++foot) {
        const int *joint = tree->leg[foot];
        struct WG_NAME(wg_motion) here;
        WG_REAL own[3], hung[3];
        if (problem->legs[foot].chain.motion == NULL) {
            continue;
        }
        for (i = 0; i < 3; ++i) {
            own[i] = q[joint[i]];
        }
        WG_NAME(wg_motion_at)(&problem->legs[foot].chain, own, &here);
        for (i = 0; i < 3; ++i) {
            WG_NAME(wg_tree_turned)(at, tree->base[foot], 0, here.column[i], at->axis[joint[i]]);
        }
        WG_NAME(wg_tree_turned)(at, joint[2], 0, tree->footholds + 3 * foot, hung);
        WG_NAME(wg_tree_moved)(at, tree->base[foot], here.foot, at->shift[joint[2]]);
        WG_NAME(wg_add)(at->shift[joint[2]], WG_C(-1.0), hung, at->shift[joint[2]]);
    }
}

/* Whether every led leg reaches its target and has an inverse of its Jacobian. */
static inline int WG_NAME(wg_adapt_regular)(const struct WG_NAME(wg_adapt_problem) * problem, const struct WG_NAME(wg_adapt_stand) * stand) {
    int foot, regular = !(stand->missed > WG_C(0.0));
    for (foot = 0; foot < problem->criterion.tree.feet; ++foot) {
        regular = regular && (stand->legs[foot].sheet != 0 || !problem->criterion.led[foot]);
    }
    return regular;
}

/* Fill the stand, whose chain joints are in stand->q, with legs continued from the last one, or nearest to the reference where there is none
 * (NULL); the motion there. 0 where the legs cannot follow. */
static inline int WG_NAME(wg_adapt_stand_at)(const struct WG_NAME(wg_adapt_problem) * problem, const struct WG_NAME(wg_adapt_stand) * last,
                                             struct WG_NAME(wg_adapt_stand) * stand, struct WG_NAME(wg_tree_motion) * at) {
    const struct WG_NAME(wg_tree) *tree = &problem->criterion.tree;
    int foot, i;
    WG_NAME(wg_tree_motion_at)(tree, stand->q, at);
    stand->missed = WG_C(0.0);
    for (foot = 0; foot < tree->feet; ++foot) {
        const WG_REAL *target = problem->targets + 3 * foot;
        struct WG_NAME(wg_adapt_pose) *pose = &stand->legs[foot];
        WG_REAL reference[3];
        for (i = 0; i < 3; ++i) {
            reference[i] = problem->reference[tree->leg[foot][i]];
        }
        if (last != NULL && !problem->criterion.led[foot]) {
            *pose = last->legs[foot];
        } else if (!(last == NULL ? WG_NAME(wg_adapt_closed)(&problem->legs[foot], at, target, reference, pose)
                                  : WG_NAME(wg_adapt_followed)(&problem->legs[foot], at, target, &last->legs[foot], pose))) {
            return 0;
        }
        for (i = 0; i < 3; ++i) {
            stand->q[tree->leg[foot][i]] = pose->q[i];
        }
        stand->missed += problem->criterion.led[foot] ? WG_NAME(wg_dot)(pose->gap, pose->gap) : WG_C(0.0);
    }
    WG_NAME(wg_adapt_motion_at)(problem, stand->q, at);
    stand->cost = WG_NAME(wg_adapt_value)(&problem->criterion, at, stand->q);
    return 1;
}

#endif
