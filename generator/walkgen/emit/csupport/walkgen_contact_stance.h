/* walkgen_contact_stance.h: feet, cones and load of a stance, checked, scaled and seen from the feet's centre; walkgen_math.h explains the
 * macros.
 *
 * Inside, lengths are divided by that of the stance and forces by that of the load, both by powers of 2, so that scaling a load scales the
 * forces to the last bit; moments are about the centre of the feet (weighted by 1 / weight). Where the feet stand nearly on a line, the axes
 * are the principal ones, so that what the line cannot carry is one component: `lost`.
 */
#include "walkgen_contact_cones.h"

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
#ifndef WALKGEN_MAX_FEET
#define WALKGEN_MAX_FEET 16
#endif

/* A stance inside: r from the centre, ease = 1 / weight, A f = b with A f the sum of (f, r x f); `inertia` of points of mass `ease`. */
struct WG_NAME(wg_contact_stance) {
    int32_t feet, lost[3], turned, force_size, length_size; /* sizes: powers of 2 */
    WG_REAL r[WALKGEN_MAX_FEET][3], ease[WALKGEN_MAX_FEET], b[6], mass, inertia[3][3], centre[3], axes[3][3];
    struct WG_NAME(wg_contact_cone) cone[WALKGEN_MAX_FEET];
};

/* Exponent of a power of 2 above all numbers' sizes; `none` where they are 0. */
static inline int32_t WG_NAME(wg_contact_size)(const WG_REAL *values, int32_t count, int32_t none) {
    WG_REAL largest = WG_C(0.0);
    int exponent = 0, i;
    for (i = 0; i < count; ++i) {
        largest = WG_MAX(largest, WG_ABS(values[i]));
    }
    (void)WG_LIBM(frexp)(largest, &exponent);
    return largest > WG_C(0.0) ? exponent : none;
}

/* Whether numbers are finite. */
static inline int WG_NAME(wg_contact_finite)(const WG_REAL *values, int32_t count) {
    int fine = 1, i;
    for (i = 0; i < count; ++i) {
        fine &= WG_ABS(values[i]) <= WG_HUGE;
    }
    return fine;
}

/* Whether a stance is one: sizes, unit normals, friction, weights and bounds in their ranges. */
static inline int WG_NAME(wg_contact_fine)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *mu, const WG_REAL *wrench,
                                           const WG_REAL *weight, const WG_REAL *n_max, int32_t facets) {
    int i, fine = k >= 1 && k <= WALKGEN_MAX_FEET && (facets == 0 || (facets >= 3 && facets <= 1000000));
    if (!fine) {
        return 0;
    }
    fine = WG_NAME(wg_contact_finite)(points, 3 * k) && WG_NAME(wg_contact_finite)(wrench, 6);
    for (i = 0; i < k; ++i) {
        const WG_REAL square = WG_NAME(wg_dot)(normals + 3 * i, normals + 3 * i);
        fine &= WG_ABS(square - WG_C(1.0)) <= WG_C(2.0) * WG_UNIT && mu[i] >= WG_C(0.0) && mu[i] <= WG_C(1.0) / WG_UNIT;
        fine &= weight[i] > WG_C(0.0) && weight[i] <= WG_HUGE && n_max[i] >= WG_C(0.0);
    }
    return fine;
}

/* Points divided by a power of 2, their centre, and r scaled; r is 0 where the points are one to rounding. */
static inline void WG_NAME(wg_contact_place)(const WG_REAL *points, const WG_REAL *weight, struct WG_NAME(wg_contact_stance) * stance) {
    const int32_t k = stance->feet, far = WG_NAME(wg_contact_size)(points, 3 * k, 0);
    const int32_t heavy = WG_NAME(wg_contact_size)(weight, k, 0);
    int32_t size;
    int i, j;
    stance->mass = WG_C(0.0);
    for (i = 0; i < k; ++i) {
        stance->ease[i] = WG_C(1.0) / WG_LIBM(ldexp)(weight[i], -heavy);
        stance->mass += stance->ease[i];
    }
    for (j = 0; j < 3; ++j) {
        stance->centre[j] = WG_C(0.0);
        for (i = 0; i < k; ++i) {
            stance->r[i][j] = WG_LIBM(ldexp)(points[3 * i + j], -far);
            stance->centre[j] += stance->ease[i] / stance->mass * stance->r[i][j];
        }
    }
    for (i = 0; i < k; ++i) {
        WG_NAME(wg_add)(stance->r[i], WG_C(-1.0), stance->centre, stance->r[i]);
    }
    size = WG_NAME(wg_contact_size)(&stance->r[0][0], 3 * k, 0);
    if (WG_LIBM(ldexp)(WG_C(1.0), size) <= WG_C(64.0) * WG_EPSILON) {
        size = 0;
    }
    for (i = 0; i < 3 * k; ++i) {
        stance->r[i / 3][i % 3] = WG_LIBM(ldexp)(stance->r[i / 3][i % 3], -size);
    }
    stance->length_size = far + size;
    for (j = 0; j < 3; ++j) {
        stance->centre[j] = WG_LIBM(ldexp)(stance->centre[j], -size); /* in the unit of r */
    }
}

/* The load about the centre, scaled, as what the feet must give: b. The moment that rounding of the inputs may amount to. */
static inline WG_REAL WG_NAME(wg_contact_load)(const WG_REAL *wrench, struct WG_NAME(wg_contact_stance) * stance) {
    const int32_t none = -100000, force = WG_NAME(wg_contact_size)(wrench, 3, none);
    const int32_t moment = WG_NAME(wg_contact_size)(wrench + 3, 3, none) - stance->length_size;
    const int32_t size = moment > force ? moment : force;
    WG_REAL F[3], M[3], arm[3], noise;
    int32_t rest;
    int i;
    for (i = 0; i < 3; ++i) {
        F[i] = WG_LIBM(ldexp)(wrench[i], -size);
        M[i] = WG_LIBM(ldexp)(wrench[3 + i], -size - stance->length_size);
    }
    WG_NAME(wg_cross)(stance->centre, F, arm);
    noise = WG_NAME(wg_norm)(M) + (WG_NAME(wg_norm)(stance->centre) + WG_C(1.0)) * WG_NAME(wg_norm)(F);
    for (i = 0; i < 3; ++i) {
        stance->b[i] = -F[i];
        stance->b[3 + i] = arm[i] - M[i];
    }
    rest = WG_NAME(wg_contact_size)(stance->b, 6, 0);
    for (i = 0; i < 6; ++i) {
        stance->b[i] = WG_LIBM(ldexp)(stance->b[i], -rest);
    }
    stance->force_size = size + rest;
    return WG_C(4096.0) * WG_EPSILON * WG_LIBM(ldexp)(noise, -rest);
}

/* Inertia of the feet about their centre: sum of ease (r'r 1 - r r'). */
static inline void WG_NAME(wg_contact_inertia)(struct WG_NAME(wg_contact_stance) * stance) {
    int i, j, m;
    for (j = 0; j < 9; ++j) {
        stance->inertia[j / 3][j % 3] = WG_C(0.0);
    }
    for (i = 0; i < stance->feet; ++i) {
        const WG_REAL *r = stance->r[i];
        for (j = 0; j < 3; ++j) {
            for (m = 0; m < 3; ++m) {
                stance->inertia[j][m] += stance->ease[i] * (j == m ? r[(j + 1) % 3] * r[(j + 1) % 3] + r[(j + 2) % 3] * r[(j + 2) % 3] : -r[j] * r[m]);
            }
        }
    }
}

/* A vector in the principal axes. */
static inline void WG_NAME(wg_contact_turn)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL *vector) {
    const WG_REAL x = vector[0], y = vector[1], z = vector[2];
    int i;
    for (i = 0; i < 3; ++i) {
        vector[i] = stance->axes[0][i] * x + stance->axes[1][i] * y + stance->axes[2][i] * z;
    }
}

/* Everything turned into the principal axes; moments that no force of any foot has are lost. 0 where the load has one above `noise`,
 * and the axis about which it is the largest is `*axis`. */
static inline int WG_NAME(wg_contact_principal)(WG_REAL noise, struct WG_NAME(wg_contact_stance) * stance, int *axis) {
    const WG_REAL blur = WG_C(64.0) * WG_EPSILON * (WG_C(1.0) + WG_NAME(wg_norm)(stance->centre));
    int i, j;
    stance->turned = 1;
    WG_NAME(wg_eigen)(3, stance->inertia, stance->axes);
    for (i = 0; i < stance->feet; ++i) {
        WG_NAME(wg_contact_turn)(stance, stance->r[i]);
        WG_NAME(wg_contact_turn)(stance, stance->cone[i].n);
        WG_NAME(wg_contact_turn)(stance, stance->cone[i].t[0]);
        WG_NAME(wg_contact_turn)(stance, stance->cone[i].t[1]);
    }
    WG_NAME(wg_contact_turn)(stance, stance->b);
    WG_NAME(wg_contact_turn)(stance, stance->b + 3);
    WG_NAME(wg_contact_inertia)(stance);
    *axis = -1;
    for (j = 0; j < 3; ++j) {
        stance->lost[j] = stance->inertia[j][j] <= blur * blur * stance->mass;
        if (stance->lost[j] && WG_ABS(stance->b[3 + j]) > noise && (*axis < 0 || WG_ABS(stance->b[3 + j]) > WG_ABS(stance->b[3 + *axis]))) {
            *axis = j;
        }
    }
    for (j = 0; j < 3 && *axis < 0; ++j) {
        stance->b[3 + j] = stance->lost[j] ? WG_C(0.0) : stance->b[3 + j];
    }
    return *axis < 0;
}

/* Multipliers of forces and moments y inside become the certificate of the inputs' frame and units: certificate . wrench = 1, where y . b is
 * `gain`. */
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
