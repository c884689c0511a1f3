/* walkgen_contact_slide.h: feet that may lift off and slide, found by Newton's method; walkgen_math.h explains the macros.
 *
 * A foot's state is read off its force less rho times its displacement (Alart and Curnier 1991): free where that pulls, sticking where it
 * lies in the cone of friction, else sliding against the displacement. Where a force is what its state makes of it, all conditions hold.
 */
#include "walkgen_contact_elastic.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_SLIDE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_SLIDE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_SLIDE_F64
#define WG_CLOSE WG_C(1e-12)
#else
#define WALKGEN_CONTACT_SLIDE_F32
#define WG_CLOSE WG_C(3e-6)
#endif

#ifndef WG_CONTACT_STICK
#define WG_CONTACT_STICK 0
#define WG_CONTACT_SLIDE 1
#define WG_CONTACT_FREE 2
#endif
#define WG_SLIDE_STEPS 40

/* What the feet's states are read off: `normal` forces, `pushing` across the normals and its `size`; `off` is what forces
 * lack of what their states make of them, `merit` that and what lacks of the balance, squared. Springs of stiffness `hold`
 * keep the platform where it is. */
struct WG_NAME(wg_contact_states) {
    int32_t state[WALKGEN_MAX_FEET];
    WG_REAL hold;
    WG_REAL rho[WALKGEN_MAX_FEET], normal[WALKGEN_MAX_FEET], pushing[WALKGEN_MAX_FEET][3], size[WALKGEN_MAX_FEET];
    WG_REAL off[WALKGEN_MAX_FEET][3], merit;
};

/* One foot's state, and how far its force is from what that makes of it. */
static inline void WG_NAME(wg_slide_judge)(const struct WG_NAME(wg_contact_elastic) * stand, const struct WG_NAME(wg_contact_stand) * at,
                                           int32_t i, struct WG_NAME(wg_contact_states) * states) {
    const WG_REAL *n = stand->n[i], rho = states->rho[i], N = WG_NAME(wg_elastic_dot)(n, at->f[i]),
        gap = WG_NAME(wg_elastic_dot)(n, at->u[i]);
    const WG_REAL pressing = N - rho * gap;
    WG_REAL *T = states->pushing[i], most, share = WG_C(1.0);
    int j;
    for (j = 0; j < 3; ++j) {
        T[j] = at->f[i][j] - N * n[j] - rho * (at->u[i][j] - gap * n[j]);
    }
    states->normal[i] = N;
    states->size[i] = WG_SQRT(WG_NAME(wg_elastic_dot)(T, T));
    if (!(pressing > WG_C(0.0))) {
        states->state[i] = WG_CONTACT_FREE;
        for (j = 0; j < 3; ++j) {
            states->off[i][j] = at->f[i][j];
        }
        return;
    }
    most = stand->mu[i] * pressing;
    states->state[i] = states->size[i] <= most ? WG_CONTACT_STICK : WG_CONTACT_SLIDE;
    if (states->state[i] == WG_CONTACT_SLIDE) {
        share = most / states->size[i];
    }
    for (j = 0; j < 3; ++j) {
        states->off[i][j] = at->f[i][j] - pressing * n[j] - share * T[j];
    }
}

/* All feet's states; the displacements are found first. */
static inline void WG_NAME(wg_slide_states)(const struct WG_NAME(wg_contact_elastic) * stand, struct WG_NAME(wg_contact_stand) * at,
                                            struct WG_NAME(wg_contact_states) * states) {
    WG_REAL lacking[6];
    int32_t i;
    for (i = 0; i < 6; ++i) {
        lacking[i] = stand->w[i] - states->hold * at->delta[i];
    }
    WG_NAME(wg_elastic_displace)(stand, at);
    states->merit = WG_C(0.0);
    for (i = 0; i < stand->feet; ++i) {
        WG_NAME(wg_slide_judge)(stand, at, i, states);
        WG_NAME(wg_elastic_gather)(stand->r[i], at->f[i], WG_C(1.0), lacking, 1);
        states->merit += WG_NAME(wg_elastic_dot)(states->off[i], states->off[i]);
    }
    states->merit += WG_NAME(wg_elastic_dot)(lacking, lacking) + WG_NAME(wg_elastic_dot)(lacking + 3, lacking + 3);
}

/* The linear condition P f + Q u = 0 of a foot in its state. */
static inline void WG_NAME(wg_slide_condition)(const struct WG_NAME(wg_contact_elastic) * stand,
                                               const struct WG_NAME(wg_contact_states) * states, int32_t i, WG_REAL P[9], WG_REAL Q[9]) {
    const WG_REAL *n = stand->n[i], size = states->size[i], N = WG_MAX(states->normal[i], WG_C(0.0));
    const WG_REAL share = states->state[i] == WG_CONTACT_SLIDE ? WG_MIN(stand->mu[i] * N / size, WG_C(1.0)) : WG_C(0.0);
    int row, column;
    for (row = 0; row < 3; ++row) {
        for (column = 0; column < 3; ++column) {
            const WG_REAL one = row == column ? WG_C(1.0) : WG_C(0.0), flat = one - n[row] * n[column];
            WG_REAL t, across;
            int place = 3 * row + column;
            if (states->state[i] != WG_CONTACT_SLIDE) {
                P[place] = states->state[i] == WG_CONTACT_FREE ? one : WG_C(0.0);
                Q[place] = states->state[i] == WG_CONTACT_FREE ? WG_C(0.0) : one;
                continue;
            }
            t = states->pushing[i][row] / size;
            across = flat - t * (states->pushing[i][column] / size);
            P[place] = flat - share * across - stand->mu[i] * t * n[column];
            Q[place] = n[row] * n[column] + share * states->rho[i] * across;
        }
    }
}

/* Forces f and their slopes X by the platform's motion from all feet's conditions, f - X delta; whether the feet allow it. */
static inline int WG_NAME(wg_slide_blocks)(const struct WG_NAME(wg_contact_elastic) * stand,
                                           const struct WG_NAME(wg_contact_states) * states,
                                           WG_REAL f[WALKGEN_MAX_FEET][3], WG_REAL X[WALKGEN_MAX_FEET][3][6]) {
    WG_REAL P[9], Q[9], A[3 * 7], turn[3];
    int32_t i;
    int row, column, m, fine = 1;
    for (i = 0; i < stand->feet; ++i) {
        const WG_REAL *C = stand->block[i];
        WG_NAME(wg_slide_condition)(stand, states, i, P, Q);
        for (row = 0; row < 3; ++row) {
            for (column = 0; column < 3; ++column) {
                A[7 * row + column] = P[3 * row + column];
                for (m = 0; m < 3; ++m) {
                    A[7 * row + column] += Q[3 * row + m] * C[3 * m + column];
                }
                A[7 * row + 4 + column] = Q[3 * row + column];
            }
            A[7 * row + 3] = -WG_NAME(wg_elastic_dot)(Q + 3 * row, stand->e[i]);
        }
        fine &= WG_NAME(wg_elastic_eliminate)(3, 4, A);
        for (row = 0; row < 3; ++row) {
            f[i][row] = A[7 * row + 3];
            WG_NAME(wg_elastic_cross)(stand->r[i], A + 7 * row + 4, turn);
            for (m = 0; m < 3; ++m) {
                X[i][row][m] = A[7 * row + 4 + m];
                X[i][row][3 + m] = turn[m];
            }
        }
    }
    return fine;
}

/* The same where the feet share links. */
static inline int WG_NAME(wg_slide_coupled)(const struct WG_NAME(wg_contact_elastic) * stand,
                                            const struct WG_NAME(wg_contact_states) * states,
                                            WG_REAL f[WALKGEN_MAX_FEET][3], WG_REAL X[WALKGEN_MAX_FEET][3][6]) {
    const int32_t n = 3 * stand->feet, width = n + 7;
    WG_REAL P[9], Q[9], turn[3], *row;
    int32_t i, j, column, m;
    for (i = 0; i < stand->feet; ++i) {
        WG_NAME(wg_slide_condition)(stand, states, i, P, Q);
        for (j = 0; j < 3; ++j) {
            row = stand->matrix + (3 * i + j) * width;
            for (column = 0; column < n; ++column) {
                row[column] = column / 3 == i ? P[3 * j + column % 3] : WG_C(0.0);
                for (m = 0; m < 3; ++m) {
                    row[column] += Q[3 * j + m] * WG_NAME(wg_elastic_entry)(stand, 3 * i + m, column);
                }
            }
            row[n] = -WG_NAME(wg_elastic_dot)(Q + 3 * j, stand->e[i]);
            WG_NAME(wg_elastic_cross)(stand->r[i], Q + 3 * j, turn);
            for (m = 0; m < 3; ++m) {
                row[n + 1 + m] = Q[3 * j + m];
                row[n + 4 + m] = turn[m];
            }
        }
    }
    if (!WG_NAME(wg_elastic_eliminate)(n, 7, stand->matrix)) {
        return 0;
    }
    for (i = 0; i < n; ++i) {
        f[i / 3][i % 3] = stand->matrix[i * width + n];
        for (m = 0; m < 6; ++m) {
            X[i / 3][i % 3][m] = stand->matrix[i * width + n + 1 + m];
        }
    }
    return 1;
}

/* The platform's motion at which the feet's forces f - X delta balance: whether there is one. Where the feet leave the platform a motion,
 * springs hold it. */
static inline int WG_NAME(wg_slide_move)(const struct WG_NAME(wg_contact_elastic) * stand, WG_REAL hold,
                                         WG_REAL X[WALKGEN_MAX_FEET][3][6], struct WG_NAME(wg_contact_stand) * to) {
    WG_REAL K[6 * 7], held[6 * 7];
    const WG_REAL *found = K + 6;
    int32_t i;
    int j, m;
    for (j = 0; j < 42; ++j) {
        K[j] = j % 7 == 6 ? stand->w[j / 7] : WG_C(0.0);
    }
    for (i = 0; i < stand->feet; ++i) {
        for (m = 0; m < 6; ++m) {
            const WG_REAL push[3] = {X[i][0][m], X[i][1][m], X[i][2][m]};
            WG_NAME(wg_elastic_gather)(stand->r[i], push, WG_C(1.0), K + m, 7);
        }
        WG_NAME(wg_elastic_gather)(stand->r[i], to->f[i], WG_C(1.0), K + 6, 7);
    }
    for (j = 0; j < 42; ++j) {
        K[j] += j % 8 == 0 ? hold : WG_C(0.0);
        held[j] = K[j] + (j % 8 == 0 ? WG_C(0.01) : WG_C(0.0));
    }
    if (!WG_NAME(wg_elastic_eliminate)(6, 1, K)) {
        if (!WG_NAME(wg_elastic_eliminate)(6, 1, held)) {
            return 0;
        }
        found = held + 6;
    }
    for (j = 0; j < 6; ++j) {
        to->delta[j] = found[7 * j];
    }
    return 1;
}

/* The stand that all feet's conditions make: whether there is one. */
static inline int WG_NAME(wg_slide_solve)(const struct WG_NAME(wg_contact_elastic) * stand,
                                          const struct WG_NAME(wg_contact_states) * states,
                                          struct WG_NAME(wg_contact_stand) * to) {
    WG_REAL X[WALKGEN_MAX_FEET][3][6];
    int32_t i;
    int j, m;
    if (!(stand->matrix == NULL ? WG_NAME(wg_slide_blocks)(stand, states, to->f, X) : WG_NAME(wg_slide_coupled)(stand, states, to->f, X)) ||
        !WG_NAME(wg_slide_move)(stand, states->hold, X, to)) {
        return 0;
    }
    for (i = 0; i < stand->feet; ++i) {
        for (j = 0; j < 3; ++j) {
            for (m = 0; m < 6; ++m) {
                to->f[i][j] -= X[i][j][m] * to->delta[m];
            }
        }
    }
    return 1;
}

/* from + share (to - from) */
static inline void WG_NAME(wg_slide_between)(int32_t k, const struct WG_NAME(wg_contact_stand) * from,
                                             const struct WG_NAME(wg_contact_stand) * to,
                                             WG_REAL share, struct WG_NAME(wg_contact_stand) * at) {
    int32_t i;
    int j;
    for (j = 0; j < 6; ++j) {
        at->delta[j] = from->delta[j] + share * (to->delta[j] - from->delta[j]);
    }
    for (i = 0; i < k; ++i) {
        for (j = 0; j < 3; ++j) {
            at->f[i][j] = from->f[i][j] + share * (to->f[i][j] - from->f[i][j]);
        }
    }
}

/* Newton's steps, cut where they do not help, some taken all the same: whether all conditions hold at the end. */
static inline int WG_NAME(wg_slide_newton)(const struct WG_NAME(wg_contact_elastic) * stand, struct WG_NAME(wg_contact_stand) * at,
                                           struct WG_NAME(wg_contact_states) * states) {
    struct WG_NAME(wg_contact_stand) to, trial;
    struct WG_NAME(wg_contact_states) next = *states;
    WG_REAL share;
    int step, cut;
    WG_NAME(wg_slide_states)(stand, at, states);
    for (step = 0; step < WG_SLIDE_STEPS; ++step) {
        if (states->merit <= WG_CLOSE * WG_CLOSE) {
            return 1;
        }
        if (!WG_NAME(wg_slide_solve)(stand, states, &to)) {
            return 0;
        }
        share = WG_C(1.0);
        for (cut = 0; cut < 6; ++cut) {
            WG_NAME(wg_slide_between)(stand->feet, at, &to, share, &trial);
            WG_NAME(wg_slide_states)(stand, &trial, &next);
            if (next.merit < (WG_C(1.0) - WG_C(2e-3) * share) * states->merit) {
                break;
            }
            share *= WG_C(0.5);
        }
        if (cut == 6 && step % 3) {
            WG_NAME(wg_slide_between)(stand->feet, at, &to, WG_C(1.0), &trial);
            WG_NAME(wg_slide_states)(stand, &trial, &next);
        }
        *at = trial;
        *states = next;
    }
    return 0;
}

#undef WG_CLOSE
#undef WG_SLIDE_STEPS
#endif
