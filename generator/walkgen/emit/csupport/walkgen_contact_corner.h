/* walkgen_contact_corner.h: whether pyramids carry a load near the edge of what can be carried, by the simplex method; walkgen_math.h
 * explains the macros.
 *
 * Forces are sums of the pyramids' edges with factors of at least 0. Six of them, or where these are missing single parts of the load, make
 * a corner; from corner to corner less of the load is missing, until nothing is, or until the multipliers are a proof that some must. Every
 * corner is solved from the inputs again, so that errors do not add up. A foot's edge of most gain is known without trying all.
 */
#include "walkgen_contact_mend.h"
#include "walkgen_contact_search.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_CORNER_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_CORNER_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_CORNER_F64
#else
#define WALKGEN_CONTACT_CORNER_F32
#endif

/* Six columns, of the edges of feet or (foot -1) of parts of the load, and their factors. */
struct WG_NAME(wg_contact_corner) {
    WG_REAL column[6][6], edge[6][3], x[6];
    int32_t foot[6];
};

/* x = M^-1 x for the matrix of columns, or its transpose, by elimination with pivots; whether it is regular. */
static inline int WG_NAME(wg_corner_solve)(const WG_REAL column[6][6], int transposed, WG_REAL x[6]) {
    WG_REAL M[6][7];
    int i, j, m, best;
    for (i = 0; i < 6; ++i) {
        for (j = 0; j < 6; ++j) {
            M[i][j] = transposed ? column[i][j] : column[j][i];
        }
        M[i][6] = x[i];
    }
    for (j = 0; j < 6; ++j) {
        for (best = j, i = j + 1; i < 6; ++i) {
            best = WG_ABS(M[i][j]) > WG_ABS(M[best][j]) ? i : best;
        }
        if (!(WG_ABS(M[best][j]) > WG_EPSILON * WG_EPSILON)) {
            return 0;
        }
        for (m = j; m < 7; ++m) {
            const WG_REAL other = M[j][m];
            M[j][m] = M[best][m];
            M[best][m] = other;
        }
        for (i = j + 1; i < 6; ++i) {
            const WG_REAL factor = M[i][j] / M[j][j];
            for (m = j + 1; m < 7; ++m) {
                M[i][m] -= factor * M[j][m];
            }
        }
    }
    for (i = 5; i >= 0; --i) {
        for (x[i] = M[i][6], m = i + 1; m < 6; ++m) {
            x[i] -= M[i][m] * x[m];
        }
        x[i] /= M[i][i];
    }
    return 1;
}

/* The edge of a foot's pyramid along which z gains most; the gain beyond rounding. */
static inline WG_REAL WG_NAME(wg_corner_edge)(const struct WG_NAME(wg_contact_cones) * cones, int i, const WG_REAL z[3], WG_REAL edge[3]) {
    const WG_REAL *const along[3] = {cones->along[0], cones->along[1], cones->along[2]};
    const WG_REAL *const aside[3] = {cones->aside[0], cones->aside[1], cones->aside[2]};
    const WG_REAL a = along[0][i] * z[0] + along[1][i] * z[1] + along[2][i] * z[2];
    const WG_REAL b = aside[0][i] * z[0] + aside[1][i] * z[1] + aside[2][i] * z[2];
    WG_REAL c, s, out, across;
    int j;
    WG_NAME(wg_contact_side)(cones->facets, a, b, &c, &s);
    out = cones->mu[i] * cones->side;
    across = c * b - s * a < WG_C(0.0) ? -cones->mu[i] * cones->corner : cones->mu[i] * cones->corner;
    for (j = 0; j < 3; ++j) {
        edge[j] = cones->n[j][i] + (out * c - across * s) * along[j][i] + (out * s + across * c) * aside[j][i];
    }
    return WG_NAME(wg_dot)(edge, z) - WG_C(8.0) * WG_EPSILON * (WG_C(1.0) + cones->mu[i]) * WG_NAME(wg_norm)(z);
}

/* What a foot's force gives the balance. */
static inline void WG_NAME(wg_corner_column)(const struct WG_NAME(wg_contact_stance) * stance, int i, const WG_REAL force[3],
                                             WG_REAL column[6]) {
    const WG_REAL r[3] = {stance->r[0][i], stance->r[1][i], stance->r[2][i]};
    int j;
    WG_NAME(wg_cross)(r, force, column + 3);
    for (j = 0; j < 3; ++j) {
        column[j] = force[j];
        column[3 + j] = stance->lost[j] ? WG_C(0.0) : column[3 + j];
    }
}

/* Where nothing of the load is carried. */
static inline void WG_NAME(wg_corner_start)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_corner) * corner) {
    int i, j;
    for (i = 0; i < 6; ++i) {
        corner->foot[i] = -1;
        corner->x[i] = WG_ABS(stance->b[i]);
        for (j = 0; j < 6; ++j) {
            corner->column[i][j] = i != j ? WG_C(0.0) : stance->b[i] < WG_C(0.0) ? WG_C(-1.0) : WG_C(1.0);
        }
    }
}

/* The multipliers y of a corner: what a unit of each balance costs of what is missing, where factors of edges earn `spare`. How much is
 * missing. */
static inline WG_REAL WG_NAME(wg_corner_price)(const struct WG_NAME(wg_contact_corner) * corner, WG_REAL spare, WG_REAL y[6]) {
    WG_REAL missing = WG_C(0.0);
    int i;
    for (i = 0; i < 6; ++i) {
        y[i] = corner->foot[i] < 0 ? WG_C(1.0) : -spare;
        missing += corner->foot[i] < 0 ? WG_ABS(corner->x[i]) : WG_C(0.0);
    }
    return WG_NAME(wg_corner_solve)((const WG_REAL(*)[6])corner->column, 1, y) ? missing : WG_NAN;
}

/* Which column leaves for one that the others make up by `share`: of those that vanish first, to rounding, the one of the largest share. */
static inline int WG_NAME(wg_corner_leaving)(const struct WG_NAME(wg_contact_corner) * corner, const WG_REAL share[6]) {
    WG_REAL largest = WG_C(0.0), far = WG_INFINITY;
    int i, leaving = -1;
    for (i = 0; i < 6; ++i) {
        largest = WG_MAX(largest, WG_ABS(share[i]));
    }
    for (i = 0; i < 6; ++i) {
        if (share[i] > WG_C(64.0) * WG_EPSILON * largest) {
            far = WG_MIN(far, (WG_MAX(corner->x[i], WG_C(0.0)) + WG_C(8.0) * WG_EPSILON) / share[i]);
        }
    }
    for (i = 0; i < 6; ++i) {
        if (share[i] > WG_C(64.0) * WG_EPSILON * largest && corner->x[i] <= far * share[i] && (leaving < 0 || share[i] > share[leaving])) {
            leaving = i;
        }
    }
    return leaving;
}

/* To the next corner, by the edge of most gain, or after many corners by that of the first foot whose edge gains: WG_CONTACT_OPEN where
 * there was one, WG_CONTACT_REFUTED where no edge gains by y, or all lose at least `spare`. */
static inline int WG_NAME(wg_corner_move)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL spare, int first,
                                          struct WG_NAME(wg_contact_corner) * corner) {
    WG_REAL z[3][WALKGEN_MAX_FEET], edge[3], chosen[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, share[6], best = WG_C(0.0);
    int i, j, foot = -1, leaving;
    WG_NAME(wg_contact_pull)(stance, y, z);
    for (i = 0; i < stance->feet && !(first && foot >= 0); ++i) {
        const WG_REAL pull[3] = {z[0][i], z[1][i], z[2][i]}, gain = spare + WG_NAME(wg_corner_edge)(&stance->cones, i, pull, edge);
        if (gain > best) {
            best = gain;
            foot = i;
            WG_NAME(wg_add)(edge, WG_C(0.0), edge, chosen);
        }
    }
    if (foot < 0) {
        return WG_CONTACT_REFUTED;
    }
    WG_NAME(wg_corner_column)(stance, foot, chosen, share);
    leaving = WG_NAME(wg_corner_solve)((const WG_REAL(*)[6])corner->column, 0, share) ? WG_NAME(wg_corner_leaving)(corner, share) : -1;
    if (leaving < 0) {
        return WG_CONTACT_FOUND;
    }
    corner->foot[leaving] = foot;
    WG_NAME(wg_add)(chosen, WG_C(0.0), chosen, corner->edge[leaving]);
    WG_NAME(wg_corner_column)(stance, foot, chosen, corner->column[leaving]);
    for (j = 0; j < 6; ++j) {
        corner->x[j] = stance->b[j];
    }
    return WG_NAME(wg_corner_solve)((const WG_REAL(*)[6])corner->column, 0, corner->x) ? WG_CONTACT_OPEN : WG_CONTACT_FOUND;
}

/* The forces of a corner. */
static inline void WG_NAME(wg_corner_forces)(const struct WG_NAME(wg_contact_stance) * stance,
                                             const struct WG_NAME(wg_contact_corner) * corner, WG_REAL f[3][WALKGEN_MAX_FEET]) {
    int i, j;
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < ((stance->feet + 3) & ~3); ++i) {
            f[j][i] = WG_C(0.0);
        }
        for (i = 0; i < 6; ++i) {
            if (corner->foot[i] >= 0) {
                f[j][corner->foot[i]] += WG_MAX(corner->x[i], WG_C(0.0)) * corner->edge[i][j];
            }
        }
    }
}

/* The same, the best of those that refining by what they lack leads to: where forces are large, rounding decides. What f lacks. */
static inline WG_REAL WG_NAME(wg_corner_refine)(const struct WG_NAME(wg_contact_stance) * stance,
                                                struct WG_NAME(wg_contact_corner) * corner, WG_REAL f[3][WALKGEN_MAX_FEET]) {
    WG_REAL rest[6], trial[3][WALKGEN_MAX_FEET], least = WG_INFINITY, lacking;
    int turn, i;
    for (turn = 0; turn < 12; ++turn) {
        WG_NAME(wg_corner_forces)(stance, corner, trial);
        WG_NAME(wg_contact_rest)(stance, trial, rest);
        lacking = WG_SQRT(WG_NAME(wg_contact_product)(rest, rest));
        if (lacking < least) {
            least = lacking;
            WG_NAME(wg_contact_copy)(stance->feet, trial, f);
        }
        if (!WG_NAME(wg_corner_solve)((const WG_REAL(*)[6])corner->column, 0, rest)) {
            break;
        }
        for (i = 0; i < 6; ++i) {
            corner->x[i] += rest[i];
        }
    }
    return least;
}

/* From corner to corner until nothing is missing: WG_CONTACT_OPEN; or WG_CONTACT_REFUTED where no edge helps, WG_CONTACT_FOUND where
 * rounding ends it. */
static inline int WG_NAME(wg_corner_walk)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL spare, WG_REAL y[6],
                                          struct WG_NAME(wg_contact_corner) * corner) {
    int turn, answer = WG_CONTACT_OPEN;
    for (turn = 0; turn < 250 && answer == WG_CONTACT_OPEN; ++turn) {
        if (!(WG_NAME(wg_corner_price)(corner, spare, y) > WG_EPSILON)) {
            return WG_CONTACT_OPEN;
        }
        answer = WG_NAME(wg_corner_move)(stance, y, spare, turn > 150, corner);
    }
    return answer;
}

/* Forces in pyramids without bound, in f, that carry the load but for `lacking`: WG_CONTACT_FOUND; or WG_CONTACT_REFUTED with a strict
 * proof y: multipliers by which the edges lose more than rounding hides. */
WG_CALLED int WG_NAME(wg_contact_corners)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL y[6], WG_REAL f[3][WALKGEN_MAX_FEET],
                                          WG_REAL *lacking) {
    struct WG_NAME(wg_contact_corner) corner;
    int answer;
    WG_NAME(wg_corner_start)(stance, &corner);
    answer = WG_NAME(wg_corner_walk)(stance, WG_C(0.0), y, &corner);
    if (answer == WG_CONTACT_REFUTED && !WG_NAME(wg_contact_strict)(stance, y)) {
        struct WG_NAME(wg_contact_corner) further = corner;
        const WG_REAL size = WG_C(1.0) + WG_SQRT(WG_NAME(wg_contact_product)(y, y));
        (void)WG_NAME(wg_corner_walk)(stance, WG_C(64.0) * WG_EPSILON * size, y, &further);
    }
    if (answer == WG_CONTACT_REFUTED && WG_NAME(wg_contact_strict)(stance, y)) {
        return WG_CONTACT_REFUTED;
    }
    *lacking = WG_NAME(wg_corner_refine)(stance, &corner, f);
    return WG_CONTACT_FOUND;
}

#endif
