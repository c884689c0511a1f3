/* walkgen_contact_stiffness.h: how a load spreads over feet on elastic legs (theory 4.3); walkgen_math.h explains the macros.
 *
 * Everything is in one frame; wrench is the load on the robot (force, moment about the frame's origin), f_i the ground's force on foot i:
 * sum (f_i, p_i x f_i) + wrench = 0. Feet that stick do not move: C f + e + G' delta = 0, f = -C^-1 (G' delta + e), delta = K^-1 (w - G
 * C^-1 e), K = G C^-1 G'. Feet that would pull are free and lift off, feet that leave their cone slide, the friction against their
 * displacement. Takes at most 38 kB of stack in double, 20 kB in float, less than half of it where the feet share no links.
 */
#include "walkgen_contact_bonded.h"
#include "walkgen_contact_carried.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_STIFFNESS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_STIFFNESS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_STIFFNESS_F64
#define WG_ALIKE WG_C(1e-9)
#define WG_FAIR WG_C(1e-9)
#else
#define WALKGEN_CONTACT_STIFFNESS_F32
#define WG_ALIKE WG_C(1e-5)
#define WG_FAIR WG_C(1e-4)
#endif

/* No answer: numbers are NaN, feet free. */
static inline void WG_NAME(wg_stiffness_blank)(int32_t k, WG_REAL *f, int32_t *state, WG_REAL displacement[6]) {
    int32_t i;
    for (i = 0; i < 3 * k; ++i) {
        f[i] = WG_NAN;
    }
    for (i = 0; i < k; ++i) {
        state[i] = WG_CONTACT_FREE;
    }
    for (i = 0; i < 6; ++i) {
        displacement[i] = WG_NAN;
    }
}

/* Forces, states and motion in the caller's units; what they lack of the balance, or of their conditions where that is more. */
static inline int32_t WG_NAME(wg_stiffness_deliver)(const struct WG_NAME(wg_contact_elastic) * stand,
                                                    const struct WG_NAME(wg_contact_stand) * at,
                                                    WG_REAL off, WG_REAL *f, WG_REAL displacement[6], WG_REAL *violation) {
    const WG_REAL yield = stand->yield * stand->force;
    WG_REAL lacking[6], shift[3], worst = off;
    int32_t i;
    int j;
    for (j = 0; j < 6; ++j) {
        lacking[j] = stand->w[j];
    }
    for (i = 0; i < stand->feet; ++i) {
        WG_NAME(wg_elastic_gather)(stand->r[i], at->f[i], WG_C(1.0), lacking, 1);
        for (j = 0; j < 3; ++j) {
            f[3 * i + j] = stand->force * at->f[i][j];
        }
    }
    for (j = 0; j < 6; ++j) {
        worst = WG_ABS(lacking[j]) <= worst ? worst : WG_ABS(lacking[j]);
        displacement[j] = yield * (j < 3 ? at->delta[j] : at->delta[j] / stand->length);
    }
    WG_NAME(wg_elastic_cross)(displacement + 3, stand->centre, shift);
    for (j = 0; j < 3; ++j) {
        displacement[j] -= shift[j];
    }
    *violation = worst * stand->force;
    return worst <= WG_FAIR ? WALKGEN_OK : WALKGEN_NO_CONVERGENCE;
}

/* Newton's method with rho a multiple of the feet's own stiffness. */
static inline int WG_NAME(wg_stiffness_newton)(const struct WG_NAME(wg_contact_elastic) * stand, WG_REAL factor, WG_REAL hold,
                                               struct WG_NAME(wg_contact_stand) * at, struct WG_NAME(wg_contact_states) * states) {
    int32_t i;
    states->hold = hold;
    for (i = 0; i < stand->feet; ++i) {
        const WG_REAL x = WG_NAME(wg_elastic_entry)(stand, 3 * i, 3 * i), y = WG_NAME(wg_elastic_entry)(stand, 3 * i + 1, 3 * i + 1);
        states->rho[i] = WG_C(3.0) * factor / (x + y + WG_NAME(wg_elastic_entry)(stand, 3 * i + 2, 3 * i + 2));
    }
    return WG_NAME(wg_slide_newton)(stand, at, states);
}

/* Lift off and slide; where that is not found at once, with springs that hold the platform and are softened: the status. */
static inline int32_t WG_NAME(wg_stiffness_slide)(const struct WG_NAME(wg_contact_elastic) * stand,
                                                  const struct WG_NAME(wg_contact_stand) * start,
                                                  WG_REAL *f, int32_t *state, WG_REAL displacement[6], WG_REAL *violation) {
    static const WG_REAL factors[3] = {WG_C(1.0), WG_C(0.1), WG_C(10.0)};
    struct WG_NAME(wg_contact_states) states;
    struct WG_NAME(wg_contact_stand) at;
    WG_REAL hold;
    int32_t i;
    int attempt, j, found = 0;
    for (attempt = 0; attempt < 3 && !found; ++attempt) {
        at = *start;
        found = WG_NAME(wg_stiffness_newton)(stand, factors[attempt], WG_C(0.0), &at, &states);
        if (attempt == 0 && !found) {
            *violation = WG_NAME(wg_carried_lack)(stand) * stand->force;
            if (*violation > WG_C(0.0)) {
                return WALKGEN_INFEASIBLE;
            }
        }
    }
    for (attempt = 0; attempt < 3 && !found; ++attempt) {
        at = *start;
        for (hold = WG_C(1.0); hold > WG_C(1e-5); hold *= WG_C(0.25)) {
            (void)WG_NAME(wg_stiffness_newton)(stand, factors[attempt], hold, &at, &states);
        }
        found = WG_NAME(wg_stiffness_newton)(stand, factors[attempt], WG_C(0.0), &at, &states);
    }
    if (!found) {
        return WALKGEN_NO_CONVERGENCE;
    }
    for (i = 0; i < stand->feet; ++i) {
        state[i] = states.state[i];
        for (j = 0; j < 3; ++j) {
            at.f[i][j] -= states.off[i][j];
        }
    }
    return WG_NAME(wg_stiffness_deliver)(stand, &at, WG_SQRT(states.merit), f, displacement, violation);
}

/* The rest once the stand is read. */
static inline int32_t WG_NAME(wg_stiffness_spread)(const struct WG_NAME(wg_contact_elastic) * stand, WG_REAL *f, int32_t *state,
                                                   WG_REAL displacement[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_stand) at;
    int32_t i, status;
    status = stand->matrix == NULL ? WG_NAME(wg_bonded_blocks)(stand, &at) : WG_NAME(wg_bonded_coupled)(stand, &at);
    if (status != WALKGEN_OK) {
        return status;
    }
    if (WG_LIKELY(WG_NAME(wg_bonded_presses)(stand, &at))) {
        for (i = 0; i < stand->feet; ++i) {
            state[i] = WG_CONTACT_STICK;
        }
        return WG_NAME(wg_stiffness_deliver)(stand, &at, WG_C(0.0), f, displacement, violation);
    }
    return WG_NAME(wg_stiffness_slide)(stand, &at, f, state, displacement, violation);
}

/* A foot's block out of a matrix with rows `stride` apart, scaled and made symmetric; whether it was. */
static inline int WG_NAME(wg_stiffness_block)(const WG_REAL *C, int32_t stride, WG_REAL scale, WG_REAL block[9]) {
    const WG_REAL xy = scale * C[1], xz = scale * C[2], yz = scale * C[stride + 2];
    const WG_REAL yx = scale * C[stride], zx = scale * C[2 * stride], zy = scale * C[2 * stride + 1];
    block[0] = scale * C[0];
    block[4] = scale * C[stride + 1];
    block[8] = scale * C[2 * stride + 2];
    block[1] = block[3] = WG_C(0.5) * (xy + yx);
    block[2] = block[6] = WG_C(0.5) * (xz + zx);
    block[5] = block[7] = WG_C(0.5) * (yz + zy);
    return WG_ABS(xy - yx) + WG_ABS(xz - zx) + WG_ABS(yz - zy) <= WG_ALIKE * (block[0] + block[4] + block[8]);
}

/* Whether feet share links: 1, or 0; -1 where C is not symmetric. */
static inline int WG_NAME(wg_stiffness_shares)(const struct WG_NAME(wg_contact_elastic) * stand) {
    const int32_t n = 3 * stand->feet;
    int32_t i, j;
    WG_REAL apart = WG_C(0.0), shared = WG_C(0.0);
    for (i = 0; i < n; ++i) {
        for (j = 0; j < i - i % 3; ++j) {
            const WG_REAL one = stand->compliance[i * n + j], other = stand->compliance[j * n + i];
            apart = WG_MAX(apart, WG_ABS(one - other));
            shared = WG_MAX(shared, WG_ABS(one));
        }
    }
    return apart <= WG_ALIKE * stand->yield ? shared > WG_C(0.0) || apart > WG_C(0.0) : -1;
}

/* Read, spread, and blank what has no answer. `matrix` has room for 3k (3k + 7) numbers, NULL where compliance is [k,3,3]. */
static inline void WG_NAME(wg_stiffness_run)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                             const WG_REAL *wrench,
                                             const WG_REAL *compliance, const WG_REAL *misfit, WG_REAL *matrix, WG_REAL *f, int32_t *status,
                                             int32_t *state, WG_REAL *displacement, WG_REAL *violation) {
    struct WG_NAME(wg_contact_elastic) stand;
    const int32_t stride = matrix == NULL ? 3 : 3 * k, skip = matrix == NULL ? 9 : 9 * k + 3;
    int32_t i;
    int fine;
    stand.matrix = matrix;
    stand.compliance = compliance;
    stand.yield = WG_NAME(wg_elastic_size)(compliance, 3 * k * stride);
    stand.scale = WG_C(1.0) / stand.yield;
    fine = stand.yield > WG_C(0.0);
    for (i = 0; i < k && fine; ++i) {
        fine = WG_NAME(wg_stiffness_block)(compliance + skip * i, stride, stand.scale, stand.block[i]);
    }
    *violation = WG_NAN;
    *status = fine ? WG_NAME(wg_elastic_place)(k, points, normals, mu, wrench, misfit, &stand) : WALKGEN_BAD_INPUT;
    if (*status == WALKGEN_OK && matrix != NULL) {
        fine = WG_NAME(wg_stiffness_shares)(&stand);
        *status = fine < 0 ? WALKGEN_BAD_INPUT : WALKGEN_OK;
        stand.matrix = fine == 0 ? NULL : matrix;
    }
    if (*status == WALKGEN_OK) {
        *status = WG_NAME(wg_stiffness_spread)(&stand, f, state, displacement, violation);
    }
    if (*status != WALKGEN_OK) {
        WG_NAME(wg_stiffness_blank)(k, f, state, displacement);
    }
}

/* Forces for compliances [k,3,3] of legs that share no link.
 *
 * k [1, WALKGEN_MAX_FEET], points, normals (unit), misfit [k,3], mu [k] (may be infinite), wrench [6]; f [k,3], state [k] (0 stick, 1
 * slide, 2 free), displacement [6] of the first platform (of the frame's origin, rotation), violation (N): what lacks of balance and cones.
 * Without an answer (INFEASIBLE: no forces in the cones carry the load, violation is how much of it; NO_CONVERGENCE: forces in the cones
 * do, but no lifting and sliding was found that makes them; SINGULAR: fewer than three feet or feet on a line; BAD_INPUT) f is NaN.
 */
static inline void WG_NAME(wg_contact_stiffness_blocks)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                                        const WG_REAL *wrench, const WG_REAL *compliance, const WG_REAL *misfit, WG_REAL *f,
                                                        int32_t *status, int32_t *state, WG_REAL *displacement, WG_REAL *violation) {
    if (k < 1 || k > WALKGEN_MAX_FEET) {
        WG_NAME(wg_stiffness_blank)(0, f, state, displacement);
        *violation = WG_NAN;
        *status = WALKGEN_BAD_INPUT;
        return;
    }
    WG_NAME(wg_stiffness_run)(k, points, normals, mu, wrench, compliance, misfit, NULL, f, status, state, displacement, violation);
}

/* The same for a compliance [3k,3k] of feet that may share links: connecting chains, soles. */
static inline void WG_NAME(wg_contact_stiffness)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu,
                                                 const WG_REAL *wrench, const WG_REAL *compliance, const WG_REAL *misfit, WG_REAL *f,
                                                 int32_t *status, int32_t *state, WG_REAL *displacement, WG_REAL *violation) {
    WG_REAL matrix[3 * WALKGEN_MAX_FEET * (3 * WALKGEN_MAX_FEET + 7)];
    if (k < 1 || k > WALKGEN_MAX_FEET) {
        WG_NAME(wg_stiffness_blank)(0, f, state, displacement);
        *violation = WG_NAN;
        *status = WALKGEN_BAD_INPUT;
        return;
    }
    WG_NAME(wg_stiffness_run)(k, points, normals, mu, wrench, compliance, misfit, matrix, f, status, state, displacement, violation);
}

#undef WG_ALIKE
#undef WG_FAIR
#endif
