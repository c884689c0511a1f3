/* walkgen_contact_proof.h: what multipliers prove of a load that cannot be carried (Farkas); walkgen_math.h explains the macros. */
#include "walkgen_contact_dual.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_PROOF_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_PROOF_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_PROOF_F64
#else
#define WALKGEN_CONTACT_PROOF_F32
#endif

/* The most that z gains along a foot's forces of unit normal part; `strictly`: and what rounding could hide of it. */
static inline WG_REAL WG_NAME(wg_contact_most)(const struct WG_NAME(wg_contact_cones) * cones, int i, WG_REAL z[3][WALKGEN_MAX_FEET],
                                               WG_REAL strictly) {
    WG_REAL N = WG_C(0.0), a = WG_C(0.0), b = WG_C(0.0), square = WG_C(0.0), part[3], most, c, s;
    int j;
    for (j = 0; j < 3; ++j) {
        N += cones->n[j][i] * z[j][i];
        square += z[j][i] * z[j][i];
    }
    for (j = 0; j < 3; ++j) {
        part[j] = z[j][i] - N * cones->n[j][i];
    }
    most = WG_NAME(wg_norm)(part);
    if (cones->facets) {
        for (j = 0; j < 3; ++j) {
            a += cones->along[j][i] * z[j][i];
            b += cones->aside[j][i] * z[j][i];
        }
        WG_NAME(wg_contact_side)(cones->facets, a, b, &c, &s);
        most = cones->side * (c * a + s * b) + cones->corner * WG_ABS(c * b - s * a);
    }
    return N + cones->mu[i] * most + strictly * WG_SQRT(square);
}

/* `whole`, what z gains of the load, less the most that bounded feet give. */
static inline WG_REAL WG_NAME(wg_contact_worth)(const struct WG_NAME(wg_contact_cones) * cones, int32_t feet,
                                                WG_REAL z[3][WALKGEN_MAX_FEET],
                                                WG_REAL whole) {
    int i;
    for (i = 0; i < feet; ++i) {
        const WG_REAL most = WG_NAME(wg_contact_most)(cones, i, z, WG_C(0.0));
        whole -= cones->n_max[i] <= WG_HUGE && most > WG_C(0.0) ? cones->n_max[i] * most : WG_C(0.0);
    }
    return whole;
}

/* What multipliers prove whose products with the feet's forces are z and with the load `whole`: `whole` less the most that forces give, 0
 * where forces without bound give more than `allowed` of it. `strictly`: the more than rounding could hide. */
static inline WG_REAL WG_NAME(wg_contact_excess)(const struct WG_NAME(wg_contact_cones) * cones, int32_t feet,
                                                 WG_REAL z[3][WALKGEN_MAX_FEET],
                                                 WG_REAL whole, WG_REAL strictly, WG_REAL allowed) {
    WG_REAL gain = whole;
    int i;
    for (i = 0; i < feet; ++i) {
        const WG_REAL most = WG_NAME(wg_contact_most)(cones, i, z, strictly);
        if (cones->n_max[i] <= WG_HUGE) {
            gain -= most > WG_C(0.0) ? cones->n_max[i] * most : WG_C(0.0);
        } else if (most > allowed * whole) {
            return WG_C(0.0);
        }
    }
    return gain > allowed * whole ? gain : WG_C(0.0);
}

/* The same of y. */
WG_CALLED WG_REAL WG_NAME(wg_contact_proof)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL strictly,
                                                WG_REAL allowed) {
    const WG_REAL whole = WG_NAME(wg_contact_product)(stance->b, y);
    WG_REAL z[3][WALKGEN_MAX_FEET];
    WG_NAME(wg_contact_pull)(stance, y, z);
    return WG_NAME(wg_contact_excess)(&stance->cones, stance->feet, z, whole, strictly, allowed);
}

#endif
