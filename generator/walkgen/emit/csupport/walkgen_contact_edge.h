/* walkgen_contact_edge.h: contact forces near the edge of what can be carried, by interior points; walkgen_math.h explains the macros.
 *
 * There the multipliers of the least forces grow without bound, and Newton on them ends without forces or a proof. The greatest normal
 * force s that all feet can have above what their friction needs (walkgen_conic.h) is well conditioned there: the way to it passes points
 * that are forces within the cones or strict proofs, whichever there are. From such forces an interior-point method finds the least ones,
 * however large.
 */
#include "walkgen_conic.h"
#include "walkgen_contact_mend.h"
#include "walkgen_contact_search.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_EDGE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_EDGE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_EDGE_F64
#define WG_SHARP WG_C(1e-15)
#define WG_ROUGH WG_C(1e-9)
#else
#define WALKGEN_CONTACT_EDGE_F32
#define WG_SHARP WG_C(1e-7)
#define WG_ROUGH WG_C(1e-4)
#endif

/* The problem of a stance with round cones, its rows of balance without those that are lost, and the tangents of its feet. */
struct WG_NAME(wg_contact_edge) {
    struct WG_NAME(wg_conic) conic;
    WG_REAL tangent[2][WALKGEN_MAX_FEET][3], mass[3 * WALKGEN_MAX_FEET];
    int row[6]; /* which of the balances */
};

/* Column c of the problem: what the foot's unit force along its normal, or mu times that along a tangent, gives. */
static inline void WG_NAME(wg_contact_column)(const struct WG_NAME(wg_contact_stance) * stance, int i, const WG_REAL force[3], WG_REAL size,
                                              const struct WG_NAME(wg_contact_edge) * edge, WG_REAL column[6]) {
    const WG_REAL r[3] = {stance->r[0][i], stance->r[1][i], stance->r[2][i]};
    WG_REAL whole[6];
    int j;
    WG_NAME(wg_add)(force, WG_C(0.0), force, whole);
    WG_NAME(wg_cross)(r, force, whole + 3);
    for (j = 0; j < edge->conic.rows; ++j) {
        column[j] = size * whole[edge->row[j]];
    }
}

/* The problem of the greatest s. */
static inline void WG_NAME(wg_contact_pose)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_edge) * edge) {
    struct WG_NAME(wg_conic) *conic = &edge->conic;
    int i, j;
    conic->cones = stance->feet;
    conic->mass = NULL;
    conic->rows = 0;
    for (j = 0; j < 6; ++j) {
        if (j < 3 || !stance->lost[j - 3]) {
            conic->b[conic->rows] = stance->b[j];
            conic->a[conic->rows] = WG_C(0.0);
            edge->row[conic->rows++] = j;
        }
    }
    for (i = 0; i < stance->feet; ++i) {
        const WG_REAL n[3] = {stance->cones.n[0][i], stance->cones.n[1][i], stance->cones.n[2][i]}, mu = stance->cones.mu[i];
        WG_REAL *mass = edge->mass + 3 * i;
        WG_NAME(wg_across)(n, edge->tangent[0][i], edge->tangent[1][i]);
        WG_NAME(wg_contact_column)(stance, i, n, WG_C(1.0), edge, conic->column[3 * i]);
        WG_NAME(wg_contact_column)(stance, i, edge->tangent[0][i], mu, edge, conic->column[3 * i + 1]);
        WG_NAME(wg_contact_column)(stance, i, edge->tangent[1][i], mu, edge, conic->column[3 * i + 2]);
        mass[0] = WG_C(1.0) / stance->ease[i];
        mass[1] = mass[2] = mu * mu * mass[0];
        for (j = 0; j < conic->rows; ++j) {
            conic->a[j] += conic->column[3 * i][j];
        }
    }
}

/* Minus the problem's multipliers as those of the stance's balance. */
static inline void WG_NAME(wg_contact_turned_back)(const struct WG_NAME(wg_contact_edge) * edge, WG_REAL y[6]) {
    int j;
    y[3] = y[4] = y[5] = WG_C(0.0);
    for (j = 0; j < edge->conic.rows; ++j) {
        y[edge->row[j]] = -edge->conic.y[j];
    }
}

/* The problem's forces, in their cones. */
static inline void WG_NAME(wg_contact_exerted)(const struct WG_NAME(wg_contact_stance) * stance,
                                               const struct WG_NAME(wg_contact_edge) * edge,
                                               WG_REAL f[3][WALKGEN_MAX_FEET]) {
    int i, j;
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < ((stance->feet + 3) & ~3); ++i) {
            const WG_REAL *x = edge->conic.x + 3 * i, mu = stance->cones.mu[i];
            f[j][i] = i < stance->feet ? (x[0] + edge->conic.s) * stance->cones.n[j][i] +
                                             mu * (x[1] * edge->tangent[0][i][j] + x[2] * edge->tangent[1][i][j])
                                       : WG_C(0.0);
        }
    }
    WG_NAME(wg_contact_into_cones)(stance, f);
}

/* Towards the greatest s: WG_CONTACT_REFUTED with y at the first strict proof, else the problem's forces: WG_CONTACT_FOUND where all cones
 * have room for more, or WG_CONTACT_OPEN. */
WG_CALLED int WG_NAME(wg_contact_decide)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_conic_step) * step,
                                             struct WG_NAME(wg_contact_edge) * edge, struct WG_NAME(wg_contact_dual) * dual, WG_REAL y[6]) {
    struct WG_NAME(wg_conic) *conic = &edge->conic;
    WG_REAL largest;
    int turn;
    WG_NAME(wg_conic_start)(conic);
    for (turn = 0; turn < 80; ++turn) {
        const int fine = WG_NAME(wg_conic_prepare)(conic, step);
        WG_NAME(wg_contact_turned_back)(edge, y);
        if (WG_NAME(wg_contact_strict)(stance, y)) {
            return WG_CONTACT_REFUTED;
        }
        if (!fine || WG_NAME(wg_conic_closed)(conic)) {
            break;
        }
        largest = WG_MAX(WG_C(1.0), WG_NAME(wg_stance_largest)(conic->x, 3 * conic->cones));
        if (conic->s > WG_C(0.0) && conic->unbalanced <= WG_ROUGH * largest) {
            WG_NAME(wg_conic_balance)(step, conic);
            break;
        }
        if (!WG_NAME(wg_conic_advance)(step, conic)) {
            break;
        }
    }
    if (conic->s > WG_C(0.0)) {
        return WG_CONTACT_FOUND;
    }
    return WG_NAME(wg_contact_mend)(stance, dual, y) ? WG_CONTACT_REFUTED : WG_CONTACT_OPEN;
}

/* From forces with room in all cones to the least ones and their multipliers y. */
WG_CALLED void WG_NAME(wg_contact_lessen)(struct WG_NAME(wg_conic_step) * step, struct WG_NAME(wg_contact_edge) * edge, WG_REAL y[6]) {
    struct WG_NAME(wg_conic) *conic = &edge->conic;
    WG_REAL size;
    int i, j, turn;
    conic->mass = edge->mass;
    for (i = 0; i < 3 * conic->cones; i += 3) {
        conic->x[i] += conic->s;
        size = WG_NAME(wg_conic_size)(conic->x + i) / conic->x[i];
        for (j = 0; j < 3; ++j) { /* where x z is the same for all cones */
            conic->z[i + j] = (j == 0 ? WG_C(1.0) : WG_C(-1.0)) * conic->x[i + j] / size;
        }
    }
    conic->s = WG_C(0.0);
    for (j = 0; j < 6; ++j) {
        conic->a[j] = conic->y[j] = WG_C(0.0);
    }
    for (turn = 0; turn < 60 && WG_NAME(wg_conic_prepare)(conic, step); ++turn) {
        size = WG_C(1.0);
        for (i = 0; i < 3 * conic->cones; ++i) {
            size += conic->mass[i] * conic->x[i] * conic->x[i];
        }
        if (conic->gap <= WG_SHARP * size || !WG_NAME(wg_conic_advance)(step, conic)) {
            break;
        }
    }
    WG_NAME(wg_contact_turned_back)(edge, y);
}

/* The search near the edge: forces, which are the least ones where these are found, or a proof; WALKGEN_NO_CONVERGENCE without. */
WG_CALLED int32_t WG_NAME(wg_contact_at_edge)(struct WG_NAME(wg_contact_search) * search, struct WG_NAME(walkgen_contact_work) * work,
                                                  WG_REAL *f, int32_t *state, WG_REAL certificate[6], WG_REAL *violation) {
    struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    struct WG_NAME(wg_contact_edge) edge;
    struct WG_NAME(wg_conic_step) step;
    WG_REAL any[3][WALKGEN_MAX_FEET], y[6];
    int answer;
    WG_NAME(wg_contact_pose)(stance, &edge);
    answer = WG_NAME(wg_contact_decide)(stance, &step, &edge, dual, y);
    if (answer == WG_CONTACT_REFUTED) {
        WG_NAME(wg_contact_refute)(stance, y, certificate, violation);
        return WALKGEN_INFEASIBLE;
    }
    WG_NAME(wg_contact_exerted)(stance, &edge, any);
    if (answer == WG_CONTACT_FOUND) {
        WG_NAME(wg_contact_lessen)(&step, &edge, dual->y);
        WG_NAME(wg_contact_evaluate)(stance, dual);
        (void)WG_NAME(wg_contact_ascend)(stance, 12, dual);
        WG_NAME(wg_contact_copy)(stance->feet, dual->images.f, search->f);
        if (WG_NAME(wg_contact_deliver)(search, WG_NAME(wg_contact_polish)(stance, dual, search->f), work, f, state, violation)) {
            return WALKGEN_OK;
        }
        WG_NAME(wg_contact_exerted)(stance, &edge, search->f);
        if (WG_NAME(wg_contact_deliver)(search, WG_NAME(wg_contact_polish)(stance, dual, search->f), work, f, state, violation)) {
            return WALKGEN_OK;
        }
    }
    WG_NAME(wg_contact_copy)(stance->feet, any, search->f);
    return WG_NAME(wg_contact_deliver)(search, WG_NAME(wg_contact_imbalance)(stance, any), work, f, state, violation)
               ? WALKGEN_OK
               : WALKGEN_NO_CONVERGENCE;
}

#undef WG_SHARP
#undef WG_ROUGH
#endif
