/* walkgen_inverse_general.h: all joint values of any leg of one to three joints that reach a foot position; walkgen_math.h explains the macros.
 *
 * Candidates come from an elimination (walkgen_elimination.h), or from a grid for legs of fewer joints, and are polished on the foot's
 * position itself: what reaches the target is a solution, what does not is dropped. Where nothing reaches it, the closest poses are sought
 * from a grid too. Lengths are scaled to about 1 by a power of 2. Everything is bounded: no input takes longer than some milliseconds.
 */
#include "walkgen_elimination.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_INVERSE_GENERAL_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_INVERSE_GENERAL_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_INVERSE_GENERAL_F64
#define WG_LIBM(name) name
#define WG_TOLERANCE WG_C(1e-12)
#define WG_SAME WG_C(1e-7)
#define WG_RANK WG_C(1e-12)
#else
#define WALKGEN_INVERSE_GENERAL_F32
#define WG_LIBM(name) name##f
#define WG_TOLERANCE (WG_C(8.0) * WG_EPSILON)
#define WG_SAME WG_C(2e-3)
#define WG_RANK WG_C(1e-6)
#endif
#ifndef WG_MOST
#define WG_MOST 46  /* candidates and grid starts */
#define WG_STARTS 10
#endif

/* Polished poses and how far the foot is from the target in each. */
struct WG_NAME(wg_poses) {
    int count;
    WG_REAL q[WG_MOST][3], gap[WG_MOST];
};

/* How many branches a leg has at most; the sequence is 1, then a binary digit a joint, base to foot: 0 turns, 1 slides (RRR is 8). */
static inline int WG_NAME(wg_slots_of)(int32_t sequence) {
    int turning = 0, joints = 0;
    for (; sequence > 1; sequence /= 2, ++joints) {
        turning += sequence % 2 == 0;
    }
    return joints < 2 || turning == 0 ? 1 : turning * 2 > joints && joints == 3 ? 4 : 2;
}

/* The chain from its numbers (for every joint axis and point, then the foot), scaled and seen from its first point; 1e-12 of the reach.
 * A target very far from a leg without sliding joints comes nearer: only its direction counts. `size` is the binary exponent taken out. */
static inline WG_REAL WG_NAME(wg_canonical)(const WG_REAL *geometry, const WG_REAL *p, int32_t sequence, struct WG_NAME(wg_chain) * chain,
                                            WG_REAL target[3], int *size) {
    WG_REAL largest = WG_C(0.0), farthest = WG_C(0.0), reach = WG_C(0.0), gap[3];
    const WG_REAL *beyond = chain->foot;
    int i, j, exponent = 0, sliding = 0;
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
static inline void WG_NAME(wg_search_grid)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], struct WG_NAME(wg_poses) * poses) {
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

/* The angle less full turns, in (-pi, pi]; a sliding joint's value as it is. */
static inline WG_REAL WG_NAME(wg_in_range)(int slides, WG_REAL q) {
    const WG_REAL wrapped = q - WG_C(2.0) * WG_PI * WG_LIBM(ceil)(q / (WG_C(2.0) * WG_PI) - WG_C(0.5));
    if (slides) {
        return q;
    }
    if (wrapped > WG_PI) { /* by a rounding */
        return wrapped - WG_C(2.0) * WG_PI;
    }
    return wrapped <= -WG_PI ? WG_PI : wrapped;
}

/* Greatest difference of two poses, modulo full turns. */
static inline WG_REAL WG_NAME(wg_apart)(const struct WG_NAME(wg_chain) * chain, const WG_REAL a[3], const WG_REAL b[3]) {
    WG_REAL most = WG_C(0.0);
    int j;
    for (j = 0; j < chain->n; ++j) {
        most = WG_MAX(most, WG_ABS(WG_NAME(wg_in_range)(chain->slides[j], a[j] - b[j])));
    }
    return most;
}

/* OK; DUPLICATE where two solutions meet in q; SINGULAR where q is not isolated, and its free joint becomes 0.
 * A null direction of J is followed: an isolated solution lets the foot go, or the search comes back. */
static inline int WG_NAME(wg_settle)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], WG_REAL tolerance, WG_REAL q[3]) {
    struct WG_NAME(wg_motion) at;
    WG_REAL gram[3][3], V[3][3], aside[3], least, most, longest = WG_C(0.0);
    int i, j, weakest = 0, freest = -1;
    WG_NAME(wg_motion_at)(chain, q, &at);
    for (i = 0; i < chain->n; ++i) {
        for (j = 0; j < chain->n; ++j) {
            gram[i][j] = WG_NAME(wg_dot)(at.column[i], at.column[j]);
        }
    }
    WG_NAME(wg_eigen)(chain->n, gram, V);
    least = most = gram[0][0];
    for (i = 1; i < chain->n; ++i) {
        weakest = gram[i][i] < least ? i : weakest;
        least = WG_MIN(least, gram[i][i]);
        most = WG_MAX(most, gram[i][i]);
    }
    if (least > WG_RANK * most) {
        return WALKGEN_OK;
    }
    for (i = 0; i < chain->n; ++i) {
        longest = WG_MAX(longest, WG_ABS(V[i][weakest]));
    }
    for (i = 0; i < 3; ++i) {
        const WG_REAL share = i < chain->n ? V[i][weakest] / longest : WG_C(0.0);
        aside[i] = q[i] + WG_C(0.1) * share;
        freest = freest < 0 && WG_ABS(share) > WG_C(0.5) ? i : freest;
    }
    if (!(WG_NAME(wg_nearest)(chain, target, 3, aside) <= tolerance && WG_NAME(wg_apart)(chain, q, aside) >= WG_C(0.01) &&
          WG_NAME(wg_apart)(chain, q, aside) <= WG_C(0.3))) {
        return WALKGEN_DUPLICATE;
    }
    for (i = 0; i < 3; ++i) {
        aside[i] = i == freest ? WG_C(0.0) : q[i];
    }
    if (WG_NAME(wg_nearest)(chain, target, freest, aside) <= tolerance) {
        for (i = 0; i < chain->n; ++i) {
            q[i] = WG_NAME(wg_in_range)(chain->slides[i], aside[i]);
        }
    }
    return WALKGEN_SINGULAR;
}

/* Whether a pose stands before another: by its joint values, first joint first, equal ones told by more than rounding. */
static inline int WG_NAME(wg_before)(const struct WG_NAME(wg_chain) * chain, const WG_REAL a[3], const WG_REAL b[3]) {
    int j;
    for (j = 0; j < chain->n; ++j) {
        if (WG_ABS(a[j] - b[j]) > WG_C(0.01) * WG_SAME) {
            return a[j] < b[j];
        }
    }
    return 0;
}

/* Rows and statuses, at most `slots`, from the poses that reach the target, or else the closest ones. */
static inline void WG_NAME(wg_fill_slots)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], WG_REAL tolerance,
                                          const struct WG_NAME(wg_poses) * poses, int slots, WG_REAL rows[4][3], int32_t *status) {
    WG_REAL least, limit, q[3];
    int i, j, k, count = 0, order[WG_MOST]; /* best first: of poses that are one, the sharpest is kept */
    for (i = 0; i < poses->count; ++i) {
        for (k = i; k > 0 && poses->gap[i] < poses->gap[order[k - 1]]; --k) {
            order[k] = order[k - 1];
        }
        order[k] = i;
    }
    least = poses->gap[order[0]];
    limit = WG_MAX(least, tolerance);
    for (j = 0; j < poses->count && count < slots; ++j) {
        int32_t state = WALKGEN_UNREACHABLE;
        const WG_REAL *pose = poses->q[order[j]];
        const int near_enough = poses->gap[order[j]] <= limit;
        for (i = 0; i < 3; ++i) {
            q[i] = i < chain->n ? WG_NAME(wg_in_range)(chain->slides[i], pose[i]) : WG_C(0.0);
        }
        for (k = 0; k < count && WG_NAME(wg_apart)(chain, q, rows[k]) > WG_SAME; ++k) {
        }
        if (k < count || !near_enough) {
            continue;
        }
        if (least <= tolerance) {
            state = WG_NAME(wg_settle)(chain, target, tolerance, q);
            for (k = 0; k < count && WG_NAME(wg_apart)(chain, q, rows[k]) > WG_SAME; ++k) {
            }
            if (k < count) {
                continue;
            }
        }
        for (k = count++; k > 0 && WG_NAME(wg_before)(chain, q, rows[k - 1]); --k) {
            WG_NAME(wg_add)(rows[k - 1], WG_C(0.0), q, rows[k]);
            status[k] = status[k - 1];
        }
        WG_NAME(wg_add)(q, WG_C(0.0), q, rows[k]);
        status[k] = state;
    }
    for (i = 0; i < count; ++i) { /* double roots take two slots where there is room */
        if (status[i] != WALKGEN_DUPLICATE) {
            continue;
        }
        status[i] = WALKGEN_OK;
        if (count < slots) {
            for (k = count++; k > i + 1; --k) {
                WG_NAME(wg_add)(rows[k - 1], WG_C(0.0), q, rows[k]);
                status[k] = status[k - 1];
            }
            WG_NAME(wg_add)(rows[i], WG_C(0.0), q, rows[i + 1]);
            status[++i] = WALKGEN_DUPLICATE;
        }
    }
    for (; count < slots; ++count) {
        WG_NAME(wg_add)(rows[0], WG_C(0.0), q, rows[count]);
        status[count] = WALKGEN_UNREACHABLE;
    }
}

/* Joint values [slots, n] and a status a row, sorted by their values: OK; SINGULAR where q is not isolated, its free joint is 0; DUPLICATE
 * where the row repeats the one before; UNREACHABLE where no solution is left: the first one again, or the closest poses where there is none;
 * BAD_INPUT and NaN where an input is not finite. geometry: for every joint its unit axis, positive for growing q, and a point on it at q = 0,
 * then the foot at q = 0 [6 n + 3]. */
static inline void WG_NAME(wg_inverse_general)(const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT p, int32_t sequence,
                                               WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_chain) chain;
    struct WG_NAME(wg_poses) poses;
    WG_REAL rows[4][3], target[3], tolerance;
    const int slots = WG_NAME(wg_slots_of)(sequence);
    int i, j, size = 0, fine = 1, n;
    for (n = 0; sequence >> (n + 1) > 0; ++n) {
    }
    for (i = 0; i < 6 * n + 3; ++i) {
        fine = fine && isfinite(geometry[i]) && (i >= 3 || isfinite(p[i]));
    }
    if (fine) {
        tolerance = WG_NAME(wg_canonical)(geometry, p, sequence, &chain, target, &size);
        WG_NAME(wg_all_poses)(&chain, target, tolerance, &poses);
        fine = poses.count > 0;
    }
    if (fine) {
        WG_NAME(wg_fill_slots)(&chain, target, tolerance, &poses, slots, rows, status);
    }
    for (i = 0; i < slots; ++i) {
        for (j = 0; j < n; ++j) {
            q[n * i + j] = fine ? (chain.slides[j] ? WG_LIBM(ldexp)(rows[i][j], size) : rows[i][j]) : WG_NAN;
        }
        status[i] = fine ? status[i] : WALKGEN_BAD_INPUT;
    }
}

/* One row by its index; another index is BAD_INPUT. */
static inline void WG_NAME(wg_inverse_general_branch)(const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT p, int32_t sequence,
                                                      int32_t branch, WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    WG_REAL rows[12];
    int32_t states[4];
    int i, n, known = branch >= 0 && branch < WG_NAME(wg_slots_of)(sequence);
    for (n = 0; sequence >> (n + 1) > 0; ++n) {
    }
    if (known) {
        WG_NAME(wg_inverse_general)(geometry, p, sequence, rows, states);
    }
    for (i = 0; i < n; ++i) {
        q[i] = known ? rows[n * branch + i] : WG_NAN;
    }
    *status = known ? states[branch] : WALKGEN_BAD_INPUT;
}

#undef WG_TOLERANCE
#undef WG_SAME
#undef WG_RANK
#undef WG_LIBM
#endif
