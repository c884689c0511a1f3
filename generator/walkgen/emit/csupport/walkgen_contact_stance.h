/* walkgen_contact_stance.h: feet, cones and load of a stance, checked, scaled and seen from the feet's centre; walkgen_math.h explains the
 * macros.
 *
 * Inside, lengths are divided by that of the stance and forces by that of the load, both by powers of 2, so that scaling a load scales the
 * forces to the last bit; moments are about the centre of the feet (weighted by 1 / weight). Where the feet stand nearly on a line, the
 * axes are the principal ones, so that what the line cannot carry is one component: `lost`.
 */
#include "walkgen_contact_cones.h"
#include "walkgen_power.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_STANCE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_STANCE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_STANCE_F64
#define WG_LIBM(name) name
#define WG_UNIT WG_C(1e-9)
#else
#define WALKGEN_CONTACT_STANCE_F32
#define WG_LIBM(name) name##f
#define WG_UNIT WG_C(1e-5)
#endif

/* A stance inside: r from the centre, ease = 1 / weight, A f = b with A f the sum of (f, r x f); `inertia` of points of mass
 * `ease` (xx, xy, xz, yy, yz, zz). */
struct WG_NAME(wg_contact_stance) {
    int32_t feet, lost[3], turned, force_size, length_size; /* sizes: powers of 2 */
    WG_REAL r[3][WALKGEN_MAX_FEET], ease[WALKGEN_MAX_FEET], b[6], mass, inertia[6], centre[3], axes[3][3], force_unit;
    struct WG_NAME(wg_contact_cones) cones;
};

/* Exponent of a power of 2 above all numbers' sizes; `none` where they are 0. */
static inline int32_t WG_NAME(wg_contact_size)(const WG_REAL *values, int32_t count, int32_t none) {
    WG_REAL largest = WG_C(0.0);
    int i;
    for (i = 0; i < count; ++i) {
        largest = WG_MAX(largest, WG_ABS(values[i]));
    }
    return largest > WG_C(0.0) ? WG_NAME(wg_exponent)(largest) : none;
}

/* Whether numbers are finite. */
static inline int WG_NAME(wg_contact_finite)(const WG_REAL *values, int32_t count) {
    int fine = 1, i;
    for (i = 0; i < count; ++i) {
        fine &= WG_ABS(values[i]) <= WG_HUGE;
    }
    return fine;
}

/* Whether normals are of unit length, friction, weights and bounds in their ranges; by least and greatest values, which pass over a NaN,
 * and a sum, which does not. */
static inline int WG_NAME(wg_contact_fine)(int32_t k, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *weight,
                                           const WG_REAL *n_max) {
    WG_REAL sum = WG_C(0.0), off = sum, smooth = mu[0], rough = mu[0], light = weight[0], heavy = weight[0];
    int i, fine = 1;
    for (i = 0; i < k; ++i) {
        const WG_REAL square = WG_NAME(wg_dot)(normals + 3 * i, normals + 3 * i) - WG_C(1.0);
        sum += square + mu[i] + WG_C(0.0) * weight[i];
        off = WG_MAX(WG_ABS(square), off);
        smooth = WG_MIN(mu[i], smooth);
        rough = WG_MAX(mu[i], rough);
        light = WG_MIN(weight[i], light);
        heavy = WG_MAX(weight[i], heavy);
        fine &= n_max[i] >= WG_C(0.0);
    }
    fine &= (off <= WG_C(2.0) * WG_UNIT) & (smooth >= WG_C(0.0)) & (rough <= WG_C(1.0) / WG_UNIT);
    return fine & (light > WG_C(0.0)) & (heavy <= WG_HUGE) & (sum <= WG_HUGE);
}

/* Points divided by a power of 2, their centre, and r scaled; r is 0 where the points are one to rounding. */
static inline void WG_NAME(wg_contact_place)(const WG_REAL *points, const WG_REAL *weight, struct WG_NAME(wg_contact_stance) * stance) {
    const int32_t k = stance->feet, rows = (k + 3) & ~3, far = WG_NAME(wg_contact_size)(points, 3 * k, 0);
    const WG_REAL shrink = WG_NAME(wg_power)(-far), heavy = WG_NAME(wg_power)(WG_NAME(wg_contact_size)(weight, k, 0));
    WG_REAL sum[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, largest = WG_C(0.0), grow, inverse;
    int32_t size;
    int i, j;
    stance->mass = WG_C(0.0);
    WG_NAME(wg_contact_fill)(stance->ease + rows - 4);
    WG_NAME(wg_contact_fill)(stance->r[0] + rows - 4);
    WG_NAME(wg_contact_fill)(stance->r[1] + rows - 4);
    WG_NAME(wg_contact_fill)(stance->r[2] + rows - 4);
    for (i = 0; i < k; ++i) {
        stance->ease[i] = heavy / weight[i];
        stance->mass += stance->ease[i];
        for (j = 0; j < 3; ++j) {
            stance->r[j][i] = shrink * points[3 * i + j];
            sum[j] += stance->ease[i] * stance->r[j][i];
        }
    }
    inverse = WG_C(1.0) / stance->mass;
    for (i = 0; i < k; ++i) {
        for (j = 0; j < 3; ++j) {
            stance->r[j][i] -= inverse * sum[j];
            largest = WG_MAX(largest, WG_ABS(stance->r[j][i]));
        }
    }
    size = largest <= WG_C(64.0) * WG_EPSILON ? 0 : WG_NAME(wg_exponent)(largest);
    grow = WG_NAME(wg_power)(-size);
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < rows; ++i) {
            stance->r[j][i] *= grow;
        }
        stance->centre[j] = inverse * sum[j] * grow; /* in the unit of r */
    }
    stance->length_size = far + size;
}

/* The load about the centre, scaled, as what the feet must give: b. */
static inline void WG_NAME(wg_contact_load)(const WG_REAL *wrench, struct WG_NAME(wg_contact_stance) * stance) {
    const int32_t none = -100000, force = WG_NAME(wg_contact_size)(wrench, 3, none);
    const int32_t moment = WG_NAME(wg_contact_size)(wrench + 3, 3, none) - stance->length_size;
    const int32_t size = moment > force ? moment : force;
    const WG_REAL by_force = WG_NAME(wg_power)(-size), by_moment = WG_NAME(wg_power)(-size - stance->length_size);
    const WG_REAL F[3] = {by_force * wrench[0], by_force * wrench[1], by_force * wrench[2]};
    WG_REAL arm[3], unit;
    int32_t rest;
    int i;
    WG_NAME(wg_cross)(stance->centre, F, arm);
    for (i = 0; i < 3; ++i) {
        stance->b[i] = -F[i];
        stance->b[3 + i] = arm[i] - by_moment * wrench[3 + i];
    }
    rest = WG_NAME(wg_contact_size)(stance->b, 6, 0);
    unit = WG_NAME(wg_power)(-rest);
    for (i = 0; i < 6; ++i) {
        stance->b[i] *= unit;
    }
    stance->force_size = size + rest;
    stance->force_unit = WG_NAME(wg_power)(size + rest);
}

/* The moment that rounding of the inputs may amount to. */
static inline WG_REAL WG_NAME(wg_contact_noise)(const struct WG_NAME(wg_contact_stance) * stance) {
    WG_REAL M[3];
    WG_NAME(wg_cross)(stance->centre, stance->b, M);
    WG_NAME(wg_add)(M, WG_C(1.0), stance->b + 3, M);
    return WG_C(4096.0) * WG_EPSILON *
           (WG_NAME(wg_norm)(M) + (WG_NAME(wg_norm)(stance->centre) + WG_C(1.0)) * WG_NAME(wg_norm)(stance->b));
}

/* Whether no foot has a bound on its normal force. */
static inline int WG_NAME(wg_contact_is_unbounded)(const struct WG_NAME(wg_contact_stance) * stance) {
    int i, unbounded = 1;
    for (i = 0; i < stance->feet; ++i) {
        unbounded &= !(stance->cones.n_max[i] <= WG_HUGE);
    }
    return unbounded;
}

/* Inertia of the feet about their centre: sum of ease (r'r 1 - r r'). */
static inline void WG_NAME(wg_contact_inertia)(struct WG_NAME(wg_contact_stance) * stance) {
    WG_REAL *J = stance->inertia;
    int i;
    J[0] = J[1] = J[2] = J[3] = J[4] = J[5] = WG_C(0.0);
    for (i = 0; i < stance->feet; ++i) {
        const WG_REAL r[3] = {stance->r[0][i], stance->r[1][i], stance->r[2][i]}, m = stance->ease[i];
        const WG_REAL x = m * r[0], y = m * r[1], z = m * r[2];
        J[0] += y * r[1] + z * r[2];
        J[1] -= x * r[1];
        J[2] -= x * r[2];
        J[3] += x * r[0] + z * r[2];
        J[4] -= y * r[2];
        J[5] += x * r[0] + y * r[1];
    }
}

/* Vectors in the principal axes, component by component `stride` apart. */
static inline void WG_NAME(wg_contact_turn)(const struct WG_NAME(wg_contact_stance) * stance, int32_t count, int stride, WG_REAL *vectors) {
    int i, j;
    for (i = 0; i < count; ++i) {
        const WG_REAL x = vectors[i], y = vectors[stride + i], z = vectors[2 * stride + i];
        for (j = 0; j < 3; ++j) {
            vectors[stride * j + i] = stance->axes[0][j] * x + stance->axes[1][j] * y + stance->axes[2][j] * z;
        }
    }
}

/* Everything turned into the principal axes; moments that no force of any foot has are lost. 0 where the load has one above its
 * noise, and the axis about which it is the largest is `*axis`. */
WG_CALLED int WG_NAME(wg_contact_principal)(struct WG_NAME(wg_contact_stance) * stance, int *axis) {
    const WG_REAL noise = WG_NAME(wg_contact_noise)(stance), *I = stance->inertia;
    const WG_REAL blur = WG_C(64.0) * WG_EPSILON * (WG_C(1.0) + WG_NAME(wg_norm)(stance->centre));
    WG_REAL J[3][3] = {{I[0], I[1], I[2]}, {I[1], I[3], I[4]}, {I[2], I[4], I[5]}};
    int j;
    stance->turned = 1;
    WG_NAME(wg_eigen)(3, J, stance->axes);
    WG_NAME(wg_contact_turn)(stance, stance->feet, WALKGEN_MAX_FEET, stance->r[0]);
    WG_NAME(wg_contact_turn)(stance, stance->feet, WALKGEN_MAX_FEET, stance->cones.n[0]);
    if (stance->cones.facets) {
        WG_NAME(wg_contact_turn)(stance, stance->feet, WALKGEN_MAX_FEET, stance->cones.along[0]);
        WG_NAME(wg_contact_turn)(stance, stance->feet, WALKGEN_MAX_FEET, stance->cones.aside[0]);
    }
    WG_NAME(wg_contact_turn)(stance, 1, 1, stance->b);
    WG_NAME(wg_contact_turn)(stance, 1, 1, stance->b + 3);
    WG_NAME(wg_contact_inertia)(stance);
    *axis = -1;
    for (j = 0; j < 3; ++j) {
        const WG_REAL moment = WG_ABS(stance->b[3 + j]);
        stance->lost[j] = I[j == 0 ? 0 : 2 * j + 1] <= blur * blur * stance->mass;
        if (stance->lost[j] && moment > noise && (*axis < 0 || moment > WG_ABS(stance->b[3 + *axis]))) {
            *axis = j;
        }
    }
    for (j = 0; j < 3 && *axis < 0; ++j) {
        stance->b[3 + j] = stance->lost[j] ? WG_C(0.0) : stance->b[3 + j];
    }
    return *axis < 0;
}

/* Multipliers of forces and moments y inside become the certificate of the inputs' frame and units: certificate . wrench = 1, where y . b
 * is `gain`. */
static inline void WG_NAME(wg_contact_certificate)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL gain,
                                                   WG_REAL certificate[6]) {
    WG_REAL part[6], shift[3];
    int i, j;
    for (i = 0; i < 6; ++i) {
        part[i] = y[i];
        for (j = 0; j < 3 && stance->turned; ++j) {
            part[i] = (j > 0 ? part[i] : WG_C(0.0)) + stance->axes[i % 3][j] * y[i / 3 * 3 + j];
        }
    }
    WG_NAME(wg_cross)(part + 3, stance->centre, shift);
    for (i = 0; i < 3; ++i) {
        certificate[i] = WG_LIBM(ldexp)((shift[i] - part[i]) / gain, -stance->force_size);
        certificate[3 + i] = WG_LIBM(ldexp)(-part[3 + i] / gain, -stance->force_size - stance->length_size);
    }
}

#undef WG_LIBM
#undef WG_UNIT
#endif
