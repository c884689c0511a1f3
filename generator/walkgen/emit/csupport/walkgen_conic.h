/* walkgen_conic.h: how far forces within cones reach along a direction of loads; walkgen_math.h explains the macros.
 *
 *     maximise s   subject to   A x + s a = b,   x_i = (normal, two tangential parts) with normal >= |tangential|
 *     minimise b . y   subject to   z = A' y within the same cones,   a . y = 1
 *
 * A primal-dual interior-point method in Nesterov and Todd's scaling (1997), from points that need not fulfil the equations; a step is
 * a least-squares problem of as many unknowns as b, solved by orthogonalisation, as products of matrices would lose half the digits. The
 * answer is as good as the residuals and the gap that it states.
 */
#include "walkgen_stance.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONIC_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONIC_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONIC_F64
#define WG_SHARP WG_C(2e-15)
#define WG_ROUGH WG_C(1e-9)
#else
#define WALKGEN_CONIC_F32
#define WG_SHARP WG_C(3e-7)
#define WG_ROUGH WG_C(1e-4)
#endif

/* The problem, of `rows` equations: A by columns, three a cone. The answer: what the first equations and all
 * of them lack at most, and the gap x . z. */
struct WG_NAME(wg_conic) {
    int32_t cones, rows;
    WG_REAL column[3 * WALKGEN_MAX_FEET][6], b[6], a[6];
    WG_REAL x[3 * WALKGEN_MAX_FEET], z[3 * WALKGEN_MAX_FEET], y[6], s, unbalanced, lacking, gap;
};

/* A step's system: V of every cone (xx, xy, xz, yy, yz, zz), V z, V^-1 of the step in x, V A' = Q R with Q by columns, R^-T a, R^-T of what A x + s a lacks, what z
 * and a . y lack; and the step. */
struct WG_NAME(wg_conic_step) {
    WG_REAL V[WALKGEN_MAX_FEET][6], even[3 * WALKGEN_MAX_FEET], scaled[3 * WALKGEN_MAX_FEET], Q[6][3 * WALKGEN_MAX_FEET], R[6][6], u[6], primal[6];
    WG_REAL dual[3 * WALKGEN_MAX_FEET], last, dx[3 * WALKGEN_MAX_FEET], dz[3 * WALKGEN_MAX_FEET], dy[6], ds;
};

/* Inner product of rows. */
static inline WG_REAL WG_NAME(wg_conic_product)(int n, const WG_REAL *a, const WG_REAL *b) {
    WG_REAL sum = WG_C(0.0);
    int i;
    for (i = 0; i < n; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* x0^2 - x1^2 - x2^2 of a vector in the cone, without the loss of squares. */
static inline WG_REAL WG_NAME(wg_conic_size)(const WG_REAL x[3]) {
    const WG_REAL along = WG_SQRT(x[1] * x[1] + x[2] * x[2]);
    return (x[0] - along) * (x[0] + along);
}

/* The product of a symmetric matrix and a vector. */
static inline void WG_NAME(wg_conic_apply)(const WG_REAL W[6], const WG_REAL v[3], WG_REAL product[3]) {
    product[0] = W[0] * v[0] + W[1] * v[1] + W[2] * v[2];
    product[1] = W[1] * v[0] + W[3] * v[1] + W[4] * v[2];
    product[2] = W[2] * v[0] + W[4] * v[1] + W[5] * v[2];
}

/* Nesterov and Todd's V of a cone: V z = V^-1 x. */
static inline void WG_NAME(wg_conic_scaling)(const WG_REAL x[3], const WG_REAL z[3], WG_REAL V[6]) {
    const WG_REAL of_x = WG_SQRT(WG_NAME(wg_conic_size)(x)), of_z = WG_SQRT(WG_NAME(wg_conic_size)(z)), beta = WG_SQRT(of_x / of_z);
    const WG_REAL inner = (x[0] * z[0] + x[1] * z[1] + x[2] * z[2]) / of_x / of_z;
    const WG_REAL share = WG_C(1.0) / WG_SQRT(WG_C(2.0) * (WG_C(1.0) + inner)), w = share * (x[0] / of_x + z[0] / of_z);
    const WG_REAL half = WG_C(1.0) / WG_SQRT(WG_C(2.0) * (w + WG_C(1.0))), p = half * (w + WG_C(1.0));
    const WG_REAL q = half * share * (x[1] / of_x - z[1] / of_z), r = half * share * (x[2] / of_x - z[2] / of_z);
    V[0] = beta * (WG_C(2.0) * p * p - WG_C(1.0));
    V[1] = beta * WG_C(2.0) * p * q;
    V[2] = beta * WG_C(2.0) * p * r;
    V[3] = beta * (WG_C(2.0) * q * q + WG_C(1.0));
    V[4] = beta * WG_C(2.0) * q * r;
    V[5] = beta * (WG_C(2.0) * r * r + WG_C(1.0));
}

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

/* Residuals, scalings and the factor at the present point; whether it is one. */
static inline int WG_NAME(wg_conic_prepare)(struct WG_NAME(wg_conic) * conic, struct WG_NAME(wg_conic_step) * step) {
    const int n = conic->rows, size = 3 * conic->cones;
    int i, c;
    step->last = WG_C(1.0) - WG_NAME(wg_conic_product)(n, conic->a, conic->y);
    conic->lacking = WG_ABS(step->last);
    for (i = 0; i < n; ++i) {
        step->primal[i] = conic->b[i] - conic->s * conic->a[i];
        step->u[i] = conic->a[i];
        for (c = 0; c < size; ++c) {
            step->primal[i] -= conic->column[c][i] * conic->x[c];
        }
    }
    conic->unbalanced = WG_NAME(wg_stance_largest)(step->primal, n);
    conic->lacking = WG_MAX(conic->lacking, conic->unbalanced);
    for (c = 0; c < size; c += 3) {
        WG_NAME(wg_conic_scaling)(conic->x + c, conic->z + c, step->V[c / 3]);
        WG_NAME(wg_conic_apply)(step->V[c / 3], conic->z + c, step->even + c);
        for (i = 0; i < n; ++i) {
            const WG_REAL row[3] = {conic->column[c][i], conic->column[c + 1][i], conic->column[c + 2][i]};
            WG_NAME(wg_conic_apply)(step->V[c / 3], row, step->Q[i] + c);
        }
        for (i = c; i < c + 3; ++i) {
            step->dual[i] = WG_NAME(wg_conic_product)(n, conic->column[i], conic->y) - conic->z[i];
            conic->lacking = WG_MAX(conic->lacking, WG_ABS(step->dual[i]));
        }
    }
    if (!WG_NAME(wg_conic_factor)(n, size, step)) {
        return 0;
    }
    WG_NAME(wg_conic_down)(n, step->R, step->u);
    WG_NAME(wg_conic_down)(n, step->R, step->primal);
    return 1;
}

/* u of the cones' product e u = d (-e - d): by how much x and z, moved by V d and as far as that takes z, miss complementarity. */
static inline void WG_NAME(wg_conic_missed)(const WG_REAL e[3], WG_REAL size, const WG_REAL d[3], WG_REAL u[3]) {
    const WG_REAL other[3] = {-e[0] - d[0], -e[1] - d[1], -e[2] - d[2]}, v = WG_NAME(wg_dot)(d, other);
    const WG_REAL p = d[0] * other[1] + other[0] * d[1], q = d[0] * other[2] + other[0] * d[2];
    u[0] = (e[0] * v - e[1] * p - e[2] * q) / size;
    u[1] = (p - e[1] * u[0]) / e[0];
    u[2] = (q - e[2] * u[0]) / e[0];
}

/* The step towards complementarity x z = target in all cones; after one towards 0, what that missed is taken off. */
static inline void WG_NAME(wg_conic_aim)(const struct WG_NAME(wg_conic) * conic, WG_REAL target, struct WG_NAME(wg_conic_step) * step) {
    const int n = conic->rows, size = 3 * conic->cones;
    WG_REAL *g = step->scaled, h[6], moved[3], missed[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    int i, j, c;
    for (c = 0; c < size; c += 3) {
        const WG_REAL *even = step->even + c;
        const WG_REAL level = WG_SQRT(WG_NAME(wg_conic_size)(conic->x + c)) * WG_SQRT(WG_NAME(wg_conic_size)(conic->z + c));
        const WG_REAL share = target / level;
        if (target > WG_C(0.0)) {
            WG_NAME(wg_conic_missed)(even, level, g + c, missed);
        }
        WG_NAME(wg_conic_apply)(step->V[c / 3], step->dual + c, moved);
        for (j = 0; j < 3; ++j) {
            g[c + j] = (j == 0 ? share - WG_C(1.0) : -share - WG_C(1.0)) * even[j] - moved[j] - missed[j];
        }
    }
    for (i = 0; i < n; ++i) {
        h[i] = WG_NAME(wg_conic_product)(size, step->Q[i], g) - step->primal[i];
    }
    step->ds = (step->last - WG_NAME(wg_conic_product)(n, step->u, h)) / WG_NAME(wg_conic_product)(n, step->u, step->u);
    step->ds = WG_MIN(step->ds, WG_C(10.0) * (WG_C(1.0) + WG_ABS(conic->s))); /* where s has no bound, rounding of forces would hide the load */
    for (i = 0; i < n; ++i) {
        h[i] += step->ds * step->u[i];
        for (c = 0; c < size; ++c) {
            g[c] -= h[i] * step->Q[i][c];
        }
    }
    for (i = n - 1; i >= 0; --i) {
        step->dy[i] = h[i];
        for (j = i + 1; j < n; ++j) {
            step->dy[i] -= step->R[i][j] * step->dy[j];
        }
        step->dy[i] /= step->R[i][i];
    }
    for (c = 0; c < size; ++c) {
        step->dz[c] = WG_NAME(wg_conic_product)(n, conic->column[c], step->dy) + step->dual[c];
        if (c % 3 == 0) {
            WG_NAME(wg_conic_apply)(step->V[c / 3], g + c, step->dx + c);
        }
    }
}

/* How far along d the points x stay in their cones, at most 1e9. */
static inline WG_REAL WG_NAME(wg_conic_room)(int cones, const WG_REAL *x, const WG_REAL *d) {
    WG_REAL room = WG_C(1e9);
    int c;
    for (c = 0; c < 3 * cones; c += 3) {
        const WG_REAL square = d[c] * d[c] - d[c + 1] * d[c + 1] - d[c + 2] * d[c + 2], size = WG_NAME(wg_conic_size)(x + c);
        const WG_REAL mixed = x[c] * d[c] - x[c + 1] * d[c + 1] - x[c + 2] * d[c + 2], under = mixed * mixed - square * size;
        const WG_REAL below = under > WG_C(0.0) ? WG_SQRT(under) - mixed : -mixed; /* not negative but for rounding */
        if (below > WG_C(0.0)) {
            room = WG_MIN(room, size / below);
        }
    }
    return room;
}

/* The point moved along the step; whether it stays one. */
static inline int WG_NAME(wg_conic_move)(const struct WG_NAME(wg_conic_step) * step, WG_REAL primal, WG_REAL dual, struct WG_NAME(wg_conic) * conic) {
    struct WG_NAME(wg_conic) next = *conic;
    int i, fine;
    for (i = 0; i < 3 * conic->cones; ++i) {
        next.x[i] += primal * step->dx[i];
        next.z[i] += dual * step->dz[i];
    }
    for (i = 0; i < conic->rows; ++i) {
        next.y[i] += dual * step->dy[i];
    }
    next.s += primal * step->ds;
    fine = WG_ABS(next.s) <= WG_HUGE && WG_NAME(wg_stance_finite)(next.y, conic->rows);
    for (i = 0; i < 3 * conic->cones; i += 3) {
        fine &= next.x[i] > WG_C(0.0) && next.z[i] > WG_C(0.0);
        fine &= WG_NAME(wg_conic_size)(next.x + i) > WG_C(0.0) && WG_NAME(wg_conic_size)(next.z + i) > WG_C(0.0);
    }
    if (fine) {
        *conic = next;
    }
    return fine;
}

/* The least change of x, in V's measure, that takes away what the first equations lack. */
static inline void WG_NAME(wg_conic_balance)(struct WG_NAME(wg_conic_step) * step, struct WG_NAME(wg_conic) * conic) {
    int i, c;
    for (c = 0; c < 3 * conic->cones; ++c) {
        step->scaled[c] = step->dz[c] = WG_C(0.0);
        for (i = 0; i < conic->rows; ++i) {
            step->scaled[c] += step->Q[i][c] * step->primal[i];
            step->dy[i] = WG_C(0.0);
        }
    }
    step->ds = WG_C(0.0);
    for (c = 0; c < 3 * conic->cones; c += 3) {
        WG_NAME(wg_conic_apply)(step->V[c / 3], step->scaled + c, step->dx + c);
    }
    if (WG_NAME(wg_conic_move)(step, WG_C(1.0), WG_C(1.0), conic)) {
        (void)WG_NAME(wg_conic_prepare)(conic, step);
    }
}

/* x, z, y, s, from a start without any knowledge; ends early with forces that reach as far as `enough`. Whether the gap is closed. */
static inline int WG_NAME(wg_conic_solve)(WG_REAL enough, struct WG_NAME(wg_conic) * conic) {
    struct WG_NAME(wg_conic_step) step;
    WG_REAL mean, primal, dual, share;
    int turn, i;
    for (i = 0; i < 3 * conic->cones; ++i) {
        conic->x[i] = conic->z[i] = WG_INDICATOR(i % 3 == 0);
    }
    for (i = 0; i < 6; ++i) {
        conic->y[i] = WG_C(0.0);
    }
    conic->s = WG_C(0.0);
    for (turn = 0; turn < 80; ++turn) {
        const int fine = WG_NAME(wg_conic_prepare)(conic, &step);
        mean = WG_NAME(wg_conic_product)(3 * conic->cones, conic->x, conic->z) / (WG_REAL)conic->cones;
        conic->gap = (WG_REAL)conic->cones * mean;
        if (!fine || (conic->gap <= WG_SHARP && conic->lacking <= WG_C(8.0) * WG_SHARP)) {
            break;
        }
        if (conic->s > enough && conic->unbalanced <= WG_C(1e3) * WG_ROUGH) {
            WG_NAME(wg_conic_balance)(&step, conic);
            break;
        }
        WG_NAME(wg_conic_aim)(conic, WG_C(0.0), &step);
        primal = WG_NAME(wg_conic_room)(conic->cones, conic->x, step.dx);
        dual = WG_NAME(wg_conic_room)(conic->cones, conic->z, step.dz);
        share = WG_C(1.0) - WG_MIN(WG_C(1.0), WG_MIN(primal, dual));
        WG_NAME(wg_conic_aim)(conic, WG_MAX(share * share * share, WG_C(1e-6)) * mean, &step);
        primal = WG_MIN(WG_C(1.0), WG_C(0.98) * WG_NAME(wg_conic_room)(conic->cones, conic->x, step.dx));
        dual = WG_MIN(WG_C(1.0), WG_C(0.98) * WG_NAME(wg_conic_room)(conic->cones, conic->z, step.dz));
        if (!WG_NAME(wg_conic_move)(&step, primal, dual, conic)) {
            break;
        }
    }
    return conic->gap <= WG_ROUGH && conic->lacking <= WG_ROUGH;
}

#undef WG_SHARP
#undef WG_ROUGH
#endif
