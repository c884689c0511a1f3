/* walkgen_conic_step.h: a step of the interior-point methods of walkgen_conic.h and walkgen_contact_edge.h; walkgen_math.h explains the
 * macros.
 *
 * Nesterov and Todd's scaling (1997), from points that need not fulfil the equations; a step is a least-squares problem of as many unknowns
 * as b, solved by orthogonalisation, as products of matrices would lose half the digits.
 */
#include "walkgen_conic_cones.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONIC_STEP_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONIC_STEP_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONIC_STEP_F64
#else
#define WALKGEN_CONIC_STEP_F32
#endif

/* One more than feet: what bounds their forces can have a cone too. */
#ifndef WALKGEN_MAX_CONES
#define WALKGEN_MAX_CONES (WALKGEN_MAX_FEET + 1)
#endif

/* The problem, of `rows` equations: A by columns, three a cone; `mass` NULL, or x's weights where half of sum mass x^2 is to be least, s
 * and a being 0. The answer: what the first equations and all of them lack at most, and the gap x . z. */
struct WG_NAME(wg_conic) {
    int32_t cones, rows;
    const WG_REAL *mass;
    WG_REAL column[3 * WALKGEN_MAX_CONES][6], b[6], a[6];
    WG_REAL x[3 * WALKGEN_MAX_CONES], z[3 * WALKGEN_MAX_CONES], y[6], s, unbalanced, lacking, gap;
};

/* A step's system: V of every cone (xx, xy, xz, yy, yz, zz) and, with masses, the factor C of 1 + V mass V; V z, V^-1 of the step in x,
 * C^-1 V A' = Q R with Q by columns, R^-T a, R^-T of what A x + s a lacks, what z and a . y lack; and the step. */
struct WG_NAME(wg_conic_step) {
    WG_REAL V[WALKGEN_MAX_CONES][6], C[WALKGEN_MAX_CONES][6], even[3 * WALKGEN_MAX_CONES], scaled[3 * WALKGEN_MAX_CONES];
    WG_REAL Q[6][3 * WALKGEN_MAX_CONES], R[6][6], u[6], primal[6], dual[3 * WALKGEN_MAX_CONES], last;
    WG_REAL dx[3 * WALKGEN_MAX_CONES], dz[3 * WALKGEN_MAX_CONES], dy[6], ds;
};

/* R^-T v in place of v. */
static inline void WG_NAME(wg_conic_down)(int n, WG_REAL R[6][6], WG_REAL v[6]) {
    int i, j;
    for (i = 0; i < n; ++i) {
        for (j = 0; j < i; ++j) {
            v[i] -= R[j][i] * v[j];
        }
        v[i] /= R[i][i];
    }
}

/* V A' made orthonormal, column by column, twice against rounding; whether its columns are independent. */
static inline int WG_NAME(wg_conic_factor)(int n, int size, struct WG_NAME(wg_conic_step) * step) {
    int i, j, c, turn;
    for (i = 0; i < n; ++i) {
        for (j = 0; j < i; ++j) {
            step->R[j][i] = WG_C(0.0);
        }
        for (turn = 0; turn < 2; ++turn) {
            for (j = 0; j < i; ++j) {
                const WG_REAL along = WG_NAME(wg_conic_product)(size, step->Q[j], step->Q[i]);
                step->R[j][i] += along;
                for (c = 0; c < size; ++c) {
                    step->Q[i][c] -= along * step->Q[j][c];
                }
            }
        }
        step->R[i][i] = WG_SQRT(WG_NAME(wg_conic_product)(size, step->Q[i], step->Q[i]));
        if (!(step->R[i][i] > WG_C(0.0) && step->R[i][i] <= WG_HUGE)) {
            return 0;
        }
        for (c = 0; c < size; ++c) {
            step->Q[i][c] /= step->R[i][i];
        }
    }
    return 1;
}

/* What the equations lack at the present point, and its gap. */
static inline void WG_NAME(wg_conic_lack)(struct WG_NAME(wg_conic) * conic, struct WG_NAME(wg_conic_step) * step) {
    const int n = conic->rows, size = 3 * conic->cones;
    int i, c;
    step->last = conic->mass ? WG_C(0.0) : WG_C(1.0) - WG_NAME(wg_conic_product)(n, conic->a, conic->y);
    for (i = 0; i < n; ++i) {
        step->primal[i] = conic->b[i] - conic->s * conic->a[i];
        step->u[i] = conic->a[i];
        for (c = 0; c < size; ++c) {
            step->primal[i] -= conic->column[c][i] * conic->x[c];
        }
    }
    conic->unbalanced = WG_NAME(wg_stance_largest)(step->primal, n);
    conic->lacking = WG_MAX(WG_ABS(step->last), conic->unbalanced);
    for (c = 0; c < size; ++c) {
        step->dual[c] = WG_NAME(wg_conic_product)(n, conic->column[c], conic->y) - conic->z[c];
        step->dual[c] += conic->mass ? conic->mass[c] * conic->x[c] : WG_C(0.0);
        conic->lacking = WG_MAX(conic->lacking, WG_ABS(step->dual[c]));
    }
    conic->gap = WG_NAME(wg_conic_product)(size, conic->x, conic->z);
}

/* Residuals, scalings and the factor at the present point; whether it is one. */
static inline int WG_NAME(wg_conic_prepare)(struct WG_NAME(wg_conic) * conic, struct WG_NAME(wg_conic_step) * step) {
    const int n = conic->rows, size = 3 * conic->cones;
    int i, c;
    WG_NAME(wg_conic_lack)(conic, step);
    for (c = 0; c < size; c += 3) {
        WG_NAME(wg_conic_scaling)(conic->x + c, conic->z + c, step->V[c / 3]);
        WG_NAME(wg_conic_apply)(step->V[c / 3], conic->z + c, step->even + c);
        if (conic->mass) {
            WG_NAME(wg_conic_weigh)(step->V[c / 3], conic->mass + c, step->C[c / 3]);
        }
        for (i = 0; i < n; ++i) {
            const WG_REAL row[3] = {conic->column[c][i], conic->column[c + 1][i], conic->column[c + 2][i]};
            WG_NAME(wg_conic_apply)(step->V[c / 3], row, step->Q[i] + c);
            if (conic->mass) {
                WG_NAME(wg_conic_lighten)(step->C[c / 3], 0, step->Q[i] + c);
            }
        }
    }
    if (!WG_NAME(wg_conic_factor)(n, size, step)) {
        return 0;
    }
    WG_NAME(wg_conic_down)(n, step->R, step->u);
    WG_NAME(wg_conic_down)(n, step->R, step->primal);
    return 1;
}

/* The right side of the step towards complementarity x z = target in all cones; after a step towards 0, what that missed is taken off. */
static inline void WG_NAME(wg_conic_target)(const struct WG_NAME(wg_conic) * conic, WG_REAL target, struct WG_NAME(wg_conic_step) * step) {
    WG_REAL moved[3], missed[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    int j, c;
    for (c = 0; c < 3 * conic->cones; c += 3) {
        const WG_REAL *even = step->even + c;
        const WG_REAL level = WG_SQRT(WG_NAME(wg_conic_size)(conic->x + c)) * WG_SQRT(WG_NAME(wg_conic_size)(conic->z + c));
        const WG_REAL share = target / level;
        WG_REAL *g = step->scaled + c;
        if (target > WG_C(0.0)) {
            WG_NAME(wg_conic_missed)(even, level, g, missed);
        }
        WG_NAME(wg_conic_apply)(step->V[c / 3], step->dual + c, moved);
        for (j = 0; j < 3; ++j) {
            g[j] = (j == 0 ? share - WG_C(1.0) : -share - WG_C(1.0)) * even[j] - moved[j] - missed[j];
        }
        if (conic->mass) {
            WG_NAME(wg_conic_lighten)(step->C[c / 3], 0, g);
        }
    }
}

/* h = R dy by what the equations ask for, and ds; the right side's rest. */
static inline void WG_NAME(wg_conic_project)(const struct WG_NAME(wg_conic) * conic, struct WG_NAME(wg_conic_step) * step, WG_REAL h[6]) {
    const int n = conic->rows, size = 3 * conic->cones;
    int i, c;
    for (i = 0; i < n; ++i) {
        h[i] = WG_NAME(wg_conic_product)(size, step->Q[i], step->scaled) - step->primal[i];
    }
    step->ds = WG_C(0.0);
    if (!conic->mass) { /* bounded, as rounding of forces would hide the load where s has no bound */
        step->ds = (step->last - WG_NAME(wg_conic_product)(n, step->u, h)) / WG_NAME(wg_conic_product)(n, step->u, step->u);
        step->ds = WG_MIN(step->ds, WG_C(10.0) * (WG_C(1.0) + WG_ABS(conic->s)));
    }
    for (i = 0; i < n; ++i) {
        h[i] += step->ds * step->u[i];
        for (c = 0; c < size; ++c) {
            step->scaled[c] -= h[i] * step->Q[i][c];
        }
    }
}

/* The step towards complementarity x z = target in all cones. */
static inline void WG_NAME(wg_conic_aim)(const struct WG_NAME(wg_conic) * conic, WG_REAL target, struct WG_NAME(wg_conic_step) * step) {
    const int n = conic->rows, size = 3 * conic->cones;
    WG_REAL h[6];
    int i, j, c;
    WG_NAME(wg_conic_target)(conic, target, step);
    WG_NAME(wg_conic_project)(conic, step, h);
    for (i = n - 1; i >= 0; --i) {
        step->dy[i] = h[i];
        for (j = i + 1; j < n; ++j) {
            step->dy[i] -= step->R[i][j] * step->dy[j];
        }
        step->dy[i] /= step->R[i][i];
    }
    for (c = 0; c < size; ++c) {
        if (c % 3 == 0) {
            if (conic->mass) {
                WG_NAME(wg_conic_lighten)(step->C[c / 3], 1, step->scaled + c);
            }
            WG_NAME(wg_conic_apply)(step->V[c / 3], step->scaled + c, step->dx + c);
        }
        step->dz[c] = WG_NAME(wg_conic_product)(n, conic->column[c], step->dy) + step->dual[c];
        step->dz[c] += conic->mass ? conic->mass[c] * step->dx[c] : WG_C(0.0);
    }
}

/* The point moved along the step; whether it stays one. */
static inline int WG_NAME(wg_conic_move)(const struct WG_NAME(wg_conic_step) * step, WG_REAL primal, WG_REAL dual,
                                         struct WG_NAME(wg_conic) * conic) {
    WG_REAL y[6];
    int i;
    for (i = 0; i < conic->rows; ++i) {
        y[i] = conic->y[i] + dual * step->dy[i];
    }
    if (!(WG_ABS(conic->s + primal * step->ds) <= WG_HUGE && WG_NAME(wg_stance_finite)(y, conic->rows)) ||
        !WG_NAME(wg_conic_stays)(conic->cones, conic->x, step->dx, primal) ||
        !WG_NAME(wg_conic_stays)(conic->cones, conic->z, step->dz, dual)) {
        return 0;
    }
    for (i = 0; i < 3 * conic->cones; ++i) {
        conic->x[i] += primal * step->dx[i];
        conic->z[i] += dual * step->dz[i];
    }
    for (i = 0; i < conic->rows; ++i) {
        conic->y[i] = y[i];
    }
    conic->s += primal * step->ds;
    return 1;
}

/* Mehrotra's step: towards the answer, and again with what that missed, keeping to the middle; whether the point could move. */
static inline int WG_NAME(wg_conic_advance)(struct WG_NAME(wg_conic_step) * step, struct WG_NAME(wg_conic) * conic) {
    const WG_REAL mean = conic->gap / (WG_REAL)conic->cones;
    WG_REAL primal, dual, share;
    WG_NAME(wg_conic_aim)(conic, WG_C(0.0), step);
    primal = WG_NAME(wg_conic_room)(conic->cones, conic->x, step->dx);
    dual = WG_NAME(wg_conic_room)(conic->cones, conic->z, step->dz);
    share = WG_C(1.0) - WG_MIN(WG_C(1.0), WG_MIN(primal, dual));
    WG_NAME(wg_conic_aim)(conic, WG_MAX(share * share * share, WG_C(1e-6)) * mean, step);
    primal = WG_MIN(WG_C(1.0), WG_C(0.98) * WG_NAME(wg_conic_room)(conic->cones, conic->x, step->dx));
    dual = WG_MIN(WG_C(1.0), WG_C(0.98) * WG_NAME(wg_conic_room)(conic->cones, conic->z, step->dz));
    if (conic->mass) { /* one length: x and z share an equation */
        primal = dual = WG_MIN(primal, dual);
    }
    return WG_NAME(wg_conic_move)(step, primal, dual, conic);
}

#endif
