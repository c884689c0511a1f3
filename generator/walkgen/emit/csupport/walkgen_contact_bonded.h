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

/* x = K^-1 x for K = [A, B'; B, D], all 3 by 3, A and D symmetric; whether K is positive. */
static inline int WG_NAME(wg_bonded_resolve)(const WG_REAL A[9], const WG_REAL B[9], const WG_REAL D[9], WG_REAL x[6]) {
    WG_REAL across[9], M[9], S[9], inner[9], right[3];
    int fine = WG_NAME(wg_bonded_invert)(A, across);
    int j, m;
    for (j = 0; j < 3; ++j) {
        for (m = 0; m < 3; ++m) {
            M[3 * j + m] = WG_NAME(wg_elastic_dot)(B + 3 * j, across + 3 * m);
        }
        right[j] = x[3 + j] - WG_NAME(wg_elastic_dot)(M + 3 * j, x);
    }
    for (j = 0; j < 3; ++j) {
        for (m = 0; m < 3; ++m) {
            S[3 * j + m] = D[3 * j + m] - WG_NAME(wg_elastic_dot)(M + 3 * j, B + 3 * m);
        }
        fine &= S[4 * j] > WG_LEAST * D[4 * j];
    }
    fine &= WG_NAME(wg_bonded_invert)(S, inner);
    for (j = 0; j < 3; ++j) {
        x[3 + j] = WG_NAME(wg_elastic_dot)(inner + 3 * j, right);
    }
    for (j = 0; j < 3; ++j) {
        right[j] = x[j] - B[j] * x[3] - B[3 + j] * x[4] - B[6 + j] * x[5];
    }
    for (j = 0; j < 3; ++j) {
        x[j] = WG_NAME(wg_elastic_dot)(across + 3 * j, right);
    }
    return fine;
}

/* A foot's stiffness S added to A, [r] S to B, [r] S [r]' to D. */
static inline void WG_NAME(wg_bonded_add)(const WG_REAL r[3], const WG_REAL S[9], WG_REAL A[9], WG_REAL B[9], WG_REAL D[9]) {
    WG_REAL H[9], row[3];
    int j, m;
    for (j = 0; j < 3; ++j) { /* [r] S by columns, as S is symmetric */
        WG_NAME(wg_elastic_cross)(r, S + 3 * j, row);
        for (m = 0; m < 3; ++m) {
            H[3 * m + j] = row[m];
        }
    }
    for (j = 0; j < 9; ++j) {
        A[j] += S[j];
        B[j] += H[j];
    }
    for (j = 0; j < 3; ++j) {
        WG_NAME(wg_elastic_cross)(r, H + 3 * j, row);
        for (m = 0; m < 3; ++m) {
            D[3 * j + m] += row[m];
        }
    }
}

/* Feet that stick, each on a leg of its own: OK, BAD_INPUT where a leg's compliance is not positive, SINGULAR where feet are on a line. */
static inline int32_t WG_NAME(wg_bonded_blocks)(const struct WG_NAME(wg_contact_elastic) * stand, struct WG_NAME(wg_contact_stand) * at) {
    WG_REAL S[WALKGEN_MAX_FEET][9], A[9], B[9], D[9], force[3], row[3];
    int32_t i;
    int j, fine = 1;
    for (j = 0; j < 9; ++j) {
        A[j] = B[j] = D[j] = WG_C(0.0);
    }
    for (j = 0; j < 6; ++j) {
        at->delta[j] = stand->w[j];
    }
    for (i = 0; i < stand->feet; ++i) {
        fine &= WG_NAME(wg_bonded_invert)(stand->block[i], S[i]);
        WG_NAME(wg_bonded_add)(stand->r[i], S[i], A, B, D);
        for (j = 0; j < 3; ++j) {
            force[j] = WG_NAME(wg_elastic_dot)(S[i] + 3 * j, stand->e[i]);
        }
        WG_NAME(wg_elastic_gather)(stand->r[i], force, WG_C(-1.0), at->delta, 1);
    }
    if (!fine) {
        return WALKGEN_BAD_INPUT;
    }
    if (!WG_NAME(wg_bonded_resolve)(A, B, D, at->delta)) {
        return WALKGEN_SINGULAR;
    }
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
static inline int WG_NAME(wg_bonded_presses)(const struct WG_NAME(wg_contact_elastic) * stand,
                                             const struct WG_NAME(wg_contact_stand) * at) {
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
