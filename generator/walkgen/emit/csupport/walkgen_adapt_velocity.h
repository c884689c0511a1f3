/* walkgen_adapt_velocity.h: joint rates of a modular robot whose feet move as asked; walkgen_math.h explains the macros.
 *
 * The chain joints' rates cd are free, every leg follows: qd = qd_p + N cd with qd_p = (0, J_leg^-1 xd) and N = [1; -J_leg^-1 J_c]. The
 * least |qd - qd0| weighted by W = diag(1 / half^2) is where (N^T W N) cd = N^T W (qd0 - qd_p), a matrix as small as the chains are few.
 * At most 44 kB of stack in double, 24 kB in float (gcc -O2).
 */
#include "walkgen_adapt_criterion.h"
#include "walkgen_adapt_solve.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_VELOCITY_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_VELOCITY_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_VELOCITY_F64
#else
#define WALKGEN_ADAPT_VELOCITY_F32
#endif

/* The equations in cd, and the rates of legs whose chains stand still. */
struct WG_NAME(wg_adapt_rates) {
    WG_REAL matrix[WG_TREE_CHAINS][WG_TREE_CHAINS], rhs[WG_TREE_CHAINS], own[WG_TREE_FEET][3], follow[WG_TREE_FEET][WG_TREE_CHAINS][3];
};

/* Add a leg's part to the equations: its status. */
static inline int32_t WG_NAME(wg_adapt_leg_rates)(const struct WG_NAME(wg_tree) * tree, const struct WG_NAME(wg_tree_motion) * at, int foot,
                                                  const WG_REAL *weight, const WG_REAL *xd, const WG_REAL *qd0, const WG_REAL bounds[2],
                                                  struct WG_NAME(wg_adapt_rates) * rates) {
    struct WG_NAME(wg_adapt_mover) mover;
    WG_REAL J[9];
    int32_t state, status = WG_NAME(wg_adapt_null_space)(tree, at, foot, bounds[0], bounds[1], J, &mover);
    int i, a, b;
    WG_NAME(wg_damped_inverse_3)(J, xd + 3 * foot, bounds[0], bounds[1], rates->own[foot], &state);
    status = state == WALKGEN_OK || status == WALKGEN_BAD_INPUT ? status : state;
    for (a = 0; a < mover.chains; ++a) {
        const int row = tree->place[mover.joint[a]];
        for (i = 0; i < 3; ++i) {
            const int joint = tree->leg[foot][i];
            const WG_REAL part = weight[joint] * mover.follow[a][i];
            rates->follow[foot][row][i] = mover.follow[a][i];
            rates->rhs[row] += part * (qd0[joint] - rates->own[foot][i]);
            for (b = 0; b < mover.chains; ++b) {
                rates->matrix[row][tree->place[mover.joint[b]]] += part * mover.follow[b][i];
            }
        }
    }
    return status;
}

/* The equations without joints whose limits are equal, solved: every chain joint's rate [nc], 0 for those. Whether they could be. */
static inline int WG_NAME(wg_adapt_chain_rates)(const struct WG_NAME(wg_tree) * tree, const WG_REAL *limits,
                                                struct WG_NAME(wg_adapt_rates) * rates, WG_REAL *cd) {
    WG_REAL x[WG_TREE_CHAINS];
    int index[WG_TREE_CHAINS], i, k, count = 0, solved;
    for (i = 0; i < tree->chains; ++i) {
        cd[i] = WG_C(0.0);
        if (limits[2 * tree->chain[i]] < limits[2 * tree->chain[i] + 1]) {
            index[count++] = i;
        }
    }
    for (i = 0; i < count; ++i) {
        x[i] = rates->rhs[index[i]];
        for (k = 0; k <= i; ++k) { /* upwards, so nothing is read that was written */
            rates->matrix[i][k] = rates->matrix[index[i]][index[k]];
        }
    }
    solved = WG_NAME(wg_adapt_cholesky)(count, rates->matrix, x);
    for (i = 0; i < count && solved; ++i) {
        cd[index[i]] = x[i];
    }
    return solved;
}

/* The equations of a tree without legs: each chain joint as wanted. */
static inline void WG_NAME(wg_adapt_no_legs)(const struct WG_NAME(wg_tree) * tree, const WG_REAL *weight, const WG_REAL *qd0,
                                             struct WG_NAME(wg_adapt_rates) * rates) {
    int i, k, foot;
    for (i = 0; i < tree->chains; ++i) {
        rates->rhs[i] = weight[tree->chain[i]] * qd0[tree->chain[i]];
        for (k = 0; k < tree->chains; ++k) {
            rates->matrix[i][k] = i == k ? weight[tree->chain[i]] : WG_C(0.0);
        }
        for (foot = 0; foot < tree->feet; ++foot) {
            rates->follow[foot][i][0] = rates->follow[foot][i][1] = rates->follow[foot][i][2] = WG_C(0.0);
        }
    }
}

/* The rates for a tree and finite inputs: a status. */
static inline int32_t WG_NAME(wg_adapt_resolve)(const struct WG_NAME(wg_tree) * tree, const WG_REAL *limits, const WG_REAL *q,
                                                const WG_REAL *xd, const WG_REAL *qd0, const WG_REAL bounds[2], WG_REAL *qd) {
    struct WG_NAME(wg_adapt_rates) rates;
    struct WG_NAME(wg_tree_motion) at;
    WG_REAL weight[WG_TREE_JOINTS], cd[WG_TREE_CHAINS], middle, half;
    int32_t status = WALKGEN_OK;
    int i, j, foot;
    WG_NAME(wg_tree_motion_at)(tree, q, &at);
    for (j = 0; j < tree->nq; ++j) {
        (void)WG_NAME(wg_tree_range)(limits + 2 * j, tree->slides[j], &middle, &half);
        weight[j] = WG_C(1.0) / half / half;
    }
    WG_NAME(wg_adapt_no_legs)(tree, weight, qd0, &rates);
    for (foot = 0; foot < tree->feet; ++foot) {
        const int32_t state = WG_NAME(wg_adapt_leg_rates)(tree, &at, foot, weight, xd, qd0, bounds, &rates);
        status = state == WALKGEN_OK || status == WALKGEN_BAD_INPUT ? status : state;
    }
    if (status == WALKGEN_BAD_INPUT || !WG_NAME(wg_adapt_chain_rates)(tree, limits, &rates, cd)) {
        return WALKGEN_BAD_INPUT;
    }
    for (i = 0; i < tree->chains; ++i) {
        qd[tree->chain[i]] = cd[i];
    }
    for (foot = 0; foot < tree->feet; ++foot) {
        for (j = 0; j < 3; ++j) {
            WG_REAL rate = rates.own[foot][j];
            for (i = 0; i < tree->chains; ++i) {
                rate += rates.follow[foot][i][j] * cd[i];
            }
            qd[tree->leg[foot][j]] = rate;
        }
    }
    return status;
}

/* Rates qd [nq] with J qd = xd [feet, 3], m/s in the root platform's frame, and the least |qd - qd0| weighted by 1 / half^2, half a joint's
 * range in limits [nq, 2] (pi or 1 m where it has none). A chain joint whose limits are equal stands still. geometry and topology:
 * walkgen_tree.h. OK; SINGULAR where the least singular value of a leg's Jacobian is below epsilon: it is damped up to lambda_max as
 * walkgen_damped.h says, its foot is slower than asked; BAD_INPUT and NaN. */
static inline void WG_NAME(wg_adapt_velocity)(const WG_REAL *WG_RESTRICT geometry, const int32_t *WG_RESTRICT topology,
                                              const WG_REAL *WG_RESTRICT limits, const WG_REAL *WG_RESTRICT q,
                                              const WG_REAL *WG_RESTRICT xd, const WG_REAL *WG_RESTRICT qd0, WG_REAL epsilon,
                                              WG_REAL lambda_max, int32_t nq, int32_t feet, int32_t platforms, WG_REAL *WG_RESTRICT qd,
                                              int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_tree) tree;
    const WG_REAL bounds[2] = {epsilon, lambda_max};
    int i, fine = WG_NAME(wg_read_tree)(geometry, topology, nq, feet, platforms, &tree) && WG_NAME(wg_tree_limits_fit)(limits, nq);
    for (i = 0; fine && i < nq; ++i) {
        fine = isfinite(q[i]) && isfinite(qd0[i]);
    }
    for (i = 0; fine && i < 3 * feet; ++i) {
        fine = isfinite(xd[i]);
    }
    *status = fine ? WG_NAME(wg_adapt_resolve)(&tree, limits, q, xd, qd0, bounds, qd) : WALKGEN_BAD_INPUT;
    for (i = 0; fine && i < nq && *status != WALKGEN_BAD_INPUT; ++i) {
        *status = isfinite(qd[i]) ? *status : WALKGEN_BAD_INPUT;
    }
    for (i = 0; i < nq && *status == WALKGEN_BAD_INPUT; ++i) {
        qd[i] = WG_NAN;
    }
}

#endif
