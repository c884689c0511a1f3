/* walkgen_inverse_general.h: all joint values of a leg of one to three joints that reach a target; walkgen_math.h explains the macros.
 *
 * Of all poses (walkgen_poses.h), what reaches the target is a solution, and what does not is dropped, unless nothing does: then the
 * closest ones stay. Lengths are scaled to about 1 by a power of 2. Everything is bounded: no input takes longer than some milliseconds.
 */
#include "walkgen_poses.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_INVERSE_GENERAL_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_INVERSE_GENERAL_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_INVERSE_GENERAL_F64
#define WG_LIBM(name) name
#define WG_SAME WG_C(1e-7)
#define WG_RANK WG_C(1e-12)
#define WG_NUDGES 3
#else
#define WALKGEN_INVERSE_GENERAL_F32
#define WG_LIBM(name) name##f
#define WG_SAME WG_C(2e-3)
#define WG_RANK WG_C(1e-6)
#define WG_NUDGES 1
#endif

/* How many branches a leg has at most; the sequence is 1, then a binary digit a joint, base to foot: 0 turns, 1 slides (RRR is 8). */
static inline int WG_NAME(wg_slots_of)(int32_t sequence) {
    int turning = 0, joints = 0;
    for (; sequence > 1; sequence /= 2, ++joints) {
        turning += sequence % 2 == 0;
    }
    return joints < 2 || turning == 0 ? 1 : turning * 2 > joints && joints == 3 ? 4 : 2;
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

/* Whether q can move with the foot at rest: a null direction of J is followed and the foot brought back. An isolated solution lets the
 * foot go, or the search comes back to q; where the way bends sharply, a short step shows it. */
static inline int WG_NAME(wg_can_move)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], WG_REAL tolerance,
                                       const WG_REAL q[3], const WG_REAL direction[3]) {
    WG_REAL nudge = WG_C(0.1), aside[3];
    int i;
    for (i = 0; i < WG_NUDGES; ++i, nudge *= WG_C(0.3)) {
        WG_NAME(wg_add)(q, nudge, direction, aside);
        if (WG_NAME(wg_nearest)(chain, target, 3, aside) <= tolerance && WG_NAME(wg_apart)(chain, q, aside) >= WG_C(0.1) * nudge &&
            WG_NAME(wg_apart)(chain, q, aside) <= WG_C(3.0) * nudge) {
            return 1;
        }
    }
    return 0;
}

/* OK; DUPLICATE where two solutions meet in q; SINGULAR where q is not isolated, and its free joint becomes 0. */
static inline int WG_NAME(wg_state_of)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], WG_REAL tolerance, WG_REAL q[3]) {
    struct WG_NAME(wg_motion) at;
    WG_REAL gram[3][3], V[3][3], aside[3], direction[3], least, most, longest = WG_C(0.0);
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
        direction[i] = i < chain->n ? V[i][weakest] / longest : WG_C(0.0);
        freest = freest < 0 && WG_ABS(direction[i]) > WG_C(0.5) ? i : freest;
    }
    if (!WG_NAME(wg_can_move)(chain, target, tolerance, q, direction)) {
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
    int i, j, k, count = 0, order[WG_MOST_POSES]; /* best first: of poses that are one, the sharpest is kept */
    for (i = 0; i < poses->count; ++i) {
        for (k = i; k > 0 && poses->gap[i] < poses->gap[order[k - 1]]; --k) {
            order[k] = order[k - 1];
        }
        order[k] = i;
    }
    least = poses->gap[order[0]];
    limit = least <= tolerance ? tolerance : least + WG_C(0.01) * tolerance; /* rounding does not choose between mirror images */
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
            state = WG_NAME(wg_state_of)(chain, target, tolerance, q);
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
 * where the row repeats the one before; UNREACHABLE where no solution is left: the first one again, or the closest poses where there is
 * none; BAD_INPUT and NaN where an input or q is not finite. geometry: for every joint its unit axis, positive for growing q, and a point
 * on it at q = 0, then the foot at q = 0 [6 n + 3]. */
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
        int finite = fine;
        for (j = 0; j < n && finite; ++j) {
            q[n * i + j] = chain.slides[j] ? WG_LIBM(ldexp)(rows[i][j], size) : rows[i][j];
            finite = isfinite(q[n * i + j]);
        }
        status[i] = finite ? status[i] : WALKGEN_BAD_INPUT;
        for (j = 0; j < n && !finite; ++j) {
            q[n * i + j] = WG_NAN;
        }
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

#undef WG_SAME
#undef WG_RANK
#undef WG_NUDGES
#undef WG_LIBM
#endif
