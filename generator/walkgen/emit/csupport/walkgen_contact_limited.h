/* walkgen_contact_limited.h: the least forces with which feet carry a load within their friction cones and within limits on sums of their
 * components, e.g. joint torques; walkgen_math.h explains the macros.
 *
 * Where the forces without limits keep them, they are the answer. Otherwise the least violation is sought by the method of multipliers, as
 * in walkgen_contact_newton.h: what is lacking proves that there are no forces, or the same method approaches the least ones.
 */
#include "walkgen_contact.h"
#include "walkgen_contact_limits.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_LIMITED_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_LIMITED_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_LIMITED_F64
#define WG_SHARP WG_C(1e-13)
#define WG_FAIR WG_C(1e-10)
#define WG_HAIR WG_C(1e-11)
#define WG_RATHER WG_C(1e-12)
#define WG_ENOUGH WG_C(1e-7)
#define WG_DAMPED WG_C(1e-14)
#define WG_FIRM WG_C(1e-9)
#define WG_FAR WG_C(1e100)
#else
#define WALKGEN_CONTACT_LIMITED_F32
#define WG_SHARP WG_C(2e-6)
#define WG_FAIR WG_C(5e-5)
#define WG_HAIR WG_C(1e-5)
#define WG_RATHER WG_C(1e-5)
#define WG_ENOUGH WG_C(1e-4)
#define WG_DAMPED WG_C(1e-7)
#define WG_FIRM WG_C(1e-9)
#define WG_FAR WG_C(1e9)
#endif

/* Whether limits are ones: as many as there is room for, rows finite, ends not below all numbers. */
static inline int WG_NAME(wg_contact_limits_fine)(int32_t k, int32_t rows, const WG_REAL *torque_rows, const WG_REAL *torque_limits) {
    int fine = rows >= 0 && rows <= WALKGEN_MAX_LIMITS, r;
    for (r = 0; fine && r < rows; ++r) {
        fine = WG_NAME(wg_contact_finite)(torque_rows + 3 * k * r, 3 * k) && torque_limits[r] >= -WG_HUGE;
    }
    return fine;
}

/* Whether forces keep the limits. */
static inline int WG_NAME(wg_contact_kept)(int32_t k, const WG_REAL *f, int32_t rows, const WG_REAL *torque_rows,
                                           const WG_REAL *torque_limits) {
    int kept = 1, r, i;
    for (r = 0; r < rows; ++r) {
        WG_REAL sum = WG_C(0.0);
        for (i = 0; i < 3 * k; ++i) {
            sum += torque_rows[3 * k * r + i] * f[i];
        }
        kept &= sum <= torque_limits[r];
    }
    return kept;
}

/* A stance without load measures forces by its limits. */
static inline void WG_NAME(wg_contact_measure)(const struct WG_NAME(wg_contact_limits) * limits, const WG_REAL *torque_limits,
                                               const WG_REAL *n_max, struct WG_NAME(wg_contact_stance) * stance) {
    WG_REAL largest = WG_C(0.0);
    int r, i;
    for (r = 0; r < limits->rows; ++r) {
        const WG_REAL size = WG_ABS(torque_limits[r] / limits->size[r]);
        largest = size <= WG_HUGE ? WG_MAX(largest, size) : largest;
    }
    stance->force_size = WG_NAME(wg_contact_size)(&largest, 1, 0);
    stance->force_unit = WG_NAME(wg_power)(stance->force_size);
    for (i = 0; i < 6; ++i) {
        stance->b[i] = WG_C(0.0);
    }
    for (i = 0; i < stance->feet; ++i) {
        stance->cones.n_max[i] = n_max[i] / stance->force_unit;
    }
}

/* Rows over their sizes, in the stance's axes, and their ends in its unit of force; a row that says nothing becomes 0 <= 1. */
static inline void WG_NAME(wg_contact_bind)(const WG_REAL *torque_rows, const WG_REAL *torque_limits, const WG_REAL *n_max,
                                            struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_limits) * limits) {
    const int32_t k = stance->feet;
    int r, i, j;
    for (r = 0; r < limits->rows; ++r) {
        limits->size[r] = WG_NAME(wg_power)(WG_NAME(wg_contact_size)(torque_rows + 3 * k * r, 3 * k, 0));
    }
    if (!(WG_NAME(wg_contact_product)(stance->b, stance->b) > WG_C(0.0))) {
        WG_NAME(wg_contact_measure)(limits, torque_limits, n_max, stance);
    }
    for (r = 0; r < limits->rows; ++r) {
        const int says = torque_limits[r] <= WG_HUGE;
        const WG_REAL end = torque_limits[r] / limits->size[r] / stance->force_unit;
        for (i = 0; i < k; ++i) {
            for (j = 0; j < 3; ++j) {
                const WG_REAL *row = torque_rows + 3 * (k * r + i), axis[3] = {stance->axes[0][j], stance->axes[1][j], stance->axes[2][j]};
                const WG_REAL part = stance->turned ? WG_NAME(wg_dot)(axis, row) : row[j];
                limits->T[r][j][i] = says ? part / limits->size[r] : WG_C(0.0);
            }
        }
        limits->end[r] = says ? WG_MIN(WG_MAX(end, -WG_FAR), WG_FAR) : WG_C(1.0);
    }
}

/* The search's beginning: no multipliers, centres at `low` 0. */
static inline void WG_NAME(wg_contact_begin)(struct WG_NAME(wg_contact_limits) * limits) {
    int i;
    for (i = 0; i < 6; ++i) {
        limits->dual.y[i] = WG_C(0.0);
    }
    for (i = 0; i < limits->rows; ++i) {
        limits->l[i] = limits->low[i] = WG_C(0.0);
    }
    for (i = 0; i < WALKGEN_MAX_FEET; ++i) {
        limits->centre[0][i] = limits->centre[1][i] = limits->centre[2][i] = WG_C(0.0);
    }
    limits->dual.bound = WG_C(1.0);
}

/* What y and l prove. */
WG_CALLED WG_REAL WG_NAME(wg_contact_proof_all)(const struct WG_NAME(wg_contact_stance) * stance,
                                                const struct WG_NAME(wg_contact_limits) * limits,
                                                    WG_REAL allowed, WG_REAL z[3][WALKGEN_MAX_FEET], WG_REAL *whole) {
    int r;
    *whole = WG_NAME(wg_contact_product)(stance->b, limits->dual.y);
    for (r = 0; r < limits->rows; ++r) {
        *whole -= limits->l[r] * limits->end[r];
    }
    WG_NAME(wg_contact_pull_all)(stance, limits, limits->dual.y, limits->l, z);
    return WG_NAME(wg_contact_excess)(&stance->cones, stance->feet, z, *whole, WG_C(0.0), allowed);
}

/* The least violation, as wg_contact_violate. */
WG_CALLED int WG_NAME(wg_contact_violate_all)(struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_limits) * limits) {
    WG_REAL mu[WALKGEN_MAX_FEET], z[3][WALKGEN_MAX_FEET], slack = WG_C(0.1), whole, size;
    int turn, i, j;
    WG_NAME(wg_contact_begin)(limits);
    for (i = 0; i < stance->feet; ++i) {
        mu[i] = stance->cones.mu[i];
    }
    for (turn = 0; turn < 40; ++turn) {
        WG_NAME(wg_contact_widen)(mu, WG_HAIR, stance);
        limits->dual.stretch = WG_C(1.0) / slack;
        WG_NAME(wg_contact_settle_all)(stance, limits);
        WG_NAME(wg_contact_widen)(mu, WG_C(0.0), stance);
        size = WG_NAME(wg_contact_length_all)(limits);
        if (size <= WG_C(10.0) * WG_RATHER * WG_NAME(wg_contact_largest)(stance, &limits->dual)) {
            return WG_CONTACT_FOUND;
        }
        if (WG_NAME(wg_contact_proof_all)(stance, limits, WG_RATHER + (turn < 20 ? WG_C(0.0) : WG_C(8.0) * WG_EPSILON / size), z,
                                          &whole) > WG_C(0.0)) {
            return WG_CONTACT_REFUTED;
        }
        for (i = 0; i < stance->feet; ++i) {
            for (j = 0; j < 3; ++j) {
                limits->centre[j][i] = limits->dual.images.f[j][i];
            }
        }
        slack = WG_MAX(WG_C(0.1) * slack, WG_FIRM * size);
    }
    return WG_NAME(wg_contact_proof_all)(stance, limits, WG_ENOUGH, z, &whole) > WG_C(0.0) ? WG_CONTACT_REFUTED : WG_CONTACT_OPEN;
}

/* What forces lack of the load, or have above a limit. */
static inline WG_REAL WG_NAME(wg_contact_fault)(const struct WG_NAME(wg_contact_stance) * stance,
                                                const struct WG_NAME(wg_contact_limits) * limits,
                                                WG_REAL f[3][WALKGEN_MAX_FEET]) {
    WG_REAL worst = WG_NAME(wg_contact_imbalance)(stance, f);
    int r;
    for (r = 0; r < limits->rows; ++r) {
        const WG_REAL over = WG_NAME(wg_contact_along)(limits, r, stance->feet, (const WG_REAL(*)[WALKGEN_MAX_FEET])f) - limits->end[r];
        worst = WG_MAX(worst, over);
    }
    return worst;
}

/* The least forces in dual.images.f, as wg_contact_approach: proximal steps of all multipliers. */
WG_CALLED void WG_NAME(wg_contact_approach_all)(const struct WG_NAME(wg_contact_stance) * stance,
                                                struct WG_NAME(wg_contact_limits) * limits) {
    WG_REAL slack = WG_C(0.1), total[WALKGEN_MAX_LIMITS], z[3][WALKGEN_MAX_FEET];
    int turn, i, j, r;
    WG_NAME(wg_contact_begin)(limits);
    for (r = 0; r < limits->rows; ++r) {
        total[r] = WG_C(0.0);
    }
    for (turn = 0; turn < 40; ++turn) {
        limits->dual.stretch = WG_C(1.0) / slack;
        for (r = 0; r < limits->rows; ++r) {
            limits->low[r] = -total[r] * slack;
            limits->l[r] = WG_MAX(limits->l[r], limits->low[r]);
        }
        WG_NAME(wg_contact_settle_all)(stance, limits);
        WG_NAME(wg_contact_pull_all)(stance, limits, limits->dual.y, limits->l, z);
        if (WG_NAME(wg_contact_length_all)(limits) <= WG_SHARP * WG_NAME(wg_contact_largest)(stance, &limits->dual)) {
            return;
        }
        for (r = 0; r < limits->rows; ++r) {
            total[r] = limits->l[r] > limits->low[r] ? total[r] + limits->dual.stretch * limits->l[r] : WG_C(0.0);
        }
        for (i = 0; i < stance->feet; ++i) {
            for (j = 0; j < 3; ++j) {
                limits->centre[j][i] += limits->dual.stretch * stance->ease[i] * z[j][i];
            }
        }
        slack = WG_MAX(WG_C(0.1) * slack, WG_DAMPED);
    }
}

/* The proof in the inputs' frame and units. */
WG_CALLED void WG_NAME(wg_contact_refute_all)(const struct WG_NAME(wg_contact_stance) * stance,
                                              const struct WG_NAME(wg_contact_limits) * limits,
                                                  WG_REAL *certificate, WG_REAL *multipliers, WG_REAL *violation) {
    WG_REAL z[3][WALKGEN_MAX_FEET], whole;
    int r;
    (void)WG_NAME(wg_contact_proof_all)(stance, limits, WG_C(1.0), z, &whole);
    WG_NAME(wg_contact_certificate)(stance, limits->dual.y, whole, certificate);
    for (r = 0; r < limits->rows; ++r) {
        multipliers[r] = limits->l[r] / whole / limits->size[r] / stance->force_unit;
    }
    *violation = WG_NAME(wg_contact_distance)(stance, z, whole);
}

/* The search with limits: its status. */
WG_CALLED int32_t WG_NAME(wg_contact_limit)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                            const WG_REAL *wrench,
                                                const WG_REAL *weight, const WG_REAL *n_max, int32_t facets, int32_t rows,
                                                const WG_REAL *torque_rows, const WG_REAL *torque_limits, WG_REAL *f, int32_t *state,
                                                WG_REAL *certificate, WG_REAL *multipliers, WG_REAL *violation) {
    struct WG_NAME(wg_contact_stance) stance;
    struct WG_NAME(wg_contact_limits) limits;
    WG_REAL y[6], lacking;
    (void)WG_NAME(wg_contact_read)(k, points, normals, mu, wrench, weight, n_max, facets, &stance);
    (void)WG_NAME(wg_contact_spread)(&stance, y);
    limits.rows = rows;
    limits.dual.centre = NULL;
    WG_NAME(wg_contact_bind)(torque_rows, torque_limits, n_max, &stance, &limits);
    if (WG_NAME(wg_contact_violate_all)(&stance, &limits) == WG_CONTACT_REFUTED) {
        WG_NAME(wg_contact_refute_all)(&stance, &limits, certificate, multipliers, violation);
        return WALKGEN_INFEASIBLE;
    }
    WG_NAME(wg_contact_approach_all)(&stance, &limits);
    lacking = WG_NAME(wg_contact_fault)(&stance, &limits, limits.dual.images.f);
    if (!(lacking <= WG_FAIR * WG_NAME(wg_contact_largest)(&stance, &limits.dual))) {
        return WALKGEN_NO_CONVERGENCE;
    }
    WG_NAME(wg_contact_hand_over)(&stance, limits.dual.images.f, f, state);
    *violation = lacking * stance.force_unit;
    return WALKGEN_OK;
}

/* As wg_contact_least_squares, with sum_i torque_rows[r,i] . f_i <= torque_limits[r] (rows [rows,k,3], at most WALKGEN_MAX_LIMITS).
 * INFEASIBLE: certificate . wrench - multipliers . torque_limits = 1, while certificate . (f, p x f) + multipliers . rows f is at least 0
 * for all forces that feet can exert. At most 132 kB of stack in double, 69 kB in float. */
static inline void WG_NAME(wg_contact_limited)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                               const WG_REAL *wrench,
                                               const WG_REAL *weight, const WG_REAL *n_max, int32_t facets, int32_t rows,
                                               const WG_REAL *torque_rows, const WG_REAL *torque_limits,
                                               struct WG_NAME(walkgen_contact_work) * work, WG_REAL *f, int32_t *status, int32_t *state,
                                               WG_REAL *certificate, WG_REAL *violation, WG_REAL *multipliers) {
    const int fine = k >= 1 && k <= WALKGEN_MAX_FEET && WG_NAME(wg_contact_limits_fine)(k, rows, torque_rows, torque_limits);
    int i;
    WG_NAME(wg_contact_least_squares)(fine ? k : 0, points, normals, mu, wrench, weight, n_max, facets, work, f, status, state,
                                      certificate, violation);
    for (i = 0; i < rows && rows <= WALKGEN_MAX_LIMITS; ++i) {
        multipliers[i] = *status == WALKGEN_BAD_INPUT ? WG_NAN : WG_C(0.0);
    }
    if (!fine) {
        WG_NAME(wg_contact_blank)(k, WG_NAN, f, state, certificate, violation);
        return;
    }
    if ((*status != WALKGEN_OK || WG_NAME(wg_contact_kept)(k, f, rows, torque_rows, torque_limits)) && *status != WALKGEN_NO_CONVERGENCE) {
        return;
    }
    WG_NAME(wg_contact_blank)(k, WG_C(0.0), f, state, certificate, violation);
    *status = WG_NAME(wg_contact_limit)(k, points, normals, mu, wrench, weight, n_max, facets, rows, torque_rows, torque_limits, f, state,
                                        certificate, multipliers, violation);
    for (i = 0; i < 3 * k && *status != WALKGEN_OK; ++i) {
        f[i] = WG_NAN;
    }
}

#undef WG_SHARP
#undef WG_FAIR
#undef WG_HAIR
#undef WG_RATHER
#undef WG_ENOUGH
#undef WG_DAMPED
#undef WG_FIRM
#undef WG_FAR
#endif
