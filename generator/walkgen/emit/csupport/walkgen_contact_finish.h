/* walkgen_contact_finish.h: forces made to balance to the last bits, verified and handed over; walkgen_math.h explains the macros. */
#include "walkgen_contact_newton.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_FINISH_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_FINISH_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_FINISH_F64
#define WG_SHARP WG_C(1e-14)
#define WG_ENOUGH WG_C(1e-12)
#else
#define WALKGEN_CONTACT_FINISH_F32
#define WG_SHARP WG_C(3e-7)
#define WG_ENOUGH WG_C(3e-6)
#endif

/* `to` = `from`, of all feet. */
static inline void WG_NAME(wg_contact_copy)(int32_t feet, WG_REAL from[3][WALKGEN_MAX_FEET], WG_REAL to[3][WALKGEN_MAX_FEET]) {
    int i, j;
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < ((feet + 3) & ~3); ++i) {
            to[j][i] = from[j][i];
        }
    }
}

/* The nearest forces in the cones, in place. */
static inline void WG_NAME(wg_contact_into_cones)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[3][WALKGEN_MAX_FEET]) {
    struct WG_NAME(wg_contact_images) images;
    WG_NAME(wg_contact_nearest)(&stance->cones, f, &images);
    WG_NAME(wg_contact_copy)(stance->feet, images.f, f);
}

/* What the forces lack of b: its length. */
static inline WG_REAL WG_NAME(wg_contact_imbalance)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[3][WALKGEN_MAX_FEET]) {
    WG_REAL rest[6];
    WG_NAME(wg_contact_rest)(stance, f, rest);
    return WG_SQRT(WG_NAME(wg_contact_product)(rest, rest));
}

/* The forces of dual, moved least along their cones' boundaries as found until they balance: large multipliers do not blur them then. What
 * they lack of b in the end. */
WG_CALLED WG_REAL WG_NAME(wg_contact_polish)(const struct WG_NAME(wg_contact_stance) * stance, const struct WG_NAME(wg_contact_dual) * dual,
                                             WG_REAL f[3][WALKGEN_MAX_FEET]) {
    struct WG_NAME(wg_contact_matrix) H;
    WG_REAL rest[6], step[6], z[3][WALKGEN_MAX_FEET], next[3][WALKGEN_MAX_FEET], least = WG_NAME(wg_contact_imbalance)(stance, f), now;
    int turn, i, j;
    for (turn = 0; turn < 5 && !(least <= (turn ? WG_SHARP : WG_ENOUGH)); ++turn) {
        WG_NAME(wg_contact_rest)(stance, f, rest);
        WG_NAME(wg_contact_curvature)(stance, dual, WG_SHARP, &H);
        WG_NAME(wg_contact_solve)(stance, &H, rest, step);
        WG_NAME(wg_contact_pull)(stance, step, z);
        for (i = 0; i < stance->feet; ++i) {
            WG_REAL slope[6], pull[3] = {z[0][i], z[1][i], z[2][i]}, moved[3];
            for (j = 0; j < 6; ++j) {
                slope[j] = dual->images.slope[j][i];
            }
            WG_NAME(wg_contact_apply)(slope, pull, moved);
            for (j = 0; j < 3; ++j) {
                next[j][i] = f[j][i] + stance->ease[i] * moved[j];
            }
        }
        for (i = stance->feet; i < ((stance->feet + 3) & ~3); ++i) {
            next[0][i] = next[1][i] = next[2][i] = WG_C(0.0);
        }
        WG_NAME(wg_contact_into_cones)(stance, next);
        now = WG_NAME(wg_contact_imbalance)(stance, next);
        if (!(now < least)) {
            break;
        }
        least = now;
        WG_NAME(wg_contact_copy)(stance->feet, next, f);
    }
    return least;
}

/* Forces of the inside to the inputs' frame and unit. A foot slides if its force is inside its cone by no more than a few roundings. */
WG_CALLED void WG_NAME(wg_contact_hand_over)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL f[3][WALKGEN_MAX_FEET],
                                             WG_REAL *out, int32_t *state) {
    const struct WG_NAME(wg_contact_cones) *cones = &stance->cones;
    int i, j;
    for (i = 0; i < stance->feet; ++i) {
        const WG_REAL g[3] = {f[0][i], f[1][i], f[2][i]}, N = cones->n[0][i] * g[0] + cones->n[1][i] * g[1] + cones->n[2][i] * g[2];
        const WG_REAL width = (WG_C(1.0) + WG_C(32.0) * WG_EPSILON) * WG_NAME(wg_contact_width)(cones, i, g, N);
        const int bears = WG_ABS(g[0]) + WG_ABS(g[1]) + WG_ABS(g[2]) > WG_C(0.0);
        const int inside = width <= cones->mu[i] * WG_MIN(N, cones->n_max[i]);
        state[i] = !bears ? WG_CONTACT_FREE : inside && cones->mu[i] > WG_C(0.0) ? WG_CONTACT_STICK : WG_CONTACT_SLIDE;
        for (j = 0; j < 3; ++j) {
            const WG_REAL(*axes)[3] = (const WG_REAL(*)[3])stance->axes;
            out[3 * i + j] = stance->force_unit * (stance->turned ? WG_NAME(wg_dot)(axes[j], g) : g[j]);
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

/* The least distance of balanced forces from their cones that follows from a proof's products z and `whole`; z may be too
 * large to square. */
static inline WG_REAL WG_NAME(wg_contact_distance)(const struct WG_NAME(wg_contact_stance) * stance, WG_REAL z[3][WALKGEN_MAX_FEET],
                                                   WG_REAL whole) {
    const WG_REAL gain = WG_NAME(wg_contact_worth)(&stance->cones, stance->feet, z, whole);
    WG_REAL square = WG_C(0.0), largest = WG_C(0.0);
    int i;
    for (i = 0; i < 3 * stance->feet; ++i) {
        largest = WG_MAX(largest, WG_ABS(z[i % 3][i / 3]));
    }
    for (i = 0; i < 3 * stance->feet && largest > WG_C(0.0); ++i) {
        const WG_REAL part = z[i % 3][i / 3] / largest;
        square += part * part;
    }
    return largest > WG_C(0.0) ? gain / largest / WG_SQRT(square) * stance->force_unit : WG_INFINITY;
}

/* The certificate of multipliers that are a proof, and the violation. */
static inline void WG_NAME(wg_contact_refute)(const struct WG_NAME(wg_contact_stance) * stance, const WG_REAL y[6], WG_REAL certificate[6],
                                              WG_REAL *violation) {
    const WG_REAL whole = WG_NAME(wg_contact_product)(stance->b, y);
    WG_REAL z[3][WALKGEN_MAX_FEET];
    WG_NAME(wg_contact_pull)(stance, y, z);
    WG_NAME(wg_contact_certificate)(stance, y, whole, certificate);
    *violation = WG_NAME(wg_contact_distance)(stance, z, whole);
}

#undef WG_SHARP
#undef WG_ENOUGH
#endif
