/* walkgen_adapt_descent.h: Newton's descent of wg_adapt on its chain joints; walkgen_math.h explains the macros.
 *
 * Exact derivatives, damped (Levenberg, Marquardt) until Phi falls, in the joints' limits. A step that leaves a leg without a pose, or on
 * another sheet, is one that did not help.
 */
#include "walkgen_adapt_solve.h"
#include "walkgen_adapt_stand.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_DESCENT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_DESCENT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_DESCENT_F64
#else
#define WALKGEN_ADAPT_DESCENT_F32
#endif
#define WG_ROUNDINGS (WG_C(64.0) * WG_EPSILON)

/* Which chain joints may move, by their index: not those whose limit the descent pushes against. Their number. */
static inline int WG_NAME(wg_adapt_free)(const struct WG_NAME(wg_adapt_problem) * problem, const struct WG_NAME(wg_adapt_stand) * stand,
                                         const struct WG_NAME(wg_adapt_slope) * slope, int index[WG_TREE_CHAINS]) {
    int i, count = 0;
    for (i = 0; i < problem->criterion.tree.chains; ++i) {
        const int joint = problem->criterion.tree.chain[i];
        const WG_REAL *limit = problem->limits + 2 * joint;
        const int low = stand->q[joint] <= limit[0] && slope->gradient[i] > WG_C(0.0);
        const int high = stand->q[joint] >= limit[1] && slope->gradient[i] < WG_C(0.0);
        if (limit[0] < limit[1] && !low && !high) {
            index[count++] = i;
        }
    }
    return count;
}

/* The damped Newton step of the free chain joints: whether there is one. */
static inline int WG_NAME(wg_adapt_step)(const struct WG_NAME(wg_adapt_slope) * slope, int count, const int *index, WG_REAL damping,
                                         WG_REAL *step) {
    WG_REAL matrix[WG_TREE_CHAINS][WG_TREE_CHAINS], most = WG_C(0.0);
    int i, k;
    for (i = 0; i < count; ++i) {
        most = WG_MAX(most, slope->diagonal[index[i]]);
    }
    for (i = 0; i < count; ++i) {
        const WG_REAL scale = WG_MAX(slope->diagonal[index[i]], WG_C(1e-3) * most);
        for (k = 0; k <= i; ++k) {
            matrix[i][k] = slope->hessian[index[i]][index[k]];
        }
        matrix[i][i] += damping * (scale > WG_C(0.0) ? scale : WG_C(1.0));
        step[i] = -slope->gradient[index[i]];
    }
    return WG_NAME(wg_adapt_cholesky)(count, matrix, step);
}

/* The chain joints of `after` are those of `stand` and the step, at most a span long and within the limits: by how much Phi should fall. */
static inline WG_REAL WG_NAME(wg_adapt_stepped)(const struct WG_NAME(wg_adapt_problem) * problem, const struct WG_NAME(wg_adapt_stand) * stand,
                                                const struct WG_NAME(wg_adapt_slope) * slope, int count, const int *index, WG_REAL *step,
                                                struct WG_NAME(wg_adapt_stand) * after) {
    WG_REAL longest = WG_C(1.0), expected = WG_C(0.0);
    int i, k;
    for (i = 0; i < count; ++i) {
        longest = WG_MAX(longest, WG_ABS(step[i]) / problem->criterion.half[problem->criterion.tree.chain[index[i]]]);
    }
    *after = *stand;
    for (i = 0; i < count; ++i) {
        const int joint = problem->criterion.tree.chain[index[i]];
        after->q[joint] = WG_NAME(wg_adapt_clamped)(problem, joint, stand->q[joint] + step[i] / longest);
        step[i] = after->q[joint] - stand->q[joint];
    }
    for (i = 0; i < count; ++i) {
        WG_REAL row = slope->gradient[index[i]];
        for (k = 0; k < count; ++k) {
            row += WG_C(0.5) * slope->hessian[index[i]][index[k]] * step[k];
        }
        expected -= row * step[i];
    }
    return expected;
}

/* A stand with less Phi: whether a step finds one; the damping for the next. */
static inline int WG_NAME(wg_adapt_lower)(const struct WG_NAME(wg_adapt_problem) * problem, const struct WG_NAME(wg_adapt_stand) * stand,
                                          const struct WG_NAME(wg_adapt_slope) * slope, int count, const int *index, WG_REAL *damping,
                                          struct WG_NAME(wg_adapt_stand) * after, struct WG_NAME(wg_tree_motion) * at) {
    WG_REAL step[WG_TREE_CHAINS];
    const WG_REAL slack = WG_ROUNDINGS * stand->cost;
    int turn;
    for (turn = 0; turn < 24; ++turn) {
        if (WG_NAME(wg_adapt_step)(slope, count, index, *damping, step)) {
            const WG_REAL expected = WG_NAME(wg_adapt_stepped)(problem, stand, slope, count, index, step, after);
            if (WG_NAME(wg_adapt_stand_at)(problem, stand, after, at) &&
                stand->cost - after->cost >= WG_C(1e-4) * WG_MAX(expected, WG_C(0.0)) - slack) {
                if (stand->cost - after->cost >= WG_C(0.75) * expected - slack) {
                    *damping = *damping > WG_C(1e-5) ? WG_C(0.1) * *damping : WG_C(0.0);
                } else {
                    *damping = WG_MAX(WG_C(4.0) * *damping, WG_C(1e-3));
                }
                return 1;
            }
        }
        *damping = WG_MAX(WG_C(10.0) * *damping, WG_C(1e-3));
    }
    return 0;
}

/* The descent from a regular stand, which becomes the one it ends in: whether Phi is stationary there.
 * Stationary: what is left of the gradient by the chain joints that their limits do not hold is at most 1e-10, or its rounding. A few steps
 * more are taken while they make it smaller. Steps that gain little where Phi becomes steeper lead to a leg's singular pose: after a few
 * the descent ends. */
static inline int WG_NAME(wg_adapt_descend)(const struct WG_NAME(wg_adapt_problem) * problem, struct WG_NAME(wg_adapt_stand) * best) {
    struct WG_NAME(wg_adapt_stand) stand = *best, after = *best;
    struct WG_NAME(wg_adapt_slope) slope;
    struct WG_NAME(wg_tree_motion) at;
    WG_REAL least = WG_INFINITY, damping = WG_C(0.0);
    int index[WG_TREE_CHAINS], turn, i, stationary = 0, polishes = 0, stalls = 0;
    WG_NAME(wg_adapt_motion_at)(problem, stand.q, &at);
    for (turn = 0; turn < 100; ++turn) {
        WG_REAL size = WG_C(0.0), parts = WG_C(0.0);
        int count, steeper;
        WG_NAME(wg_adapt_slope_at)(&problem->criterion, &at, problem->legs, stand.q, &slope);
        count = WG_NAME(wg_adapt_free)(problem, &stand, &slope, index);
        for (i = 0; i < count; ++i) {
            size = WG_HYPOT(size, slope.gradient[index[i]]);
        }
        for (i = 0; i < problem->criterion.tree.chains; ++i) {
            parts = WG_MAX(parts, slope.size[i]);
        }
        steeper = !(size < least);
        if (stationary && steeper) {
            break;
        }
        *best = stand;
        least = size;
        if (size <= WG_MAX(WG_C(1e-10), WG_ROUNDINGS * parts)) {
            stationary = 1;
            ++polishes;
        }
        if (!(size > WG_C(0.0)) || polishes > 4 || !WG_NAME(wg_adapt_lower)(problem, &stand, &slope, count, index, &damping, &after, &at)) {
            break;
        }
        stalls = steeper && stand.cost - after.cost < WG_C(1e-4) * stand.cost ? stalls + 1 : 0;
        if (stalls > 8) {
            break;
        }
        stand = after;
    }
    return stationary;
}

#undef WG_ROUNDINGS
#endif
