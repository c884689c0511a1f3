/* walkgen_poses.h: a leg of one to three joints made canonical, and poses that reach a target; walkgen_math.h explains the macros.
 *
 * Candidates of the elimination, or of a grid for legs of fewer joints, are polished on the foot's position itself. Where none reaches the
 * target, the closest poses are sought from the grid too.
 */
#include "walkgen_elimination.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_POSES_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_POSES_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_POSES_F64
#define WG_LIBM(name) name
#define WG_TOLERANCE WG_C(1e-12)
#else
#define WALKGEN_POSES_F32
#define WG_LIBM(name) name##f
#define WG_TOLERANCE (WG_C(8.0) * WG_EPSILON)
#endif
#ifndef WG_MOST_POSES
#define WG_MOST_POSES 46 /* candidates and grid starts */
#define WG_STARTS 10
#endif

/* Polished poses and how far the foot is from the target in each. */
struct WG_NAME(wg_poses) {
    int count;
    WG_REAL q[WG_MOST_POSES][3], gap[WG_MOST_POSES];
};

/* The chain from its numbers (for every joint axis and point, then the foot), scaled and seen from its first point; 1e-12 of the reach.
 * A target very far from a leg without sliding joints comes nearer: only its direction counts. `size` is the binary exponent taken out. */
static inline WG_REAL WG_NAME(wg_canonical)(const WG_REAL *geometry, const WG_REAL *p, int32_t sequence, struct WG_NAME(wg_chain) * chain,
                                            WG_REAL target[3], int *size) {
    WG_REAL largest = WG_C(0.0), farthest = WG_C(0.0), reach = WG_C(0.0), gap[3];
    const WG_REAL *beyond = chain->foot;
    int i, j, exponent = 0, sliding = 0;
    chain->motion = NULL;
    for (chain->n = 0; sequence >> (chain->n + 1) > 0; ++chain->n) {
    }
    for (j = 0; j < 3; ++j) {
        chain->slides[j] = j < chain->n && (sequence >> (chain->n - 1 - j)) % 2 == 1;
        sliding += chain->slides[j];
        for (i = 0; i < 3; ++i) {
            chain->axis[j][i] = j < chain->n ? geometry[6 * j + i] : WG_C(0.0);
            chain->point[j][i] = j < chain->n ? geometry[6 * j + 3 + i] - geometry[3 + i] : WG_C(0.0);
            largest = WG_MAX(largest, WG_ABS(chain->point[j][i]));
        }
    }
    for (i = 0; i < 3; ++i) {
        chain->foot[i] = geometry[6 * chain->n + i] - geometry[3 + i];
        target[i] = p[i] - geometry[3 + i];
        farthest = WG_MAX(farthest, WG_ABS(target[i]));
        largest = WG_MAX(largest, WG_ABS(chain->foot[i]));
    }
    (void)WG_LIBM(frexp)(sliding > 0 ? WG_MAX(largest, farthest) : largest, size);
    (void)WG_LIBM(frexp)(farthest, &exponent);
    exponent = exponent - *size > 20 ? exponent - 20 : *size;
    for (i = 0; i < 3; ++i) {
        target[i] = WG_LIBM(ldexp)(target[i], -exponent);
        chain->foot[i] = WG_LIBM(ldexp)(chain->foot[i], -*size);
        for (j = 0; j < 3; ++j) {
            chain->point[j][i] = WG_LIBM(ldexp)(chain->point[j][i], -*size);
        }
    }
    for (j = chain->n - 1; j >= 0; --j) { /* points next to each other: the levers */
        WG_NAME(wg_add)(beyond, WG_C(-1.0), chain->point[j], gap);
        if (chain->slides[j]) {
            WG_NAME(wg_add)(beyond, WG_C(0.0), gap, chain->point[j]);
        } else {
            WG_NAME(wg_add)(chain->point[j], WG_NAME(wg_dot)(chain->axis[j], gap), chain->axis[j], chain->point[j]);
        }
        WG_NAME(wg_add)(beyond, WG_C(-1.0), chain->point[j], gap);
        reach += WG_NAME(wg_norm)(gap);
        beyond = chain->point[j];
    }
    return WG_TOLERANCE * (reach + (sliding > 0 ? WG_NAME(wg_norm)(target) : WG_C(0.0)));
}

/* Append the pose that a start leads to. */
static inline void WG_NAME(wg_polish)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], const WG_REAL start[3],
                                      struct WG_NAME(wg_poses) * poses) {
    WG_REAL *q = poses->q[poses->count];
    int i;
    for (i = 0; i < 3; ++i) {
        q[i] = start[i];
    }
    if (isfinite(q[0]) && isfinite(q[1]) && isfinite(q[2])) {
        poses->gap[poses->count++] = WG_NAME(wg_nearest)(chain, target, -1, q);
    }
}

/* Grid point `index` over all joints but the first, which follows the target: how far the foot is from it; -1 past the last point. */
static inline WG_REAL WG_NAME(wg_grid_point)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], int index, WG_REAL q[3]) {
    WG_REAL x[3], arm[3], away[3];
    int j;
    WG_NAME(wg_add)(chain->foot, WG_C(0.0), chain->foot, x);
    q[0] = q[1] = q[2] = WG_C(0.0);
    for (j = chain->n - 1; j > 0; --j) {
        const int choices = chain->slides[j] ? 3 : 12, choice = index % choices;
        q[j] = chain->slides[j] ? (WG_REAL)choice - WG_C(1.0) : (WG_REAL)choice * (WG_PI / WG_C(6.0));
        index /= choices;
        WG_NAME(wg_moved)(chain, j, q[j], x);
    }
    if (index > 0) {
        return WG_C(-1.0);
    }
    WG_NAME(wg_add)(x, WG_C(-1.0), chain->point[0], arm);
    WG_NAME(wg_add)(target, WG_C(-1.0), chain->point[0], away);
    q[0] = chain->slides[0] ? WG_NAME(wg_dot)(chain->axis[0], away) - WG_NAME(wg_dot)(chain->axis[0], arm)
                            : WG_NAME(wg_angle_about)(chain->axis[0], arm, away);
    WG_NAME(wg_moved)(chain, 0, q[0], x);
    WG_NAME(wg_add)(x, WG_C(-1.0), target, away);
    return WG_NAME(wg_norm)(away);
}

/* Append the poses that the best points of the grid lead to. */
static inline void WG_NAME(wg_search_grid)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3],
                                           struct WG_NAME(wg_poses) * poses) {
    WG_REAL start[WG_STARTS][3], gap[WG_STARTS], q[3], distance;
    int index, i, k, kept = 0;
    for (index = 0; (distance = WG_NAME(wg_grid_point)(chain, target, index, q)) >= WG_C(0.0); ++index) {
        if (kept == WG_STARTS && !(distance < gap[kept - 1])) {
            continue;
        }
        kept = kept < WG_STARTS ? kept + 1 : kept;
        for (i = kept - 1; i > 0 && distance < gap[i - 1]; --i) {
            gap[i] = gap[i - 1];
            for (k = 0; k < 3; ++k) {
                start[i][k] = start[i - 1][k];
            }
        }
        gap[i] = distance;
        for (k = 0; k < 3; ++k) {
            start[i][k] = q[k];
        }
    }
    for (i = 0; i < kept; ++i) {
        WG_NAME(wg_polish)(chain, target, start[i], poses);
    }
}

/* The chain that leads the target back to the foot by the same joint values, last joint first. */
static inline void WG_NAME(wg_reversed)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], struct WG_NAME(wg_chain) * back) {
    int i, j;
    back->motion = NULL;
    back->n = chain->n;
    for (j = 0; j < 3; ++j) {
        back->slides[j] = chain->slides[2 - j];
        back->foot[j] = target[j];
        for (i = 0; i < 3; ++i) {
            back->axis[j][i] = -chain->axis[2 - j][i];
            back->point[j][i] = chain->point[2 - j][i];
        }
    }
}

/* All poses: candidates of the elimination, of the grid where it has none or none reaches the target. */
static inline void WG_NAME(wg_all_poses)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], WG_REAL tolerance,
                                         struct WG_NAME(wg_poses) * poses) {
    const int sliding = chain->slides[0] + chain->slides[1] + chain->slides[2];
    const int turn_round = (chain->slides[0] && chain->slides[1]) || (sliding == 1 && chain->slides[2]);
    WG_REAL start[36][3];
    int i, count, reached = 0;
    poses->count = 0;
    if (chain->n == 3 && sliding < 3) {
        struct WG_NAME(wg_chain) back;
        WG_NAME(wg_reversed)(chain, target, &back);
        count = WG_NAME(wg_candidates)(turn_round ? &back : chain, turn_round ? chain->foot : target, start);
        for (i = 0; i < count; ++i) {
            const WG_REAL first = start[i][0];
            start[i][0] = turn_round ? start[i][2] : first;
            start[i][2] = turn_round ? first : start[i][2];
            WG_NAME(wg_polish)(chain, target, start[i], poses);
        }
    }
    for (i = 0; i < poses->count; ++i) {
        reached |= poses->gap[i] <= tolerance;
    }
    if (!reached) {
        WG_NAME(wg_search_grid)(chain, target, poses);
    }
}

#undef WG_TOLERANCE
#undef WG_LIBM
#endif
