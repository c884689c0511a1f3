/* walkgen_tree.h: a whole robot as a tree of joints: how its platforms, feet and axes move; walkgen_math.h explains the macros.
 *
 * geometry: for every joint its unit axis and a point on it, then every foot [3], then every platform's rotation [9] and origin [3], all at
 * q = 0 in the root platform's frame. topology: every joint's parent, every joint's kind (1 slides), every foot's last joint, every
 * platform's last joint; -1 is the root platform. The last three joints of a foot's path are its leg; all others are chain joints.
 * Joints of a leg that is no chain of axes, of kind 1 or, where q is an angle, 2, slide in the columns of its foot's Jacobian.
 * At most 96 joints, of which 32 of chains, 16 feet and 16 platforms: struct wg_tree takes 1.1 kB, struct wg_tree_motion 14 kB (double).
 */
#include "walkgen_spatial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_TREE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_TREE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_TREE_F64
#else
#define WALKGEN_TREE_F32
#endif
#ifndef WG_TREE_JOINTS
#define WG_TREE_JOINTS 96
#define WG_TREE_CHAINS 32
#define WG_TREE_FEET 16
#define WG_TREE_PLATFORMS 16
#endif

/* What hangs on what. order: parents first; chain: the chain joints in the order of q; place: a chain joint's index there, -1 for a leg's;
 * leg: a foot's last three joints; base: the joint that carries the leg; home: the platform nearest to it on its path, -1 for none. */
struct WG_NAME(wg_tree) {
    int nq, feet, platforms, chains;
    const WG_REAL *joints, *footholds, *frames;
    const int32_t *parent, *slides, *last, *carrier;
    int order[WG_TREE_JOINTS], chain[WG_TREE_CHAINS], place[WG_TREE_JOINTS];
    int leg[WG_TREE_FEET][3], base[WG_TREE_FEET], home[WG_TREE_FEET];
};

/* Where q takes the tree: what a joint carries is turned and shifted; its axis and a point on it. */
struct WG_NAME(wg_tree_motion) {
    WG_REAL turn[WG_TREE_JOINTS][9], shift[WG_TREE_JOINTS][3], axis[WG_TREE_JOINTS][3], point[WG_TREE_JOINTS][3];
};

/* All joints, parents first: whether they are a tree. */
static inline int WG_NAME(wg_tree_sort)(struct WG_NAME(wg_tree) * tree) {
    int placed[WG_TREE_JOINTS], sweep, j, count = 0;
    for (j = 0; j < tree->nq; ++j) {
        placed[j] = 0;
        if (tree->parent[j] < -1 || tree->parent[j] >= tree->nq || tree->slides[j] < 0 || tree->slides[j] > 2) {
            return 0;
        }
    }
    for (sweep = 0; sweep < tree->nq && count < tree->nq; ++sweep) {
        for (j = 0; j < tree->nq; ++j) {
            if (!placed[j] && (tree->parent[j] < 0 || placed[tree->parent[j]])) {
                placed[j] = 1;
                tree->order[count++] = j;
            }
        }
    }
    return count == tree->nq;
}

/* Legs from their feet: whether each has three joints of its own. `place` becomes -1 for theirs, 0 for others. */
static inline int WG_NAME(wg_tree_legs)(struct WG_NAME(wg_tree) * tree) {
    int foot, i, j;
    for (j = 0; j < tree->nq; ++j) {
        tree->place[j] = 0;
    }
    for (foot = 0; foot < tree->feet; ++foot) {
        j = tree->last[foot];
        for (i = 2; i >= 0; --i) {
            if (j < 0 || j >= tree->nq || tree->place[j] < 0) {
                return 0;
            }
            tree->place[j] = -1;
            tree->leg[foot][i] = j;
            j = tree->parent[j];
        }
        tree->base[foot] = j;
    }
    return 1;
}

/* The platform nearest to a joint on the way to the root, the first of equals; -1 where there is none. */
static inline int WG_NAME(wg_tree_home)(const struct WG_NAME(wg_tree) * tree, int joint) {
    int m, j;
    for (j = joint; j >= -1; j = j < 0 ? -2 : tree->parent[j]) {
        for (m = 0; m < tree->platforms; ++m) {
            if (tree->carrier[m] == j) {
                return m;
            }
        }
    }
    return -1;
}

/* The chain joints: whether they fit, and nothing but a foot hangs on a leg. */
static inline int WG_NAME(wg_tree_chains)(struct WG_NAME(wg_tree) * tree) {
    int i, j;
    tree->chains = 0;
    for (j = 0; j < tree->nq; ++j) {
        if (tree->place[j] < 0) {
            continue;
        }
        if (tree->chains == WG_TREE_CHAINS || tree->slides[j] > 1 || (tree->parent[j] >= 0 && tree->place[tree->parent[j]] < 0)) {
            return 0;
        }
        tree->place[j] = tree->chains;
        tree->chain[tree->chains++] = j;
    }
    for (i = 0; i < tree->feet; ++i) {
        if (tree->base[i] >= 0 && tree->place[tree->base[i]] < 0) {
            return 0;
        }
        tree->home[i] = WG_NAME(wg_tree_home)(tree, tree->base[i]);
    }
    for (i = 0; i < tree->platforms; ++i) {
        if (tree->carrier[i] < -1 || tree->carrier[i] >= tree->nq || (tree->carrier[i] >= 0 && tree->place[tree->carrier[i]] < 0)) {
            return 0;
        }
    }
    return 1;
}

/* The tree of these numbers, which stay where they are: whether they are one. */
static inline int WG_NAME(wg_read_tree)(const WG_REAL *geometry, const int32_t *topology, int32_t nq, int32_t feet, int32_t platforms,
                                        struct WG_NAME(wg_tree) * tree) {
    int i;
    if (nq < 0 || nq > WG_TREE_JOINTS || feet < 0 || feet > WG_TREE_FEET || platforms < 1 || platforms > WG_TREE_PLATFORMS) {
        return 0;
    }
    for (i = 0; i < 6 * nq + 3 * feet + 12 * platforms; ++i) {
        if (!isfinite(geometry[i])) {
            return 0;
        }
    }
    tree->nq = nq;
    tree->feet = feet;
    tree->platforms = platforms;
    tree->joints = geometry;
    tree->footholds = geometry + 6 * nq;
    tree->frames = geometry + 6 * nq + 3 * feet;
    tree->parent = topology;
    tree->slides = topology + nq;
    tree->last = topology + 2 * nq;
    tree->carrier = topology + 2 * nq + feet;
    return WG_NAME(wg_tree_sort)(tree) && WG_NAME(wg_tree_legs)(tree) && WG_NAME(wg_tree_chains)(tree);
}

/* The joints that move what hangs on a chain joint, that joint last: their number, none for the root. */
static inline int WG_NAME(wg_tree_path)(const struct WG_NAME(wg_tree) * tree, int joint, int path[WG_TREE_CHAINS]) {
    int i, j, count = 0;
    for (j = joint; j >= 0; j = tree->parent[j]) {
        ++count;
    }
    for (j = joint, i = count - 1; j >= 0; j = tree->parent[j], --i) {
        path[i] = j;
    }
    return count;
}

/* y = M x or, with `transposed`, M^T x; the vector itself for the root, which has no joint. */
static inline void WG_NAME(wg_tree_turned)(const struct WG_NAME(wg_tree_motion) * at, int joint, int transposed, const WG_REAL x[3],
                                           WG_REAL y[3]) {
    const WG_REAL old[3] = {x[0], x[1], x[2]};
    const int row = transposed ? 1 : 3, column = transposed ? 3 : 1;
    int i;
    for (i = 0; i < 3; ++i) {
        const WG_REAL *M = joint < 0 ? NULL : at->turn[joint] + row * i;
        y[i] = M == NULL ? old[i] : M[0] * old[0] + M[column] * old[1] + M[2 * column] * old[2];
    }
}

/* Where a joint takes a point that it carries, given at q = 0. */
static inline void WG_NAME(wg_tree_moved)(const struct WG_NAME(wg_tree_motion) * at, int joint, const WG_REAL x[3], WG_REAL y[3]) {
    WG_NAME(wg_tree_turned)(at, joint, 0, x, y);
    if (joint >= 0) {
        WG_NAME(wg_add)(y, WG_C(1.0), at->shift[joint], y);
    }
}

/* The point that a joint takes to x. */
static inline void WG_NAME(wg_tree_moved_back)(const struct WG_NAME(wg_tree_motion) * at, int joint, const WG_REAL x[3], WG_REAL y[3]) {
    WG_NAME(wg_add)(x, joint < 0 ? WG_C(0.0) : WG_C(-1.0), joint < 0 ? x : at->shift[joint], y);
    WG_NAME(wg_tree_turned)(at, joint, 1, y, y);
}

/* The tree at q. */
static inline void WG_NAME(wg_tree_motion_at)(const struct WG_NAME(wg_tree) * tree, const WG_REAL *q,
                                              struct WG_NAME(wg_tree_motion) * at) {
    int index, i;
    for (index = 0; index < tree->nq; ++index) {
        const int j = tree->order[index], parent = tree->parent[j];
        const WG_REAL *axis = tree->joints + 6 * j, *point = axis + 3;
        const WG_REAL cosine = WG_COS(q[j]), sine = WG_SIN(q[j]);
        WG_REAL carried[3];
        WG_NAME(wg_tree_turned)(at, parent, 0, axis, at->axis[j]);
        WG_NAME(wg_tree_moved)(at, parent, point, at->point[j]);
        for (i = 0; i < 3; ++i) { /* columns of the rotation: units turned about the axis where it is, after the parent */
            WG_REAL unit[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)};
            unit[i] = WG_C(1.0);
            if (!tree->slides[j]) {
                WG_NAME(wg_turn)(axis, cosine, sine, unit);
            }
            WG_NAME(wg_tree_turned)(at, parent, 0, unit, unit);
            at->turn[j][i] = unit[0];
            at->turn[j][3 + i] = unit[1];
            at->turn[j][6 + i] = unit[2];
        }
        WG_NAME(wg_tree_turned)(at, j, 0, point, carried);
        WG_NAME(wg_add)(at->point[j], WG_C(-1.0), carried, at->shift[j]);
        if (tree->slides[j]) {
            WG_NAME(wg_add)(at->shift[j], q[j], at->axis[j], at->shift[j]);
        }
    }
}

/* How a joint moves a point that it carries, given where it is now. */
static inline void WG_NAME(wg_tree_column)(const struct WG_NAME(wg_tree) * tree, const struct WG_NAME(wg_tree_motion) * at, int joint,
                                           const WG_REAL point[3], WG_REAL column[3]) {
    WG_REAL arm[3];
    if (tree->slides[joint]) {
        WG_NAME(wg_add)(at->axis[joint], WG_C(0.0), at->axis[joint], column);
        return;
    }
    WG_NAME(wg_add)(point, WG_C(-1.0), at->point[joint], arm);
    WG_NAME(wg_cross)(at->axis[joint], arm, column);
}

/* What a joint's limits say: its middle, where one is missing the value in the range nearest to 0; half its range, or pi or 1 m where it
 * has none or it is empty; whether it has one. */
static inline int WG_NAME(wg_tree_range)(const WG_REAL limit[2], int slides, WG_REAL *middle, WG_REAL *half) {
    const int bounded = isfinite(limit[0]) && isfinite(limit[1]), counted = bounded && limit[1] > limit[0];
    const WG_REAL nearest = limit[0] > WG_C(0.0) ? limit[0] : limit[1] < WG_C(0.0) ? limit[1] : WG_C(0.0);
    *middle = bounded ? WG_C(0.5) * limit[0] + WG_C(0.5) * limit[1] : nearest;
    *half = counted ? WG_C(0.5) * limit[1] - WG_C(0.5) * limit[0] : slides == 1 ? WG_C(1.0) : WG_PI;
    return counted;
}

/* Whether every lower limit lies at or below its upper one, with a number between them. */
static inline int WG_NAME(wg_tree_limits_fit)(const WG_REAL *limits, int32_t nq) {
    int j;
    for (j = 0; j < nq; ++j) {
        if (!(limits[2 * j] <= limits[2 * j + 1] && limits[2 * j] < WG_INFINITY && limits[2 * j + 1] > -WG_INFINITY)) {
            return 0;
        }
    }
    return 1;
}

#endif
