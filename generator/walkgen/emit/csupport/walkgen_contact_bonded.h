/* walkgen_contact_bonded.h: elastic legs whose feet all stick, a closed form (theory 4.3); walkgen_math.h explains the macros. */
#include "walkgen_contact_slide.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_BONDED_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_BONDED_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_BONDED_F64
#define WG_LEAST WG_C(1e-12)
#else
#define WALKGEN_CONTACT_BONDED_F32
#define WG_LEAST WG_C(1e-6)
#endif

/* S = C^-1 of a foot, both symmetric; whether C is positive. */
static inline int WG_NAME(wg_bonded_invert)(const WG_REAL C[9], WG_REAL S[9]) {
    const WG_REAL xx = C[4] * C[8] - C[5] * C[5], xy = C[2] * C[5] - C[1] * C[8], xz = C[1] * C[5] - C[2] * C[4];
    const WG_REAL yy = C[0] * C[8] - C[2] * C[2], yz = C[1] * C[2] - C[0] * C[5], zz = C[0] * C[4] - C[1] * C[1];
    const WG_REAL determinant = C[0] * xx + C[1] * xy + C[2] * xz, inverse = WG_C(1.0) / determinant;
    S[0] = inverse * xx;
    S[1] = S[3] = inverse * xy;
    S[2] = S[6] = inverse * xz;
    S[4] = inverse * yy;
    S[5] = S[7] = inverse * yz;
    S[8] = inverse * zz;
    return (C[0] > WG_C(0.0)) & (zz > WG_LEAST * C[0] * C[4]) & (determinant > WG_LEAST * zz * C[8]);
}

/* Feet that stick, each on a leg of its own: OK, BAD_INPUT where a leg's compliance is not positive, SINGULAR where feet are on a line. */
static inline int32_t WG_NAME(wg_bonded_blocks)(const struct WG_NAME(wg_contact_elastic) * stand, struct WG_NAME(wg_contact_stand) * at) {
    WG_REAL S[WALKGEN_MAX_FEET][9], K[36] = {WG_C(0.0)}, H[3][3], force[3], row[3];
    int32_t i;
    int j, m, fine = 1;
    for (j = 0; j < 6; ++j) {
        at->delta[j] = stand->w[j];
    }
    for (i = 0; i < stand->feet; ++i) {
        fine &= WG_NAME(wg_bonded_invert)(stand->block[i], S[i]);
        for (j = 0; j < 3; ++j) { /* rows of S are columns: H[j] = r x S e_j; K = [S, H; H', r x S x r'], lower triangle */
            WG_NAME(wg_elastic_cross)(stand->r[i], S[i] + 3 * j, H[j]);
            force[j] = WG_NAME(wg_elastic_dot)(S[i] + 3 * j, stand->e[i]);
            for (m = 0; m <= j; ++m) {
                K[6 * j + m] += S[i][3 * j + m];
            }
            for (m = 0; m < 3; ++m) {
                K[6 * (3 + m) + j] += H[j][m];
            }
        }
        for (m = 0; m < 3; ++m) {
            const WG_REAL column[3] = {H[0][m], H[1][m], H[2][m]};
            WG_NAME(wg_elastic_cross)(stand->r[i], column, row);
            for (j = 0; j <= m; ++j) {
                K[6 * (3 + m) + 3 + j] += row[j];
            }
        }
        WG_NAME(wg_elastic_gather)(stand->r[i], force, WG_C(-1.0), at->delta, 1);
    }
    if (!fine) {
        return WALKGEN_BAD_INPUT;
    }
    if (!WG_NAME(wg_elastic_factor)(6, 6, K)) {
        return WALKGEN_SINGULAR;
    }
    WG_NAME(wg_elastic_resolve)(6, 6, K, at->delta);
    for (i = 0; i < stand->feet; ++i) {
        WG_NAME(wg_elastic_moved)(stand->r[i], at->delta, row);
        for (j = 0; j < 3; ++j) {
            row[j] += stand->e[i][j];
        }
        for (j = 0; j < 3; ++j) {
            at->f[i][j] = -WG_NAME(wg_elastic_dot)(S[i] + 3 * j, row);
        }
    }
    return WALKGEN_OK;
}

/* The same where feet share links. */
static inline int32_t WG_NAME(wg_bonded_coupled)(const struct WG_NAME(wg_contact_elastic) * stand,
                                                           struct WG_NAME(wg_contact_stand) * at) {
    struct WG_NAME(wg_contact_states) states;
    const int32_t n = 3 * stand->feet;
    WG_REAL K[36];
    int32_t i, j;
    for (i = 0; i < n; ++i) {
        states.state[i / 3] = WG_CONTACT_STICK;
        states.hold = WG_C(0.0);
        for (j = 0; j < n; ++j) {
            stand->matrix[i * n + j] = WG_NAME(wg_elastic_entry)(stand, i, j);
        }
    }
    if (!WG_NAME(wg_elastic_factor)(n, n, stand->matrix)) {
        return WALKGEN_BAD_INPUT;
    }
    for (i = 0; i < 36; ++i) {
        K[i] = WG_C(0.0);
    }
    for (i = 0; i < stand->feet; ++i) { /* the feet's own spread, whatever their legs: the motion that moves none is missing */
        for (j = 0; j < 6; ++j) {
            WG_REAL unit[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
            WG_REAL moved[3];
            unit[j] = WG_C(1.0);
            WG_NAME(wg_elastic_moved)(stand->r[i], unit, moved);
            WG_NAME(wg_elastic_gather)(stand->r[i], moved, WG_C(1.0), K + j, 6);
        }
    }
    if (!WG_NAME(wg_elastic_factor)(6, 6, K)) {
        return WALKGEN_SINGULAR;
    }
    return WG_NAME(wg_slide_solve)(stand, &states, at) ? WALKGEN_OK : WALKGEN_SINGULAR;
}

/* Whether all feet press and stay in their cones. */
static inline int WG_NAME(wg_bonded_presses)(const struct WG_NAME(wg_contact_elastic) * stand, const struct WG_NAME(wg_contact_stand) * at) {
    int32_t i;
    int fine = 1;
    for (i = 0; i < stand->feet; ++i) {
        const WG_REAL N = WG_NAME(wg_elastic_dot)(stand->n[i], at->f[i]), most = stand->mu[i] * N;
        WG_REAL T[3];
        int j;
        for (j = 0; j < 3; ++j) {
            T[j] = at->f[i][j] - N * stand->n[i][j];
        }
        fine &= (N > WG_C(0.0)) & (WG_NAME(wg_elastic_dot)(T, T) <= most * most);
    }
    return fine;
}

#undef WG_LEAST
#endif
