/* walkgen_adapt.h: a modular robot adapted to the terrain: chain joints that minimise a criterion, legs by their inverse.
 *
 * Where the start does not let every foot reach its target, the chains first reduce what is missing (walkgen_adapt_approach.h); where
 * that, or the descent (walkgen_adapt_descent.h), ends early, other starts are tried, always the same ones.
 * At most 96 joints, of which 32 of chains, 16 feet, 16 platforms: at most 70 kB of stack in double, 38 kB in float (gcc -O2), and
 * what functions of legs take. walkgen_math.h explains the macros.
 */
#include "walkgen_adapt_approach.h"
#include "walkgen_adapt_descent.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ADAPT_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ADAPT_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ADAPT_F64
#define WG_LIBM(name) name
#define WG_FLAT WG_C(1e-10)
#else
#define WALKGEN_ADAPT_F32
#define WG_LIBM(name) name##f
#define WG_FLAT WG_C(1e-5)
#endif

/* The unit normal of the plane with the least squared distances, upwards; z for fewer than 3 points or points on a line. */
static inline void WG_NAME(wg_plane_normal)(const WG_REAL *points, int count, WG_REAL normal[3]) {
    WG_REAL mean[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, away[3], A[3][3], V[3][3], size = WG_C(0.0);
    int i, j, k, least = 0, most = 0;
    for (i = 0; i < 3 * count; ++i) {
        size = WG_MAX(size, WG_ABS(points[i]));
    }
    size = size > WG_C(0.0) ? size : WG_C(1.0);
    for (i = 0; i < 9; ++i) {
        A[i / 3][i % 3] = WG_C(0.0);
    }
    for (i = 0; i < 3 * count; ++i) {
        mean[i % 3] += points[i] / size / (WG_REAL)count;
    }
    for (i = 0; i < count; ++i) {
        for (j = 0; j < 3; ++j) {
            away[j] = points[3 * i + j] / size - mean[j];
        }
        for (j = 0; j < 9; ++j) {
            A[j / 3][j % 3] += away[j / 3] * away[j % 3];
        }
    }
    WG_NAME(wg_eigen)(3, A, V);
    for (i = 1; i < 3; ++i) {
        least = A[i][i] < A[least][least] ? i : least;
        most = A[i][i] >= A[most][most] ? i : most;
    }
    k = least == most ? least : 3 - least - most;
    for (i = 0; i < 3; ++i) {
        normal[i] = V[2][least] < WG_C(0.0) ? -V[i][least] : V[i][least];
    }
    if (count < 3 || !(A[k][k] > WG_FLAT * A[most][most])) {
        normal[0] = normal[1] = WG_C(0.0);
        normal[2] = WG_C(1.0);
    }
}

/* Unit normals; (0, 0, 0) becomes the normal of the targets' plane. Each platform's mean target, and whether it has feet. */
static inline void WG_NAME(wg_adapt_ground)(const WG_REAL *targets, const WG_REAL *normal, struct WG_NAME(wg_adapt_criterion) * criterion) {
    const struct WG_NAME(wg_tree) *tree = &criterion->tree;
    WG_REAL plane[3], size, length;
    int m, foot, i;
    WG_NAME(wg_plane_normal)(targets, tree->feet, plane);
    for (m = 0; m < tree->platforms; ++m) {
        WG_REAL *unit = criterion->normal[m], *mean = criterion->mean[m];
        size = WG_MAX(WG_MAX(WG_ABS(normal[3 * m]), WG_ABS(normal[3 * m + 1])), WG_ABS(normal[3 * m + 2]));
        for (i = 0; i < 3; ++i) {
            unit[i] = size > WG_C(0.0) ? normal[3 * m + i] / size : plane[i];
            mean[i] = WG_C(0.0);
        }
        length = WG_NAME(wg_norm)(unit);
        criterion->standing[m] = 0;
        for (foot = 0; foot < tree->feet; ++foot) {
            criterion->standing[m] += tree->home[foot] == m;
        }
        for (i = 0; i < 3; ++i) {
            unit[i] /= length;
            for (foot = 0; foot < tree->feet; ++foot) {
                mean[i] += tree->home[foot] == m ? targets[3 * foot + i] / (WG_REAL)criterion->standing[m] : WG_C(0.0);
            }
        }
    }
}

/* The task of these inputs: whether they are one. */
static inline int WG_NAME(wg_adapt_read)(const WG_REAL *geometry, const int32_t *topology, const WG_REAL *limits, const WG_REAL *targets,
                                         const WG_REAL *normal, const WG_REAL *start, const WG_REAL *weights, int32_t nq, int32_t feet,
                                         int32_t platforms, const struct WG_NAME(wg_driven_leg) * driven, const void *data,
                                         struct WG_NAME(wg_adapt_problem) * problem) {
    struct WG_NAME(wg_adapt_criterion) *criterion = &problem->criterion;
    struct WG_NAME(wg_tree) *tree = &criterion->tree;
    int i, foot, fine = WG_NAME(wg_read_tree)(geometry, topology, nq, feet, platforms, tree) && WG_NAME(wg_tree_limits_fit)(limits, nq);
    for (i = 0; fine && i < 3 * feet; ++i) {
        fine = isfinite(targets[i]);
    }
    for (i = 0; fine && i < 3 * platforms; ++i) {
        fine = isfinite(normal[i]);
    }
    for (i = 0; fine && i < 4; ++i) {
        fine = isfinite(weights[i]) && (i == 3 || weights[i] >= WG_C(0.0));
    }
    if (!fine) {
        return 0;
    }
    problem->limits = limits;
    problem->targets = targets;
    for (i = 0; i < 4; ++i) {
        criterion->weights[i] = weights[i];
    }
    for (i = 0; i < nq; ++i) {
        criterion->counted[i] = WG_NAME(wg_tree_range)(limits + 2 * i, tree->slides[i], &criterion->middle[i], &criterion->half[i]);
        problem->reference[i] = isfinite(start[i]) ? start[i] : criterion->middle[i];
    }
    WG_NAME(wg_adapt_ground)(targets, normal, criterion);
    for (foot = 0; foot < feet; ++foot) {
        WG_NAME(wg_adapt_leg_of)(tree, foot, criterion->half, driven == NULL ? NULL : driven + foot, data, &problem->legs[foot]);
        criterion->led[foot] = 0;
        for (i = tree->base[foot]; i >= 0; i = tree->parent[i]) {
            criterion->led[foot] |= limits[2 * i] < limits[2 * i + 1];
        }
    }
    return 1;
}

/* Start number 0 to 7 of the chains: as given, in the middle, twice nearby, then all over their ranges. 0 where it repeats the first. */
static inline int WG_NAME(wg_adapt_start)(const struct WG_NAME(wg_adapt_problem) * problem, int turn, WG_REAL *q) {
    const struct WG_NAME(wg_adapt_criterion) *criterion = &problem->criterion;
    int i, fresh = turn != 1;
    for (i = 0; i < criterion->tree.nq; ++i) {
        q[i] = WG_NAME(wg_adapt_clamped)(problem, i, problem->reference[i]);
    }
    for (i = 0; i < criterion->tree.chains && turn > 0; ++i) {
        const int joint = criterion->tree.chain[i];
        const WG_REAL share = WG_C(0.5) + (WG_REAL)(turn * (i + 1)) * WG_C(0.6180339887498949);
        const WG_REAL radius = turn == 1 ? WG_C(0.0) : turn < 4 ? WG_C(0.1) : WG_C(0.8);
        const WG_REAL base = turn == 2 || turn == 3 ? q[joint] : criterion->middle[joint];
        const WG_REAL aside = radius * criterion->half[joint] * (WG_C(2.0) * (share - WG_LIBM(floor)(share)) - WG_C(1.0));
        const WG_REAL value = WG_NAME(wg_adapt_clamped)(problem, joint, base + aside);
        fresh = fresh || value < q[joint] || value > q[joint];
        q[joint] = value;
    }
    return fresh;
}

/* The best stand of all starts: 0 where Phi is stationary, 1 where every foot reaches its target, 2 else; 3 where there is none. */
static inline int WG_NAME(wg_adapt_search)(const struct WG_NAME(wg_adapt_problem) * problem, struct WG_NAME(wg_adapt_stand) * best) {
    struct WG_NAME(wg_adapt_stand) stand;
    WG_REAL least = WG_INFINITY;
    int turn, least_rank = 3;
    for (turn = 0; turn < 8 && least_rank > 0; ++turn) {
        WG_REAL size = WG_INFINITY;
        int rank = 1;
        if (!WG_NAME(wg_adapt_start)(problem, turn, stand.q) || !WG_NAME(wg_adapt_reach)(problem, &stand)) {
            continue;
        }
        if (WG_NAME(wg_adapt_regular)(problem, &stand)) {
            rank = !WG_NAME(wg_adapt_descend)(problem, &stand);
            size = stand.cost;
        } else if (stand.missed > WG_C(0.0)) {
            rank = 2;
            size = stand.missed;
        }
        if (rank < least_rank || (rank == least_rank && size < least)) {
            least_rank = rank;
            least = size;
            *best = stand;
        }
    }
    return least_rank;
}

/* Joint values q [nq] that put every foot on its target [feet, 3] (root platform's frame) and minimise Phi (walkgen_adapt_criterion.h, its
 * cost) within the chains' limits [nq, 2] (infinite where none). normal: the terrain's at every platform [platforms, 3], (0, 0, 0) for that
 * of the targets' least-squares plane. start: joint values to begin with [nq], the middle of the limits where not finite; legs take the
 * pose nearest to it and follow. weights: w_lim, w_n, w_h, the height h of platforms over their feet. geometry and topology:
 * walkgen_tree.h. driven [feet]: functions of the legs that have some instead of axes, called with data; NULL where none has. OK where Phi is
 * stationary; UNREACHABLE where no tried pose of the chains lets every foot reach its target, which q comes closest to; NO_CONVERGENCE where
 * the descent ended early; BAD_INPUT and NaN, also where the functions have no foot. */
static inline void WG_NAME(wg_adapt)(const WG_REAL *WG_RESTRICT geometry, const int32_t *WG_RESTRICT topology,
                                     const WG_REAL *WG_RESTRICT limits, const WG_REAL *WG_RESTRICT targets,
                                     const WG_REAL *WG_RESTRICT normal, const WG_REAL *WG_RESTRICT start,
                                     const WG_REAL *WG_RESTRICT weights, int32_t nq, int32_t feet, int32_t platforms,
                                     const struct WG_NAME(wg_driven_leg) * driven, const void *data, WG_REAL *WG_RESTRICT q,
                                     int32_t *WG_RESTRICT status, WG_REAL *WG_RESTRICT cost) {
    static const int32_t states[4] = {WALKGEN_OK, WALKGEN_NO_CONVERGENCE, WALKGEN_UNREACHABLE, WALKGEN_BAD_INPUT};
    struct WG_NAME(wg_adapt_problem) problem;
    struct WG_NAME(wg_adapt_stand) best;
    int i, foot;
    *status = WALKGEN_BAD_INPUT;
    *cost = best.cost = WG_NAN;
    if (WG_NAME(wg_adapt_read)(geometry, topology, limits, targets, normal, start, weights, nq, feet, platforms, driven, data,
                               &problem)) {
        *status = states[WG_NAME(wg_adapt_search)(&problem, &best)];
    }
    for (i = 0; i < nq && *status != WALKGEN_BAD_INPUT; ++i) {
        *status = isfinite(best.q[i]) && isfinite(best.cost) ? *status : WALKGEN_BAD_INPUT;
    }
    if (*status == WALKGEN_BAD_INPUT) {
        for (i = 0; i < nq; ++i) {
            q[i] = WG_NAN;
        }
        return;
    }
    for (foot = 0; foot < feet; ++foot) { /* of legs on the root only: what others miss is in the search's answer */
        *status = WG_NAME(wg_dot)(best.legs[foot].gap, best.legs[foot].gap) > WG_C(0.0) ? WALKGEN_UNREACHABLE : *status;
    }
    for (i = 0; i < nq; ++i) {
        q[i] = best.q[i];
    }
    *cost = best.cost;
}

#undef WG_FLAT
#undef WG_LIBM
#endif
