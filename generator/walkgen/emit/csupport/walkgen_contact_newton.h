/* walkgen_contact_newton.h: the multipliers' maximum, or the proof that there is none; walkgen_math.h explains the macros.
 *
 * The proof (Farkas): y with y . b > 0 while y . A f <= 0 for all forces f that the cones allow, or at most n_max times the foot's lack.
 * Where Newton on the multipliers ends without one, the least violation is sought, which always exists: the forces in cones widened by a
 * hair whose balance lacks least, by the method of multipliers. What is lacking proves that the load cannot be carried, unless it vanishes.
 */
#include "walkgen_contact_dual.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_NEWTON_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_NEWTON_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_NEWTON_F64
#define WG_SHARP WG_C(1e-13)  /* balance, of the load, that ends the search */
#define WG_FAIR WG_C(1e-10)   /* balance, of the load, that forces must have */
#define WG_HAIR WG_C(1e-10)   /* by which cones are widened to make a proof strict */
#define WG_RATHER WG_C(1e-12) /* of the load over the greatest forces that a proof excludes */
#define WG_DAMPED WG_C(1e-14)
#define WG_FIRM WG_C(1e-5)
#else
#define WALKGEN_CONTACT_NEWTON_F32
#define WG_SHARP WG_C(2e-6)
#define WG_FAIR WG_C(5e-5)
#define WG_HAIR WG_C(1e-5)
#define WG_RATHER WG_C(1e-5)
#define WG_DAMPED WG_C(1e-7)
#define WG_FIRM WG_C(1e-2)
#endif
#ifndef WG_CONTACT_FOUND
#define WG_CONTACT_FOUND 0
#define WG_CONTACT_REFUTED 1
#define WG_CONTACT_OPEN 2
#endif

/* What y proves: y . b less the most that forces give, 0 where forces without bound give more than `allowed` of that. `strictly`: the more
 * than rounding could hide. */
static inline WG_REAL WG_NAME(wg_contact_proof)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL strictly,
                                                WG_REAL allowed) {
    const WG_REAL whole = WG_NAME(wg_contact_product)(stance->b, y);
    WG_REAL gain = whole, z[3], e[3], w[3], u, v = WG_C(0.0);
    int i, j;
    for (i = 0; i < stance->feet; ++i) {
        const struct WG_NAME(wg_contact_cone) *cone = &stance->cone[i];
        WG_REAL lack;
        WG_NAME(wg_contact_pull)(y, stance->r[i], z);
        lack = WG_NAME(wg_dot)(cone->n, z);
        if (cone->facets) {
            WG_NAME(wg_contact_sector)(cone, z, e, w, &u, &v);
            lack += cone->mu * (cone->side * u + cone->corner * v);
        } else {
            for (j = 0, u = lack; j < 3; ++j) {
                e[j] = z[j] - u * cone->n[j];
            }
            lack += cone->mu * WG_NAME(wg_norm)(e);
        }
        lack += strictly * WG_NAME(wg_norm)(z);
        if (cone->n_max <= WG_HUGE) {
            gain -= lack > WG_C(0.0) ? cone->n_max * lack : WG_C(0.0);
        } else if (lack > allowed * whole) {
            return WG_C(0.0);
        }
    }
    return gain > allowed * whole ? gain : WG_C(0.0);
}

/* Whether dual's forces show that y may be a proof: all feet without bound are free, and rounding of y does not hide its gain. */
static inline int WG_NAME(wg_contact_refuted)(const struct WG_NAME(wg_contact_stance) * stance, const struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL gain = WG_NAME(wg_contact_product)(stance->b, dual->y);
    int i;
    for (i = 0; i < stance->feet; ++i) {
        const struct WG_NAME(wg_contact_image) *image = &dual->image[i];
        if (image->state != WG_CONTACT_FREE) {
            if (!(stance->cone[i].n_max <= WG_HUGE)) {
                return 0;
            }
            gain -= stance->cone[i].n_max * image->lack;
        }
    }
    return gain > WG_HAIR * WG_SQRT(WG_NAME(wg_contact_product)(dual->y, dual->y));
}

/* dual moved along a step to where the slope along it is small: at once if the step's end is such a place. `seeking` ends at a proof. */
static inline void WG_NAME(wg_contact_search)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL step[6], int seeking,
                                              struct WG_NAME(wg_contact_dual) * dual) {
    const WG_REAL first = WG_NAME(wg_contact_product)(dual->slope, step);
    WG_REAL from[6], low = WG_C(0.0), high = -WG_C(1.0), rising = first, falling = WG_C(0.0), t = WG_C(1.0), along;
    int turn, j;
    for (j = 0; j < 6; ++j) {
        from[j] = dual->y[j];
    }
    for (turn = 0; turn < 30; ++turn) {
        for (j = 0; j < 6; ++j) {
            dual->y[j] = from[j] + t * step[j];
        }
        WG_NAME(wg_contact_evaluate)(stance, dual);
        along = WG_NAME(wg_contact_product)(dual->slope, step);
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

/* Length of the slope, and the largest part of a force. */
static inline WG_REAL WG_NAME(wg_contact_lacking)(const struct WG_NAME(wg_contact_stance) * stance, const struct WG_NAME(wg_contact_dual) * dual,
                                                  WG_REAL *largest) {
    int i;
    *largest = WG_C(1.0);
    for (i = 0; i < 3 * stance->feet; ++i) {
        *largest = WG_MAX(*largest, WG_ABS(dual->image[i / 3].f[i % 3]));
    }
    return WG_SQRT(WG_NAME(wg_contact_product)(dual->slope, dual->slope));
}

/* From dual->y, evaluated, to the maximum: WG_CONTACT_FOUND, WG_CONTACT_REFUTED with a proof, or WG_CONTACT_OPEN after `most` steps. */
static inline int WG_NAME(wg_contact_ascend)(const struct WG_NAME(wg_contact_stance) * stance, int most, struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL H[6][6], step[6], largest;
    int turn;
    for (turn = 0;; ++turn) {
        const WG_REAL lacking = WG_NAME(wg_contact_lacking)(stance, dual, &largest);
        if (lacking <= WG_SHARP * largest) {
            return WG_CONTACT_FOUND;
        }
        if (WG_NAME(wg_contact_refuted)(stance, dual)) {
            return WG_CONTACT_REFUTED;
        }
        if (turn == most) {
            return WG_CONTACT_OPEN;
        }
        WG_NAME(wg_contact_curvature)(stance, dual, WG_C(1e-3) * WG_MIN(lacking, WG_C(1.0)) + WG_DAMPED, H);
        WG_NAME(wg_contact_solve)(stance, dual->slope, H, step);
        if (!(WG_NAME(wg_contact_product)(dual->slope, step) > WG_C(0.0))) {
            return WG_CONTACT_OPEN;
        }
        WG_NAME(wg_contact_search)(stance, step, 1, dual);
    }
}

/* The maximum of the bounded problem near enough: Newton until the slope is small beside |y|. */
static inline void WG_NAME(wg_contact_settle)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL H[6][6], step[6], size, largest;
    int turn;
    WG_NAME(wg_contact_evaluate)(stance, dual);
    for (turn = 0; turn < 30; ++turn) {
        size = WG_SQRT(WG_NAME(wg_contact_product)(dual->y, dual->y));
        if (turn > 0 && WG_NAME(wg_contact_lacking)(stance, dual, &largest) <= WG_C(1e-3) * size) {
            return;
        }
        WG_NAME(wg_contact_curvature)(stance, dual, WG_C(0.0), H);
        WG_NAME(wg_contact_solve)(stance, dual->slope, H, step);
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
        stance->cone[i].mu = mu[i] + share * (WG_C(1.0) + mu[i] * mu[i]);
    }
}

/* The least violation: WG_CONTACT_REFUTED with its proof in dual->y, WG_CONTACT_FOUND where it vanishes, else WG_CONTACT_OPEN. dual->image
 * has the forces, in cones a hair wider. */
static inline int WG_NAME(wg_contact_violate)(struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_dual) * dual) {
    WG_REAL centre[WALKGEN_MAX_FEET][3], mu[WALKGEN_MAX_FEET], slack = WG_C(0.1), size, largest;
    int turn, i, answer = WG_CONTACT_OPEN;
    for (i = 0; i < stance->feet; ++i) {
        mu[i] = stance->cone[i].mu;
        centre[i][0] = centre[i][1] = centre[i][2] = WG_C(0.0);
    }
    dual->centre = (const WG_REAL(*)[3])centre;
    dual->bound = WG_C(1.0);
    for (turn = 0; turn < 40 && answer == WG_CONTACT_OPEN; ++turn) {
        WG_NAME(wg_contact_widen)(mu, WG_HAIR, stance);
        dual->stretch = WG_C(1.0) / slack;
        WG_NAME(wg_contact_settle)(stance, dual);
        WG_NAME(wg_contact_widen)(mu, WG_C(0.0), stance);
        (void)WG_NAME(wg_contact_lacking)(stance, dual, &largest);
        size = WG_SQRT(WG_NAME(wg_contact_product)(dual->y, dual->y));
        if (size <= WG_C(10.0) * WG_RATHER * largest) {
            answer = WG_CONTACT_FOUND;
        } else if (WG_NAME(wg_contact_proof)(stance, dual->y, WG_C(0.0), WG_RATHER + WG_C(8.0) * WG_EPSILON / size) > WG_C(0.0)) {
            answer = WG_CONTACT_REFUTED;
        }
        for (i = 0; i < 3 * stance->feet; ++i) {
            centre[i / 3][i % 3] = dual->image[i / 3].f[i % 3];
        }
        slack = WG_MAX(WG_C(0.1) * slack, WG_FIRM * size);
    }
    dual->centre = NULL;
    dual->bound = WG_C(0.0);
    dual->stretch = WG_C(1.0);
    return answer;
}

#undef WG_SHARP
#undef WG_FAIR
#undef WG_HAIR
#undef WG_RATHER
#undef WG_DAMPED
#undef WG_FIRM
#endif
