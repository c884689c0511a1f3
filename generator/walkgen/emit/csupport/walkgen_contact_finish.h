/* walkgen_contact_finish.h: forces made to balance to the last bits, verified and handed over; walkgen_math.h explains the macros. */
#include "walkgen_contact_newton.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_FINISH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_FINISH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_FINISH_F64
#define WG_LIBM(name) name
#define WG_SHARP WG_C(1e-14)
#else
#define WALKGEN_CONTACT_FINISH_F32
#define WG_LIBM(name) name##f
#define WG_SHARP WG_C(3e-7)
#endif

/* The force in a foot's cone nearest to f. */
static inline void WG_NAME(wg_contact_in_cone)(const struct WG_NAME(wg_contact_cone) * cone, WG_REAL f[3]) {
    struct WG_NAME(wg_contact_image) image;
    int j;
    if (cone->facets) {
        WG_NAME(wg_contact_nearest_faceted)(cone, f, &image);
    } else {
        WG_NAME(wg_contact_nearest)(cone, f, &image);
    }
    for (j = 0; j < 3; ++j) {
        f[j] = image.f[j];
    }
}

/* What the forces lack of b: its length. */
static inline WG_REAL WG_NAME(wg_contact_balance)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[][3], WG_REAL lacking[6]) {
    int i;
    for (i = 0; i < 6; ++i) {
        lacking[i] = stance->b[i];
    }
    for (i = 0; i < stance->feet; ++i) {
        WG_NAME(wg_contact_push)(f[i], stance->r[i], WG_C(-1.0), lacking);
    }
    for (i = 0; i < 3; ++i) {
        lacking[3 + i] = stance->lost[i] ? WG_C(0.0) : lacking[3 + i];
    }
    return WG_SQRT(WG_NAME(wg_contact_product)(lacking, lacking));
}

/* The forces of dual, moved least along their cones' boundaries as found until they balance: large multipliers do not blur them then.
 * What they still lack. */
static inline WG_REAL WG_NAME(wg_contact_polish)(const struct WG_NAME(wg_contact_stance) * stance, const struct WG_NAME(wg_contact_dual) * dual,
                                                 WG_REAL f[WALKGEN_MAX_FEET][3]) {
    WG_REAL lacking[6], H[6][6], step[6], z[3], best[WALKGEN_MAX_FEET][3], least, now;
    int turn, i, j, row;
    for (i = 0; i < 3 * stance->feet; ++i) {
        best[i / 3][i % 3] = f[i / 3][i % 3] = dual->image[i / 3].f[i % 3];
    }
    least = WG_NAME(wg_contact_balance)(stance, f, lacking);
    for (turn = 0; turn < 5 && least > WG_SHARP; ++turn) {
        WG_NAME(wg_contact_curvature)(stance, dual, WG_SHARP, H);
        WG_NAME(wg_contact_solve)(stance, lacking, H, step);
        for (i = 0; i < stance->feet; ++i) {
            const struct WG_NAME(wg_contact_image) *image = &dual->image[i];
            WG_NAME(wg_contact_pull)(step, stance->r[i], z);
            for (j = 0; j < 3; ++j) {
                f[i][j] += image->full ? stance->ease[i] * z[j] : WG_C(0.0);
            }
            for (row = 0; row < image->count; ++row) {
                WG_NAME(wg_add)(f[i], stance->ease[i] * image->c[row] * WG_NAME(wg_dot)(image->v[row], z), image->v[row], f[i]);
            }
            WG_NAME(wg_contact_in_cone)(&stance->cone[i], f[i]);
        }
        now = WG_NAME(wg_contact_balance)(stance, f, lacking);
        if (!(now < least)) {
            break;
        }
        least = now;
        for (i = 0; i < 3 * stance->feet; ++i) {
            best[i / 3][i % 3] = f[i / 3][i % 3];
        }
    }
    for (i = 0; i < 3 * stance->feet; ++i) {
        f[i / 3][i % 3] = best[i / 3][i % 3];
    }
    return least;
}

/* How a foot bears inside its cone: sticking, sliding, free. */
static inline int32_t WG_NAME(wg_contact_state)(const struct WG_NAME(wg_contact_cone) * cone, const WG_REAL f[3]) {
    struct WG_NAME(wg_contact_image) image;
    WG_REAL inside[3];
    const WG_REAL N = WG_NAME(wg_dot)(cone->n, f);
    int j;
    if (!(N > WG_C(0.0))) {
        return WG_CONTACT_FREE;
    }
    for (j = 0; j < 3; ++j) { /* outside by a few roundings if f is on the boundary */
        inside[j] = f[j] + WG_C(16.0) * WG_EPSILON * (f[j] - N * cone->n[j]);
    }
    if (cone->facets) {
        WG_NAME(wg_contact_nearest_faceted)(cone, inside, &image);
    } else {
        WG_NAME(wg_contact_nearest)(cone, inside, &image);
    }
    return image.state;
}

/* Forces of the inside to the inputs' frame and unit; the states. */
static inline void WG_NAME(wg_contact_hand_over)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[][3], WG_REAL *out,
                                                 int32_t *state) {
    int i, j;
    for (i = 0; i < stance->feet; ++i) {
        state[i] = WG_NAME(wg_contact_state)(&stance->cone[i], f[i]);
        for (j = 0; j < 3; ++j) {
            const WG_REAL part = stance->turned ? WG_NAME(wg_dot)(stance->axes[j], f[i]) : f[i][j];
            out[3 * i + j] = WG_LIBM(ldexp)(part, stance->force_size);
        }
    }
}

/* No forces: NaN, or 0 where there is no load; all feet free, no certificate. */
static inline void WG_NAME(wg_contact_blank)(int32_t k, WG_REAL value, WG_REAL *f, int32_t *state, WG_REAL certificate[6],
                                             WG_REAL *violation) {
    int i;
    for (i = 0; i < 3 * k && k <= WALKGEN_MAX_FEET; ++i) {
        f[i] = value;
        state[i / 3] = WG_CONTACT_FREE;
    }
    for (i = 0; i < 6; ++i) {
        certificate[i] = value;
    }
    *violation = value;
}

/* The certificate of multipliers that prove `gain`, and the least distance of balanced forces from their cones that follows from it. */
static inline void WG_NAME(wg_contact_refute)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL gain,
                                              WG_REAL certificate[6], WG_REAL *violation) {
    const WG_REAL whole = WG_NAME(wg_contact_product)(stance->b, y);
    WG_REAL z[3], square = WG_C(0.0);
    int i;
    for (i = 0; i < stance->feet; ++i) {
        WG_NAME(wg_contact_pull)(y, stance->r[i], z);
        square += stance->ease[i] * WG_NAME(wg_dot)(z, z);
    }
    WG_NAME(wg_contact_certificate)(stance, y, whole, certificate);
    *violation = square > WG_C(0.0) ? WG_LIBM(ldexp)(gain / WG_SQRT(square), stance->force_size) : WG_INFINITY;
}

#undef WG_LIBM
#undef WG_SHARP
#endif
