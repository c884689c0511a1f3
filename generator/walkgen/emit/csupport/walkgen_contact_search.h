/* walkgen_contact_search.h: a stance read, and forces found for it handed over; walkgen_math.h explains the macros. */
#include "walkgen_contact_finish.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_SEARCH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_SEARCH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_SEARCH_F64
#define WG_FAIR WG_C(1e-10)
#else
#define WALKGEN_CONTACT_SEARCH_F32
#define WG_FAIR WG_C(5e-5)
#endif

/* A search: the stance, its multipliers, the forces. */
struct WG_NAME(wg_contact_search) {
    struct WG_NAME(wg_contact_stance) stance;
    struct WG_NAME(wg_contact_dual) dual;
    WG_REAL f[3][WALKGEN_MAX_FEET];
};

/* The feet's cones. */
static inline void WG_NAME(wg_contact_shape)(const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *n_max, int32_t facets,
                                             struct WG_NAME(wg_contact_stance) * stance) {
    struct WG_NAME(wg_contact_cones) *cones = &stance->cones;
    const WG_REAL angle = WG_PI / (WG_REAL)(facets > 0 ? facets : 1), unit = WG_C(1.0) / stance->force_unit;
    const int32_t rows = (stance->feet + 3) & ~3;
    int i;
    cones->rows = stance->feet;
    cones->facets = facets;
    cones->side = cones->corner = WG_C(0.7071067811865476);
    if (facets != 0 && facets != 4) {
        cones->side = WG_COS(angle);
        cones->corner = WG_SIN(angle);
    }
    WG_NAME(wg_contact_fill)(cones->n[0] + rows - 4);
    WG_NAME(wg_contact_fill)(cones->n[1] + rows - 4);
    WG_NAME(wg_contact_fill)(cones->n[2] + rows - 4);
    WG_NAME(wg_contact_fill)(cones->n_max + rows - 4);
    WG_NAME(wg_contact_fill)(cones->mu + rows - 4);
    for (i = 0; i < stance->feet; ++i) {
        cones->n[0][i] = normals[3 * i];
        cones->n[1][i] = normals[3 * i + 1];
        cones->n[2][i] = normals[3 * i + 2];
        cones->n_max[i] = unit * n_max[i];
        cones->mu[i] = mu[i];
    }
    for (i = 0; i < rows; ++i) {
        WG_NAME(wg_contact_rub)(cones->mu[i], i, cones);
    }
    if (facets) {
        WG_NAME(wg_contact_aim)(cones);
    }
}

/* The stance inside; 0 where an input is bad: what is no number makes one of r or b. */
WG_CALLED int WG_NAME(wg_contact_read)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *wrench,
                                           const WG_REAL *weight, const WG_REAL *n_max, int32_t facets,
                                           struct WG_NAME(wg_contact_stance) * stance) {
    if (k < 1 || k > WALKGEN_MAX_FEET || !(facets == 0 || (facets >= 3 && facets <= 1024)) ||
        !WG_NAME(wg_contact_fine)(k, normals, mu, weight, n_max)) {
        return 0;
    }
    stance->feet = k;
    stance->turned = stance->lost[0] = stance->lost[1] = stance->lost[2] = 0;
    WG_NAME(wg_contact_place)(points, weight, stance);
    WG_NAME(wg_contact_load)(wrench, stance);
    WG_NAME(wg_contact_inertia)(stance);
    WG_NAME(wg_contact_shape)(normals, mu, n_max, facets, stance);
    return WG_NAME(wg_contact_product)(stance->b, stance->b) + stance->inertia[0] + stance->inertia[3] + stance->inertia[5] <= WG_HUGE;
}

/* Multipliers of the forces without cones in dual->y. Where the feet are not spread well, the principal axes; the axis of a moment that
 * cannot be carried, or -1. */
static inline int WG_NAME(wg_contact_spread)(struct WG_NAME(wg_contact_stance) * stance, WG_REAL y[6]) {
    const WG_REAL *J = stance->inertia, trace = J[0] + J[3] + J[5], inverse = WG_C(1.0) / stance->mass;
    WG_REAL turning[6];
    int i, axis = -1;
    if (WG_NAME(wg_contact_invert)(J, trace, turning) > WG_C(1e-5)) {
        WG_NAME(wg_contact_apply)(turning, stance->b + 3, y + 3);
    } else {
        (void)WG_NAME(wg_contact_principal)(stance, &axis);
        for (i = 0; i < 3; ++i) {
            y[3 + i] = stance->lost[i] ? WG_C(0.0) : stance->b[3 + i] / J[i == 0 ? 0 : 2 * i + 1];
        }
    }
    for (i = 0; i < 3; ++i) {
        y[i] = inverse * stance->b[i];
    }
    return axis;
}

/* The search's start: forces without cones, or the last stance's multipliers where they leave less to be found; whether it is these. */
static inline int WG_NAME(wg_contact_start)(const struct WG_NAME(walkgen_contact_work) * work, struct WG_NAME(wg_contact_search) * search) {
    const struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    struct WG_NAME(wg_contact_dual) *dual = &search->dual;
    WG_REAL least, first[6];
    int i;
    WG_NAME(wg_contact_evaluate)(stance, dual);
    if (work->feet != stance->feet || stance->turned) {
        return 0;
    }
    least = WG_NAME(wg_contact_product)(dual->slope, dual->slope);
    for (i = 0; i < 6; ++i) {
        first[i] = dual->y[i];
        dual->y[i] = WG_NAME(wg_power)(i < 3 ? -stance->force_size : stance->length_size - stance->force_size) * work->start[i];
    }
    WG_NAME(wg_contact_evaluate)(stance, dual);
    if (WG_NAME(wg_contact_product)(dual->slope, dual->slope) < least) {
        return 1;
    }
    for (i = 0; i < 6; ++i) {
        dual->y[i] = first[i];
    }
    WG_NAME(wg_contact_evaluate)(stance, dual);
    return 0;
}

/* The greatest part of forces. */
static inline WG_REAL WG_NAME(wg_contact_greatest)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[3][WALKGEN_MAX_FEET]) {
    WG_REAL greatest = WG_C(0.0);
    int i;
    for (i = 0; i < 3 * stance->feet; ++i) {
        greatest = WG_MAX(greatest, WG_ABS(f[i % 3][i / 3]));
    }
    return greatest;
}

/* search->f, which lack so much of the load, handed over if they balance: whether they do. To 1e-10 of the load, or, as forces of more than
 * 1e5 loads cannot balance better, to rounding of the forces, at most 1e-9. */
static inline int WG_NAME(wg_contact_deliver)(struct WG_NAME(wg_contact_search) * search, WG_REAL lacking,
                                              struct WG_NAME(walkgen_contact_work) * work, WG_REAL *f, int32_t *state, WG_REAL *violation) {
    const struct WG_NAME(wg_contact_stance) *stance = &search->stance;
    WG_REAL by_force, by_moment;
    int i;
    if (!(lacking <= WG_FAIR) && !(lacking <= WG_C(10.0) * WG_FAIR &&
                                   lacking <= WG_C(2.0) * WG_EPSILON * WG_NAME(wg_contact_greatest)(stance, search->f))) {
        return 0;
    }
    WG_NAME(wg_contact_hand_over)(stance, search->f, f, state);
    *violation = lacking * stance->force_unit;
    by_force = WG_NAME(wg_power)(stance->force_size);
    by_moment = WG_NAME(wg_power)(stance->force_size - stance->length_size);
    work->feet = stance->turned ? 0 : stance->feet;
    for (i = 0; i < 3; ++i) {
        work->start[i] = by_force * search->dual.y[i];
        work->start[3 + i] = by_moment * search->dual.y[3 + i];
    }
    return 1;
}

/* Newton from dual's multipliers: forces in search->f, and what they lack, where it finds them. */
WG_CALLED int WG_NAME(wg_contact_climb)(struct WG_NAME(wg_contact_search) * search, WG_REAL *lacking) {
    const int answer = WG_NAME(wg_contact_ascend)(&search->stance, 12, &search->dual);
    if (answer == WG_CONTACT_FOUND) {
        WG_NAME(wg_contact_copy)(search->stance.feet, search->dual.images.f, search->f);
        *lacking = WG_NAME(wg_contact_polish)(&search->stance, &search->dual, search->f);
    }
    return answer;
}

#undef WG_FAIR
#endif
