/* walkgen_contact_vertical.h: three feet without friction: their normal forces from balance; walkgen_math.h explains the macros. */
#include "walkgen_stance.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_VERTICAL_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_VERTICAL_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_VERTICAL_F64
#else
#define WALKGEN_CONTACT_VERTICAL_F32
#endif

/* Normal forces N of three feet in the stance's unit that leave the least of the load unbalanced, and how much: 0 where the feet do not
 * determine them. */
static inline int WG_NAME(wg_normal_forces)(const struct WG_NAME(wg_stance) * stance, const WG_REAL *normals, WG_REAL N[3], WG_REAL *left) {
    WG_REAL set[6][6], triangle[6][6], along[6], rest[6];
    int i, j;
    for (i = 0; i < 3; ++i) {
        WG_NAME(wg_stance_push)(stance, i, normals + 3 * i, set[i]);
    }
    if (!(stance->blur <= WG_C(1.0)) || !WG_NAME(wg_stance_orthonormal)(set, 3, stance->blur, triangle)) {
        return 0;
    }
    for (i = 0; i < 6; ++i) {
        rest[i] = -stance->load[i];
    }
    *left = WG_NAME(wg_stance_across)(set, 3, rest, along);
    for (i = 2; i >= 0; --i) {
        N[i] = along[i];
        for (j = i + 1; j < 3; ++j) {
            N[i] -= triangle[j][i] * N[j];
        }
        N[i] /= triangle[i][i];
    }
    return 1;
}

/* Forces f [3, 3] along the normals of k = 3 feet that balance the load, or leave the least of it: the unbalanced part, moments over the
 * feet's root mean square distance from their centre, is `violation`. On a plane these are the three equations of force and moments across
 * it, and the load along the plane is the violation. State 0 of a foot, 2 where its force is 0. OK; INFEASIBLE with NaN f where a foot
 * would have to pull, violation the largest pull; SINGULAR with NaN where the feet are on a line or coincide, so that they determine no
 * forces; BAD_INPUT with NaN where k is not 3, a number is not finite or a normal is not a unit vector. */
static inline void WG_NAME(wg_contact_vertical)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT normals,
                                                const WG_REAL *WG_RESTRICT wrench, WG_REAL *WG_RESTRICT f, int32_t *WG_RESTRICT status,
                                                int32_t *WG_RESTRICT state, WG_REAL *WG_RESTRICT violation) {
    const int known = k >= 1 && k <= WALKGEN_MAX_FEET ? k : 0;
    struct WG_NAME(wg_stance) stance;
    WG_REAL N[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, pull;
    int i;
    *violation = WG_NAN;
    stance.force = WG_C(1.0);
    *status = WALKGEN_BAD_INPUT;
    if (k == 3 && WG_NAME(wg_stance_place)(k, points, &stance) && WG_NAME(wg_stance_unit)(k, normals) &&
        WG_NAME(wg_stance_load)(wrench, &stance)) {
        *status = WALKGEN_SINGULAR;
        if (WG_NAME(wg_normal_forces)(&stance, normals, N, violation)) {
            pull = WG_MAX(WG_MAX(-N[0], -N[1]), -N[2]);
            *status = pull > WG_C(64.0) * WG_EPSILON ? WALKGEN_INFEASIBLE : WALKGEN_OK;
            *violation = stance.force * (*status == WALKGEN_OK ? *violation : pull);
        }
    }
    for (i = 0; i < known; ++i) {
        state[i] = *status == WALKGEN_OK && N[i] > WG_C(0.0) ? WG_CONTACT_STICK : WG_CONTACT_FREE;
    }
    for (i = 0; i < 3 * known; ++i) {
        f[i] = *status == WALKGEN_OK ? WG_MAX(N[i / 3], WG_C(0.0)) * stance.force * normals[i] : WG_NAN;
    }
}

#endif
