/* walkgen_conic.h: how far forces within cones reach along a direction of loads; walkgen_math.h explains the macros.
 *
 *     maximise s   subject to   A x + s a = b,   x_i = (normal, two tangential parts) with normal >= |tangential|
 *     minimise b . y   subject to   z = A' y within the same cones,   a . y = 1
 *
 * A primal-dual interior-point method. The answer is as good as the residuals and the gap that it states.
 */
#include "walkgen_conic_step.h"

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

/* A start without any knowledge. */
static inline void WG_NAME(wg_conic_start)(struct WG_NAME(wg_conic) * conic) {
    int i;
    for (i = 0; i < 3 * conic->cones; ++i) {
        conic->x[i] = conic->z[i] = WG_INDICATOR(i % 3 == 0);
    }
    for (i = 0; i < 6; ++i) {
        conic->y[i] = WG_C(0.0);
    }
    conic->s = WG_C(0.0);
}

/* Whether the point is the answer to rounding. */
static inline int WG_NAME(wg_conic_closed)(const struct WG_NAME(wg_conic) * conic) {
    return conic->gap <= WG_SHARP && conic->lacking <= WG_C(8.0) * WG_SHARP;
}

/* x, z, y, s; ends early with forces that reach as far as `enough`. Whether the gap is closed. */
static inline int WG_NAME(wg_conic_solve)(WG_REAL enough, struct WG_NAME(wg_conic) * conic) {
    struct WG_NAME(wg_conic_step) step;
    int turn;
    WG_NAME(wg_conic_start)(conic);
    for (turn = 0; turn < 80; ++turn) {
        if (!WG_NAME(wg_conic_prepare)(conic, &step) || WG_NAME(wg_conic_closed)(conic)) {
            break;
        }
        if (conic->s > enough && conic->unbalanced <= WG_C(1e3) * WG_ROUGH) {
            WG_NAME(wg_conic_balance)(&step, conic);
            break;
        }
        if (!WG_NAME(wg_conic_advance)(&step, conic)) {
            break;
        }
    }
    return conic->gap <= WG_ROUGH && conic->lacking <= WG_ROUGH;
}

#undef WG_SHARP
#undef WG_ROUGH
#endif
