/* walkgen_contact_newton.h: the multipliers' maximum, or the proof that there is none; walkgen_math.h explains the macros.
 *
 * The proof (Farkas): y with y . b > 0 while y . A f <= 0 for all forces f that the cones allow, or at most n_max times the foot's lack.
 * Where Newton on the multipliers ends without one, the least violation is sought, which always exists: the forces in cones widened by a
 * hair whose balance lacks least, by the method of multipliers. What is lacking proves that the load cannot be carried, unless it vanishes.
 */
#include "walkgen_contact_proof.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_NEWTON_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_NEWTON_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_NEWTON_F64
#define WG_SHARP WG_C(1e-13)  /* balance, of the load, that ends the search */
#define WG_FAIR WG_C(1e-10)   /* balance, of the load, that forces must have */
#define WG_HAIR WG_C(1e-11)   /* by which cones are widened to make a proof strict */
#define WG_RATHER WG_C(1e-12) /* of the load over the greatest forces that a proof excludes, if it can be had */
#define WG_ENOUGH WG_C(1e-7)  /* and else */
#define WG_DAMPED WG_C(1e-14)
#define WG_FIRM WG_C(1e-9)
#else
#define WALKGEN_CONTACT_NEWTON_F32
#define WG_SHARP WG_C(2e-6)
#define WG_FAIR WG_C(5e-5)
#define WG_HAIR WG_C(1e-5)
#define WG_RATHER WG_C(1e-5)
#define WG_ENOUGH WG_C(1e-4)
#define WG_DAMPED WG_C(1e-7)
#define WG_FIRM WG_C(1e-9)
#endif
#ifndef WG_CONTACT_FOUND
#define WG_CONTACT_FOUND 0
#define WG_CONTACT_REFUTED 1
#define WG_CONTACT_OPEN 2
#endif

/* Whether dual's forces show that y may be a proof: all feet without bound are free, and rounding of y does not hide its gain. */
static inline int WG_NAME(wg_contact_refuted)(const struct WG_NAME(wg_contact_stance) * stance,
                                              const struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL gain = WG_NAME(wg_contact_product)(stance->b, dual->y);
    int i;
    for (i = 0; i < stance->feet; ++i) {
        if (dual->images.lack[i] > WG_C(0.0)) {
            if (!(stance->cones.n_max[i] <= WG_HUGE)) {
                return 0;
            }
            gain -= stance->cones.n_max[i] * dual->images.lack[i];
        }
    }
    return gain > WG_HAIR * WG_SQRT(WG_NAME(wg_contact_product)(dual->y, dual->y));
}

/* dual moved along a step to where the slope along it is small: at once if the step's end is such a place. `seeking` ends at a proof. */
WG_CALLED void WG_NAME(wg_contact_search)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL step[6], int seeking,
                                              struct WG_NAME(wg_contact_dual) * dual) {
    const WG_REAL first = WG_NAME(wg_contact_product)(dual->slope, step);
    WG_REAL from[6], way[6], low = WG_C(0.0), high = -WG_C(1.0), rising = first, falling = WG_C(0.0), t = WG_C(1.0), along;
    int turn, j;
    for (j = 0; j < 6; ++j) {
        from[j] = dual->y[j];
        way[j] = step[j];
    }
    for (turn = 0; turn < 30; ++turn) {
        for (j = 0; j < 6; ++j) {
            dual->y[j] = from[j] + t * way[j];
        }
        WG_NAME(wg_contact_evaluate)(stance, dual);
        along = WG_NAME(wg_contact_product)(dual->slope, way);
        if (!(WG_ABS(along) > WG_C(0.3) * first) || (seeking && WG_NAME(wg_contact_refuted)(stance, dual))) {
            return;
        }
        if (along > WG_C(0.0)) {
            low = t;
            rising = along;
        } else {
            high = t;
            falling = along;
        }
        if (high < WG_C(0.0)) {
            t *= turn < 3 ? WG_C(4.0) : WG_C(30.0);
        } else {
            const WG_REAL width = high - low;
            t = low + width * WG_MIN(WG_MAX(rising / (rising - falling), WG_C(0.1)), WG_C(0.9));
        }
    }
}

/* The largest part of a force, at least that of the load. */
static inline WG_REAL WG_NAME(wg_contact_largest)(const struct WG_NAME(wg_contact_stance) * stance,
                                                  const struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL largest = WG_C(1.0);
    int i;
    for (i = 0; i < 3 * stance->feet; ++i) {
        largest = WG_MAX(largest, WG_ABS(dual->images.f[i % 3][i / 3]));
    }
    return largest;
}

/* Length of the slope. */
WG_INLINE WG_REAL WG_NAME(wg_contact_lacking)(const struct WG_NAME(wg_contact_dual) * dual) {
    return WG_SQRT(WG_NAME(wg_contact_product)(dual->slope, dual->slope));
}

/* From dual->y, evaluated, to the maximum: WG_CONTACT_FOUND, WG_CONTACT_REFUTED with a proof, or WG_CONTACT_OPEN after `most` steps. */
WG_CALLED int WG_NAME(wg_contact_ascend)(const struct WG_NAME(wg_contact_stance) * stance, int most,
                                         struct WG_NAME(wg_contact_dual) * dual) {
    struct WG_NAME(wg_contact_matrix) H;
    WG_REAL step[6];
    int turn;
    for (turn = 0;; ++turn) {
        const WG_REAL lacking = WG_NAME(wg_contact_lacking)(dual);
        if (lacking <= WG_SHARP * (turn < 6 ? WG_C(1.0) : WG_NAME(wg_contact_largest)(stance, dual))) {
            return WG_CONTACT_FOUND;
        }
        if (WG_NAME(wg_contact_refuted)(stance, dual)) {
            return WG_CONTACT_REFUTED;
        }
        if (turn == most) {
            return WG_CONTACT_OPEN;
        }
        WG_NAME(wg_contact_curvature)(stance, dual, WG_DAMPED, &H);
        if (!WG_NAME(wg_contact_solve_blocks)(&H, dual->slope, step)) {
            WG_NAME(wg_contact_curvature)(stance, dual, WG_C(1e-3) * WG_MIN(lacking, WG_C(1.0)) + WG_DAMPED, &H);
            WG_NAME(wg_contact_solve)(stance, &H, dual->slope, step);
        }
        if (!(WG_NAME(wg_contact_product)(dual->slope, step) > WG_C(0.0))) {
            return WG_CONTACT_OPEN;
        }
        WG_NAME(wg_contact_search)(stance, step, 1, dual);
    }
}

/* The maximum of the bounded problem near enough: Newton until the slope is small beside |y|. */
WG_CALLED void WG_NAME(wg_contact_settle)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_dual) * dual) {
    struct WG_NAME(wg_contact_matrix) H;
    WG_REAL step[6], size;
    int turn;
    WG_NAME(wg_contact_evaluate)(stance, dual);
    for (turn = 0; turn < 30; ++turn) {
        size = WG_SQRT(WG_NAME(wg_contact_product)(dual->y, dual->y));
        if (turn > 0 && WG_NAME(wg_contact_lacking)(dual) <= WG_C(1e-3) * size) {
            return;
        }
        WG_NAME(wg_contact_curvature)(stance, dual, WG_C(0.0), &H);
        WG_NAME(wg_contact_solve)(stance, &H, dual->slope, step);
        if (!(WG_NAME(wg_contact_product)(dual->slope, step) > WG_C(0.0))) {
            return;
        }
        WG_NAME(wg_contact_search)(stance, step, 0, dual);
    }
}

/* Cones widened to mu + share (1 + mu^2), or back to `mu`. */
static inline void WG_NAME(wg_contact_widen)(const WG_REAL *mu, WG_REAL share, struct WG_NAME(wg_contact_stance) * stance) {
    int i;
    for (i = 0; i < stance->feet; ++i) {
        WG_NAME(wg_contact_rub)(mu[i] + share * (WG_C(1.0) + mu[i] * mu[i]), i, &stance->cones);
    }
}

/* The bounded problem's next centre: the forces found, or the vectors that they are nearest to. */
static inline void WG_NAME(wg_contact_recentre)(const struct WG_NAME(wg_contact_stance) * stance,
                                                const struct WG_NAME(wg_contact_dual) * dual,
                                                int forces, WG_REAL centre[3][WALKGEN_MAX_FEET]) {
    WG_REAL z[3][WALKGEN_MAX_FEET];
    int i, j;
    WG_NAME(wg_contact_pull)(stance, dual->y, z);
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < stance->feet; ++i) {
            centre[j][i] = forces ? dual->images.f[j][i] : centre[j][i] + dual->stretch * stance->ease[i] * z[j][i];
        }
    }
}

/* The least violation: WG_CONTACT_REFUTED with its proof in dual->y, WG_CONTACT_FOUND where it vanishes, else WG_CONTACT_OPEN. */
WG_CALLED int WG_NAME(wg_contact_violate)(struct WG_NAME(wg_contact_stance) * stance, int most, struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL centre[3][WALKGEN_MAX_FEET], mu[WALKGEN_MAX_FEET], slack = WG_C(0.1), size, largest, allowed;
    int turn, i, answer = WG_CONTACT_OPEN;
    for (i = 0; i < stance->feet; ++i) {
        mu[i] = stance->cones.mu[i];
        centre[0][i] = centre[1][i] = centre[2][i] = WG_C(0.0);
    }
    dual->centre = (const WG_REAL(*)[WALKGEN_MAX_FEET])centre;
    dual->bound = WG_C(1.0);
    for (turn = 0; turn < most && answer == WG_CONTACT_OPEN; ++turn) {
        WG_NAME(wg_contact_widen)(mu, WG_HAIR, stance);
        dual->stretch = WG_C(1.0) / slack;
        WG_NAME(wg_contact_settle)(stance, dual);
        WG_NAME(wg_contact_widen)(mu, WG_C(0.0), stance);
        largest = WG_NAME(wg_contact_largest)(stance, dual);
        size = WG_SQRT(WG_NAME(wg_contact_product)(dual->y, dual->y));
        allowed = WG_RATHER + (turn < 20 ? WG_C(0.0) : WG_C(8.0) * WG_EPSILON / size);
        if (size <= WG_C(10.0) * WG_RATHER * largest) {
            answer = WG_CONTACT_FOUND;
        } else if (WG_NAME(wg_contact_proof)(stance, dual->y, WG_C(0.0), allowed) > WG_C(0.0)) {
            answer = WG_CONTACT_REFUTED;
        }
        WG_NAME(wg_contact_recentre)(stance, dual, 1, centre);
        slack = WG_MAX(WG_C(0.1) * slack, WG_FIRM * size);
    }
    if (answer == WG_CONTACT_OPEN && !WG_NAME(wg_contact_is_unbounded)(stance) && /* else there are other ways to a better proof */
        WG_NAME(wg_contact_proof)(stance, dual->y, WG_C(0.0), WG_ENOUGH) > WG_C(0.0)) {
        answer = WG_CONTACT_REFUTED;
    }
    dual->centre = NULL;
    dual->bound = WG_C(0.0);
    dual->stretch = WG_C(1.0);
    return answer;
}

/* The least forces of a load that can be carried, however large: proximal steps of the multipliers, each a bounded problem. */
WG_CALLED int WG_NAME(wg_contact_approach)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL centre[3][WALKGEN_MAX_FEET], sum[6], slack = WG_C(0.1), lacking = WG_C(1.0), largest;
    int turn, i, answer = WG_CONTACT_OPEN;
    for (i = 0; i < 3 * stance->feet; ++i) {
        centre[i % 3][i / 3] = WG_C(0.0);
    }
    for (i = 0; i < 6; ++i) {
        sum[i] = WG_C(0.0);
    }
    dual->centre = (const WG_REAL(*)[WALKGEN_MAX_FEET])centre;
    dual->bound = WG_C(1.0);
    for (turn = 0; turn < 40 && answer == WG_CONTACT_OPEN; ++turn) {
        WG_REAL product[6];
        dual->stretch = WG_C(1.0) / slack;
        WG_NAME(wg_contact_settle)(stance, dual);
        largest = WG_NAME(wg_contact_largest)(stance, dual);
        WG_NAME(wg_contact_metric)(stance, dual->y, product);
        for (i = 0; i < 6; ++i) {
            product[i] += dual->slope[i];
            sum[i] += dual->stretch * dual->y[i];
        }
        lacking = WG_SQRT(WG_NAME(wg_contact_product)(product, product));
        answer = lacking <= WG_SHARP * largest ? WG_CONTACT_FOUND : WG_CONTACT_OPEN;
        WG_NAME(wg_contact_recentre)(stance, dual, 0, centre);
        slack = WG_MAX(WG_C(0.1) * slack, WG_DAMPED);
    }
    dual->centre = NULL;
    dual->bound = WG_C(0.0);
    dual->stretch = WG_C(1.0);
    for (i = 0; i < 6; ++i) {
        dual->y[i] = sum[i];
    }
    return answer;
}

#undef WG_SHARP
#undef WG_FAIR
#undef WG_HAIR
#undef WG_RATHER
#undef WG_ENOUGH
#undef WG_DAMPED
#undef WG_FIRM
#endif
