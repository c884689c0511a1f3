/* walkgen_adapt_criterion.h: what a robot that adapts to the terrain minimises, with exact derivatives; walkgen_math.h explains the macros.
 *
 *     Phi = w_lim sum_j ((q_j - mid_j) / half_j)^2 + sum over child platforms: w_n (1 - z . n) + w_h (n . (o - mean of its targets) - h)^2
 *
 * The chain joints c are free, every leg follows: dq_leg/dc = B = -J_leg^-1 J_c, the closed form of the null space N = [1; B]. With
 * lambda = J_leg^-T dPhi/dq_leg the legs' own curvature is -sum_ik (lambda . d2p/dq_i dq_k) N_i N_k, so no third tensor is formed.
 */
#include "walkgen_adapt_legs.h"
#include "walkgen_damped.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_CRITERION_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_CRITERION_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_CRITERION_F64
#else
#define WALKGEN_ADAPT_CRITERION_F32
#endif

/* Weights w_lim, w_n, w_h and the height h; the limits' middle and half, counted where both are finite and apart; unit normals, each
 * platform's mean target and whether it has feet; whether chain joints that may move lead a leg. */
struct WG_NAME(wg_adapt_criterion) {
    struct WG_NAME(wg_tree) tree;
    WG_REAL weights[4], middle[WG_TREE_JOINTS], half[WG_TREE_JOINTS], normal[WG_TREE_PLATFORMS][3], mean[WG_TREE_PLATFORMS][3];
    int counted[WG_TREE_JOINTS], standing[WG_TREE_PLATFORMS], led[WG_TREE_FEET];
};

/* Of Phi by the chain joints: the Hessian's diagonal less curvature too, and the sizes of the gradient's parts. 9 kB (double). */
struct WG_NAME(wg_adapt_slope) {
    WG_REAL gradient[WG_TREE_CHAINS], diagonal[WG_TREE_CHAINS], size[WG_TREE_CHAINS], hessian[WG_TREE_CHAINS][WG_TREE_CHAINS];
};

/* A point or direction that a path's joints move, with its columns; a leg's three come last and follow the others by the rows of `follow`. */
struct WG_NAME(wg_adapt_mover) {
    int chains, joints, joint[WG_TREE_CHAINS + 3];
    WG_REAL column[WG_TREE_CHAINS + 3][3], follow[WG_TREE_CHAINS][3];
};

/* How high a platform's origin stands above its targets, along its normal, and where it is. */
static inline WG_REAL WG_NAME(wg_adapt_height)(const struct WG_NAME(wg_adapt_criterion) * criterion,
                                               const struct WG_NAME(wg_tree_motion) * at, int m, WG_REAL origin[3]) {
    WG_REAL up[3];
    WG_NAME(wg_tree_moved)(at, criterion->tree.carrier[m], criterion->tree.frames + 12 * m + 9, origin);
    WG_NAME(wg_add)(origin, WG_C(-1.0), criterion->mean[m], up);
    return WG_NAME(wg_dot)(criterion->normal[m], up);
}

/* A platform's z axis. */
static inline void WG_NAME(wg_adapt_upright)(const struct WG_NAME(wg_adapt_criterion) * criterion,
                                             const struct WG_NAME(wg_tree_motion) * at, int m, WG_REAL z[3]) {
    const WG_REAL *frame = criterion->tree.frames + 12 * m, column[3] = {frame[2], frame[5], frame[8]};
    WG_NAME(wg_tree_turned)(at, criterion->tree.carrier[m], 0, column, z);
}

/* Phi where the tree stands. */
static inline WG_REAL WG_NAME(wg_adapt_value)(const struct WG_NAME(wg_adapt_criterion) * criterion,
                                              const struct WG_NAME(wg_tree_motion) * at, const WG_REAL *q) {
    WG_REAL total = WG_C(0.0), tilt[3], origin[3];
    int j, m;
    for (j = 0; j < criterion->tree.nq; ++j) {
        const WG_REAL share = criterion->counted[j] ? (q[j] - criterion->middle[j]) / criterion->half[j] : WG_C(0.0);
        total += share * share;
    }
    total *= criterion->weights[0];
    for (m = 1; m < criterion->tree.platforms; ++m) {
        WG_NAME(wg_adapt_upright)(criterion, at, m, tilt);
        WG_NAME(wg_add)(tilt, WG_C(-1.0), criterion->normal[m], tilt);
        total += WG_C(0.5) * criterion->weights[1] * WG_NAME(wg_dot)(tilt, tilt);
        if (criterion->standing[m]) {
            const WG_REAL excess = WG_NAME(wg_adapt_height)(criterion, at, m, origin) - criterion->weights[3];
            total += criterion->weights[2] * excess * excess;
        }
    }
    return total;
}

/* Subtract from the Hessian force . (second derivatives of what the joints move), through the null space. */
static inline void WG_NAME(wg_adapt_bend)(const struct WG_NAME(wg_tree) * tree, const struct WG_NAME(wg_tree_motion) * at,
                                          const struct WG_NAME(wg_adapt_mover) * mover, const WG_REAL force[3],
                                          struct WG_NAME(wg_adapt_slope) * slope) {
    const int chains = mover->chains;
    int i, k, a, b;
    for (i = 0; i < mover->joints; ++i) {
        for (k = i; k < mover->joints && !tree->slides[mover->joint[i]]; ++k) {
            WG_REAL second[3], bent;
            WG_NAME(wg_cross)(at->axis[mover->joint[i]], mover->column[k], second);
            bent = WG_NAME(wg_dot)(force, second);
            for (a = i < chains ? i : 0; a < (i < chains ? i + 1 : chains); ++a) {
                const int row = tree->place[mover->joint[a]];
                const WG_REAL part = i < chains ? bent : bent * mover->follow[a][i - chains];
                for (b = k < chains ? k : 0; b < (k < chains ? k + 1 : chains); ++b) {
                    const int column = tree->place[mover->joint[b]];
                    const WG_REAL share = k < chains ? part : part * mover->follow[b][k - chains];
                    slope->hessian[row][column] -= share;
                    slope->hessian[column][row] -= i < k ? share : WG_C(0.0);
                }
            }
        }
    }
}

/* The same for a leg's own joints at q where a function describes the leg. */
static inline void WG_NAME(wg_adapt_bend_driven)(const struct WG_NAME(wg_tree) * tree, const struct WG_NAME(wg_tree_motion) * at,
                                                 const struct WG_NAME(wg_adapt_mover) * mover, const WG_REAL force[3],
                                                 const struct WG_NAME(wg_adapt_leg) * leg, const WG_REAL q[3],
                                                 struct WG_NAME(wg_adapt_slope) * slope) {
    struct WG_NAME(wg_motion) here;
    WG_REAL own[3];
    int i, a, b;
    if (leg->chain.motion == NULL) {
        return;
    }
    WG_NAME(wg_motion_at)(&leg->chain, q, &here);
    WG_NAME(wg_tree_turned)(at, leg->base, 1, force, own);
    for (i = 0; i < 9; ++i) {
        const int row = i / 3, column = i % 3;
        const WG_REAL bent = WG_NAME(wg_dot)(own, row < column ? here.second[row][column] : here.second[column][row]);
        for (a = 0; a < mover->chains; ++a) {
            for (b = 0; b < mover->chains; ++b) {
                const WG_REAL share = bent * mover->follow[a][row] * mover->follow[b][column];
                slope->hessian[tree->place[mover->joint[a]]][tree->place[mover->joint[b]]] -= share;
            }
        }
    }
}

/* How a leg follows its chain joints where it stands: its Jacobian, row-major, and the mover of its foot. The status says whether the leg
 * is damped: below singular values of epsilon, as walkgen_damped.h says. */
static inline int32_t WG_NAME(wg_adapt_null_space)(const struct WG_NAME(wg_tree) * tree, const struct WG_NAME(wg_tree_motion) * at,
                                                   int foot, WG_REAL epsilon, WG_REAL lambda_max, WG_REAL J[9],
                                                   struct WG_NAME(wg_adapt_mover) * mover) {
    WG_REAL point[3];
    int32_t status = WALKGEN_OK, state;
    int i, a;
    mover->chains = WG_NAME(wg_tree_path)(tree, tree->base[foot], mover->joint);
    mover->joints = mover->chains + 3;
    WG_NAME(wg_tree_moved)(at, tree->leg[foot][2], tree->footholds + 3 * foot, point);
    for (i = 0; i < 3; ++i) {
        mover->joint[mover->chains + i] = tree->leg[foot][i];
    }
    for (a = 0; a < mover->joints; ++a) {
        WG_NAME(wg_tree_column)(tree, at, mover->joint[a], point, mover->column[a]);
    }
    for (i = 0; i < 9; ++i) {
        J[i] = mover->column[mover->chains + i % 3][i / 3];
    }
    for (a = 0; a < mover->chains; ++a) {
        WG_NAME(wg_damped_inverse_3)(J, mover->column[a], epsilon, lambda_max, mover->follow[a], &state);
        status = state == WALKGEN_OK || status == WALKGEN_BAD_INPUT ? status : state;
        for (i = 0; i < 3; ++i) {
            mover->follow[a][i] = -mover->follow[a][i];
        }
    }
    return status;
}

/* Add what a leg's joints contribute through their limits. */
static inline void WG_NAME(wg_adapt_leg_slope)(const struct WG_NAME(wg_adapt_criterion) * criterion,
                                               const struct WG_NAME(wg_tree_motion) * at, const struct WG_NAME(wg_adapt_leg) * leg,
                                               int foot, const WG_REAL *q, const WG_REAL *pull, const WG_REAL *curve,
                                               struct WG_NAME(wg_adapt_slope) * slope) {
    const struct WG_NAME(wg_tree) *tree = &criterion->tree;
    struct WG_NAME(wg_adapt_mover) mover;
    WG_REAL J[9], transposed[9], force[3];
    int32_t status;
    int i, a, b;
    (void)WG_NAME(wg_adapt_null_space)(tree, at, foot, WG_C(0.0), WG_C(0.0), J, &mover);
    for (i = 0; i < 9; ++i) {
        transposed[i] = J[3 * (i % 3) + i / 3];
    }
    WG_NAME(wg_damped_inverse_3)(transposed, pull, WG_C(0.0), WG_C(0.0), force, &status);
    WG_NAME(wg_adapt_bend)(tree, at, &mover, force, slope);
    WG_NAME(wg_adapt_bend_driven)(tree, at, &mover, force, leg, q, slope);
    for (a = 0; a < mover.chains; ++a) {
        const int row = tree->place[mover.joint[a]];
        for (i = 0; i < 3; ++i) {
            slope->gradient[row] += mover.follow[a][i] * pull[i];
            slope->size[row] += WG_ABS(mover.follow[a][i] * pull[i]);
            slope->diagonal[row] += curve[i] * mover.follow[a][i] * mover.follow[a][i];
            for (b = 0; b < mover.chains; ++b) {
                slope->hessian[row][tree->place[mover.joint[b]]] += mover.follow[a][i] * curve[i] * mover.follow[b][i];
            }
        }
    }
}

/* Add what a child platform contributes by its tilt: w_n (1 - z . n). */
static inline void WG_NAME(wg_adapt_tilt_slope)(const struct WG_NAME(wg_adapt_criterion) * criterion,
                                                const struct WG_NAME(wg_tree_motion) * at, int m, struct WG_NAME(wg_adapt_mover) * mover,
                                                struct WG_NAME(wg_adapt_slope) * slope) {
    WG_REAL z[3], force[3];
    int i, a;
    WG_NAME(wg_adapt_upright)(criterion, at, m, z);
    for (i = 0; i < 3; ++i) {
        force[i] = criterion->weights[1] * criterion->normal[m][i];
    }
    for (a = 0; a < mover->chains; ++a) {
        const int joint = mover->joint[a], row = criterion->tree.place[joint];
        WG_REAL *column = mover->column[a];
        WG_NAME(wg_cross)(at->axis[joint], z, column);
        for (i = 0; i < 3; ++i) {
            column[i] = criterion->tree.slides[joint] ? WG_C(0.0) : column[i];
        }
        slope->gradient[row] -= WG_NAME(wg_dot)(force, column);
        slope->size[row] += WG_ABS(WG_NAME(wg_dot)(force, column));
        slope->diagonal[row] += criterion->weights[1] * WG_NAME(wg_dot)(column, column);
    }
    WG_NAME(wg_adapt_bend)(&criterion->tree, at, mover, force, slope);
}

/* Add what it contributes by its height: w_h (n . (o - mean) - h)^2. */
static inline void WG_NAME(wg_adapt_height_slope)(const struct WG_NAME(wg_adapt_criterion) * criterion,
                                                  const struct WG_NAME(wg_tree_motion) * at, int m, struct WG_NAME(wg_adapt_mover) * mover,
                                                  struct WG_NAME(wg_adapt_slope) * slope) {
    WG_REAL origin[3], force[3], rise[WG_TREE_CHAINS];
    const WG_REAL excess = WG_NAME(wg_adapt_height)(criterion, at, m, origin) - criterion->weights[3];
    const WG_REAL curve = WG_C(2.0) * criterion->weights[2];
    int i, a, b;
    for (i = 0; i < 3; ++i) {
        force[i] = -curve * excess * criterion->normal[m][i];
    }
    for (a = 0; a < mover->chains; ++a) {
        const int row = criterion->tree.place[mover->joint[a]];
        WG_NAME(wg_tree_column)(&criterion->tree, at, mover->joint[a], origin, mover->column[a]);
        rise[a] = WG_NAME(wg_dot)(criterion->normal[m], mover->column[a]);
        slope->gradient[row] += curve * excess * rise[a];
        slope->size[row] += WG_ABS(curve * excess * rise[a]);
        slope->diagonal[row] += curve * rise[a] * rise[a];
        for (b = 0; b <= a; ++b) {
            const int column = criterion->tree.place[mover->joint[b]];
            slope->hessian[row][column] += curve * rise[a] * rise[b];
            slope->hessian[column][row] += b < a ? curve * rise[a] * rise[b] : WG_C(0.0);
        }
    }
    WG_NAME(wg_adapt_bend)(&criterion->tree, at, mover, force, slope);
}

/* Exact first and second derivatives; no leg that chains lead stands in a singular pose. */
static inline void WG_NAME(wg_adapt_slope_at)(const struct WG_NAME(wg_adapt_criterion) * criterion,
                                              const struct WG_NAME(wg_tree_motion) * at, const struct WG_NAME(wg_adapt_leg) * legs,
                                              const WG_REAL *q, struct WG_NAME(wg_adapt_slope) * slope) {
    const struct WG_NAME(wg_tree) *tree = &criterion->tree;
    struct WG_NAME(wg_adapt_mover) mover;
    WG_REAL pull[WG_TREE_JOINTS], curve[WG_TREE_JOINTS];
    int i, j, foot, m;
    for (j = 0; j < tree->nq; ++j) {
        curve[j] = criterion->counted[j] ? WG_C(2.0) * criterion->weights[0] / (criterion->half[j] * criterion->half[j]) : WG_C(0.0);
        pull[j] = curve[j] * (q[j] - criterion->middle[j]);
    }
    for (i = 0; i < tree->chains; ++i) {
        slope->gradient[i] = pull[tree->chain[i]];
        slope->size[i] = WG_ABS(slope->gradient[i]);
        slope->diagonal[i] = curve[tree->chain[i]];
        for (j = 0; j < tree->chains; ++j) {
            slope->hessian[i][j] = i == j ? slope->diagonal[i] : WG_C(0.0);
        }
    }
    for (foot = 0; foot < tree->feet; ++foot) {
        WG_REAL own[3], own_pull[3], own_curve[3];
        for (i = 0; i < 3; ++i) {
            own[i] = q[tree->leg[foot][i]];
            own_pull[i] = pull[tree->leg[foot][i]];
            own_curve[i] = curve[tree->leg[foot][i]];
        }
        if (criterion->led[foot]) {
            WG_NAME(wg_adapt_leg_slope)(criterion, at, legs + foot, foot, own, own_pull, own_curve, slope);
        }
    }
    for (m = 1; m < tree->platforms; ++m) {
        mover.chains = mover.joints = WG_NAME(wg_tree_path)(tree, tree->carrier[m], mover.joint);
        WG_NAME(wg_adapt_tilt_slope)(criterion, at, m, &mover, slope);
        if (criterion->standing[m]) {
            WG_NAME(wg_adapt_height_slope)(criterion, at, m, &mover, slope);
        }
    }
}

#endif
