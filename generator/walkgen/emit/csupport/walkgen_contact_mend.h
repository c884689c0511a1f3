/* walkgen_contact_mend.h: multipliers that prove but for rounding that a load cannot be carried, made a strict proof; walkgen_math.h
 * explains the macros.
 *
 * Near the edge a proof's gain may be 1e-6 of its multipliers, and where feet nearly can press against each other, rounding lets rays of
 * cones gain 1e-14 of them, without bound. The least move of the multipliers that takes this away costs little of the gain.
 */
#include "walkgen_contact_newton.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_MEND_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_MEND_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_MEND_F64
#define WG_SLACK WG_C(1e-9)
#define WG_HAIR WG_C(1e-12)
#else
#define WALKGEN_CONTACT_MEND_F32
#define WG_SLACK WG_C(1e-4)
#define WG_HAIR WG_C(1e-5)
#endif

/* What forces f give the balance: A f, without the load, in which they would drown. */
static inline void WG_NAME(wg_contact_given)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[3][WALKGEN_MAX_FEET],
                                             WG_REAL given[6]) {
    int i, j;
    for (j = 0; j < 6; ++j) {
        given[j] = WG_C(0.0);
    }
    for (i = 0; i < stance->feet; ++i) {
        const WG_REAL r[3] = {stance->r[0][i], stance->r[1][i], stance->r[2][i]}, force[3] = {f[0][i], f[1][i], f[2][i]};
        WG_REAL moment[3];
        WG_NAME(wg_cross)(r, force, moment);
        for (j = 0; j < 3; ++j) {
            given[j] += force[j];
            given[3 + j] += stance->lost[j] ? WG_C(0.0) : moment[j];
        }
    }
}

/* What y must lose: of cones that gain by it, or nearly, along their rays of most gain more than -`spare` as forces, and the rays' squares
 * in `slope`; where y leaves a foot at rest, all of that in all directions. */
static inline void WG_NAME(wg_contact_rays)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL near,
                                            WG_REAL spare,
                                            WG_REAL slope[6][WALKGEN_MAX_FEET], WG_REAL f[3][WALKGEN_MAX_FEET]) {
    static const int place[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
    WG_REAL z[3][WALKGEN_MAX_FEET];
    int i, j;
    WG_NAME(wg_contact_pull)(stance, y, z);
    for (i = 0; i < stance->feet; ++i) {
        const WG_REAL n[3] = {stance->cones.n[0][i], stance->cones.n[1][i], stance->cones.n[2][i]}, mu = stance->cones.mu[i];
        const WG_REAL N = n[0] * z[0][i] + n[1] * z[1][i] + n[2] * z[2][i];
        const WG_REAL T[3] = {z[0][i] - N * n[0], z[1][i] - N * n[1], z[2][i] - N * n[2]}, length = WG_NAME(wg_norm)(T);
        const WG_REAL most = N + mu * length, turn = mu / WG_MAX(length, WG_TINY), chosen = most > -near ? WG_C(1.0) : WG_C(0.0);
        const WG_REAL ray[3] = {n[0] + turn * T[0], n[1] + turn * T[1], n[2] + turn * T[2]};
        const int rests = length <= WG_C(1e-3) * near && N >= -near;
        for (j = 0; j < 3; ++j) {
            f[j][i] = rests ? z[j][i] + (WG_C(1.0) + mu) * spare * n[j] : chosen * (most + spare) * ray[j];
        }
        for (j = 0; j < 6; ++j) {
            slope[j][i] = rests ? WG_INDICATOR(place[j][0] == place[j][1]) : chosen * ray[place[j][0]] * ray[place[j][1]];
            slope[j][i] /= stance->ease[i];
        }
    }
}

/* Whether y is a strict proof whose gain rounding of y does not hide. */
static inline int WG_NAME(wg_contact_strict)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6]) {
    const WG_REAL size = WG_SQRT(WG_NAME(wg_contact_product)(y, y));
    return WG_NAME(wg_contact_proof)(stance, y, WG_C(4.0) * WG_EPSILON, WG_C(0.0)) > WG_HAIR * size;
}

/* y moved least to where no cone gains by it, to the last bit: whether it is a strict proof then. Rounding of large forces hides what the
 * cones' rays nearly lack of pressing against each other, which this finds. */
WG_CALLED int WG_NAME(wg_contact_mend)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_dual) * dual,
                                       WG_REAL y[6]) {
    struct WG_NAME(wg_contact_matrix) H;
    WG_REAL f[3][WALKGEN_MAX_FEET], given[6], step[6];
    int turn, j;
    for (turn = 0; turn < 6; ++turn) {
        const WG_REAL size = WG_SQRT(WG_NAME(wg_contact_product)(y, y));
        if (!(WG_NAME(wg_contact_product)(stance->b, y) > WG_C(0.0))) {
            return 0;
        }
        if (WG_NAME(wg_contact_strict)(stance, y)) {
            return 1;
        }
        WG_NAME(wg_contact_rays)(stance, y, WG_SLACK * size, WG_C(32.0) * WG_EPSILON * size, dual->images.slope, f);
        WG_NAME(wg_contact_given)(stance, f, given);
        WG_NAME(wg_contact_curvature)(stance, dual, WG_C(256.0) * WG_EPSILON, &H);
        WG_NAME(wg_contact_solve)(stance, &H, given, step);
        for (j = 0; j < 6; ++j) {
            y[j] -= step[j];
        }
    }
    return 0;
}

#undef WG_SLACK
#undef WG_HAIR
#endif
