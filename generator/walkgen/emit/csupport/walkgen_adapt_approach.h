/* walkgen_adapt_approach.h: chain joints that bring feet to their targets, or as near as their limits let them.
 *
 * Gauss-Newton on the distances of the legs' closest poses, damped (Levenberg, Marquardt) until they fall; walkgen_math.h explains the
 * macros.
 */
#include "walkgen_adapt_solve.h"
#include "walkgen_adapt_stand.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_APPROACH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_APPROACH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_APPROACH_F64
#else
#define WALKGEN_ADAPT_APPROACH_F32
#endif

/* Add a missing foot's part to the equations of wg_adapt_approach: its distance's gradient is gap . J_c / |gap|; sideways the closest pose
 * follows, as on a sphere of the leg's reach. */
static inline void WG_NAME(wg_adapt_pull)(const struct WG_NAME(wg_adapt_problem) * problem, const struct WG_NAME(wg_adapt_stand) * stand,
                                          int foot, const struct WG_NAME(wg_tree_motion) * at,
                                          WG_REAL matrix[WG_TREE_CHAINS][WG_TREE_CHAINS], WG_REAL *step) {
    const struct WG_NAME(wg_tree) *tree = &problem->criterion.tree;
    const WG_REAL *gap = stand->legs[foot].gap, distance = WG_NAME(wg_norm)(gap), reach = problem->legs[foot].reach;
    const WG_REAL share = distance / (distance + reach);
    WG_REAL row[WG_TREE_CHAINS], shift[WG_TREE_CHAINS][3], point[3];
    int path[WG_TREE_CHAINS], a, b;
    const int count = WG_NAME(wg_tree_path)(tree, tree->base[foot], path);
    WG_NAME(wg_tree_moved)(at, tree->leg[foot][2], tree->footholds + 3 * foot, point);
    for (a = 0; a < count; ++a) {
        WG_NAME(wg_tree_column)(tree, at, path[a], point, shift[a]);
        for (b = 0; b < 3; ++b) {
            shift[a][b] *= problem->criterion.half[path[a]] / reach;
        }
        row[a] = WG_NAME(wg_dot)(gap, shift[a]) / distance;
    }
    for (a = 0; a < count; ++a) {
        step[tree->place[path[a]]] -= row[a] * (distance / reach + WG_C(0.01));
        for (b = 0; b < count; ++b) {
            const WG_REAL part = share * WG_NAME(wg_dot)(shift[a], shift[b]) + (WG_C(1.0) - share) * row[a] * row[b];
            matrix[tree->place[path[a]]][tree->place[path[b]]] += part;
        }
    }
}

/* A step of the chains that brings missing feet to their targets and a little beyond, but not beyond limits. The chain joints of `other`
 * become those after it. */
static inline void WG_NAME(wg_adapt_approach)(const struct WG_NAME(wg_adapt_problem) * problem, const struct WG_NAME(wg_adapt_stand) * stand,
                                              WG_REAL damping, struct WG_NAME(wg_tree_motion) * at, struct WG_NAME(wg_adapt_stand) * other) {
    const struct WG_NAME(wg_tree) *tree = &problem->criterion.tree;
    WG_REAL matrix[WG_TREE_CHAINS][WG_TREE_CHAINS], step[WG_TREE_CHAINS];
    int foot, a, b;
    for (a = 0; a < tree->chains; ++a) {
        step[a] = WG_C(0.0);
        for (b = 0; b < tree->chains; ++b) {
            matrix[a][b] = a == b ? damping : WG_C(0.0);
        }
    }
    WG_NAME(wg_adapt_motion_at)(problem, stand->q, at);
    for (foot = 0; foot < tree->feet; ++foot) {
        const WG_REAL *gap = stand->legs[foot].gap;
        if (problem->criterion.led[foot] && WG_NAME(wg_norm)(gap) > WG_C(0.0)) {
            WG_NAME(wg_adapt_pull)(problem, stand, foot, at, matrix, step);
        }
    }
    for (a = 0; a < tree->chains; ++a) {
        const WG_REAL q = stand->q[tree->chain[a]], *limit = problem->limits + 2 * tree->chain[a];
        if ((q <= limit[0] && step[a] < WG_C(0.0)) || (q >= limit[1] && step[a] > WG_C(0.0))) { /* it stays at its limit */
            step[a] = WG_C(0.0);
            for (b = 0; b < tree->chains; ++b) {
                matrix[a][b] = matrix[b][a] = a == b ? damping : WG_C(0.0);
            }
        }
    }
    *other = *stand;
    if (WG_NAME(wg_adapt_cholesky)(tree->chains, matrix, step)) {
        for (a = 0; a < tree->chains; ++a) {
            const int joint = tree->chain[a];
            other->q[joint] = WG_NAME(wg_adapt_clamped)(problem, joint, stand->q[joint] + problem->criterion.half[joint] * step[a]);
        }
    }
}

/* How many steps of the chains are tried: more where what a leg misses is only about as far as its function tells. */
static inline int WG_NAME(wg_adapt_approaches)(const struct WG_NAME(wg_adapt_problem) * problem) {
    int foot, most = 15;
    for (foot = 0; foot < problem->criterion.tree.feet; ++foot) {
        most = problem->legs[foot].chain.motion != NULL ? 60 : most;
    }
    return most;
}

/* A stand from these chain joints on in which every led foot reaches its target, or one that misses no more than the first. 0 where a
 * leg's pose is no number. */
static inline int WG_NAME(wg_adapt_reach)(const struct WG_NAME(wg_adapt_problem) * problem, struct WG_NAME(wg_adapt_stand) * stand) {
    struct WG_NAME(wg_adapt_stand) other;
    struct WG_NAME(wg_tree_motion) at;
    WG_REAL damping = WG_C(0.01);
    const int most = WG_NAME(wg_adapt_approaches)(problem);
    int turn, worse = 0;
    if (!WG_NAME(wg_adapt_stand_at)(problem, NULL, stand, &at)) {
        return 0;
    }
    for (turn = 0; turn < most && worse < 15 && stand->missed > WG_C(0.0); ++turn) {
        WG_NAME(wg_adapt_approach)(problem, stand, damping, &at, &other);
        if (WG_NAME(wg_adapt_stand_at)(problem, NULL, &other, &at) && other.missed < stand->missed) {
            *stand = other;
            damping *= WG_C(0.25);
            worse = 0;
        } else {
            damping *= WG_C(4.0);
            ++worse;
        }
    }
    return 1;
}

#endif
