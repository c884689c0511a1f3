/* walkgen_slip.h: how a tripod of given pose begins to slip, and with which friction; walkgen_math.h explains the macros. */
#include "walkgen_slip_search.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SLIP_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SLIP_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SLIP_F64
#define WG_NONE WG_C(1e-9)
#else
#define WALKGEN_SLIP_F32
#define WG_NONE WG_C(1e-4)
#endif

/* The tripod read: 1, or 0 where its normals and points do not leave three admissible twists, -1 where an input is bad. */
static inline int WG_NAME(wg_slip_read)(int32_t k, const WG_REAL *points, const WG_REAL *normals, const WG_REAL *wrench,
                                        struct WG_NAME(wg_tripod) * slip) {
    WG_REAL set[6][6], triangle[6][6];
    int i, j, foot;
    if (k != 3 || !WG_NAME(wg_stance_place)(k, points, &slip->stance) || !WG_NAME(wg_stance_unit)(k, normals) ||
        !WG_NAME(wg_stance_load)(wrench, &slip->stance)) {
        return -1;
    }
    slip->normals = normals;
    for (foot = 0; foot < 3; ++foot) {
        WG_NAME(wg_stance_push)(&slip->stance, foot, normals + 3 * foot, slip->press[foot]);
        for (i = 0; i < 6; ++i) {
            set[foot][i] = slip->press[foot][i];
        }
    }
    if (!(slip->stance.blur <= WG_C(1.0)) || !WG_NAME(wg_stance_orthonormal)(set, 3, slip->stance.blur, triangle)) {
        return 0;
    }
    WG_NAME(wg_stance_complete)(set, 3);
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < 6; ++i) {
            slip->B[j][i] = set[3 + j][i];
        }
        for (foot = 0; foot < 3; ++foot) {
            WG_NAME(wg_cross)(slip->B[j] + 3, slip->stance.r[foot], slip->speed[foot][j]);
            WG_NAME(wg_add)(slip->speed[foot][j], WG_C(1.0), slip->B[j], slip->speed[foot][j]);
        }
    }
    return 1;
}

/* Normal forces that balance the load and the friction of the present twist. */
static inline void WG_NAME(wg_slip_press)(struct WG_NAME(wg_tripod) * slip) {
    struct WG_NAME(wg_stance) pushed = slip->stance;
    WG_REAL V[3], wrench[6], left, N[3];
    int i, foot;
    for (foot = 0; foot < 3; ++foot) {
        WG_REAL length;
        WG_NAME(wg_slip_velocity)(slip, foot, slip->tau, V);
        length = WG_NAME(wg_norm)(V);
        WG_NAME(wg_stance_push)(&slip->stance, foot, V, wrench);
        for (i = 0; i < 6 && length > WG_C(0.0); ++i) {
            pushed.load[i] -= slip->mu * slip->N[foot] / length * wrench[i];
        }
    }
    if (WG_NAME(wg_normal_forces)(&pushed, slip->normals, N, &left)) {
        for (foot = 0; foot < 3; ++foot) {
            slip->N[foot] = WG_MAX(N[foot], WG_C(1e-3));
        }
    }
}

/* tau and mu for the present normal forces, smoothed less and less. */
static inline void WG_NAME(wg_slip_start)(const WG_REAL power[3], struct WG_NAME(wg_tripod) * slip) {
    const WG_REAL square = WG_NAME(wg_dot)(power, power), size = WG_SQRT(square);
    WG_REAL blunt = WG_C(1.0), V[3], sum = WG_C(0.0);
    int i;
    WG_NAME(wg_add)(power, WG_C(1.0) / square - WG_C(1.0), power, slip->tau);
    for (i = 0; i < 6; ++i) {
        WG_NAME(wg_slip_ease)(slip, power, blunt / size);
        blunt *= WG_C(0.1);
    }
    for (i = 0; i < 3; ++i) {
        WG_NAME(wg_slip_velocity)(slip, i, slip->tau, V);
        sum += slip->N[i] * WG_NAME(wg_norm)(V);
    }
    slip->mu = WG_NAME(wg_dot)(power, slip->tau) / sum;
    WG_NAME(wg_add)(slip->tau, WG_C(1.0) / WG_NAME(wg_norm)(slip->tau) - WG_C(1.0), slip->tau, slip->tau);
}

/* Newton from a start with all feet sliding, then with one held; whether one of them ends in a slip. */
static inline int WG_NAME(wg_slip_solved)(const WG_REAL power[3], struct WG_NAME(wg_tripod) * slip) {
    const struct WG_NAME(wg_tripod) start = *slip;
    int foot, i;
    for (foot = -1; foot < 3; ++foot) {
        *slip = start;
        slip->held = foot;
        for (i = 0; i < 3; ++i) {
            slip->T[i] = WG_C(0.0);
        }
        if ((foot < 0 || WG_NAME(wg_slip_about)(foot, power, slip)) && WG_NAME(wg_slip_newton)(slip) &&
            WG_NAME(wg_slip_holds)(slip, power)) {
            return 1;
        }
    }
    *slip = start;
    return 0;
}

/* The slip searched for: 1, or 0. */
static inline int WG_NAME(wg_slip_search)(const WG_REAL power[3], struct WG_NAME(wg_tripod) * slip) {
    int turn, again;
    for (turn = 0; turn < 8; ++turn) {
        for (again = 0; again <= 2 * turn; ++again) {
            WG_NAME(wg_slip_start)(power, slip);
            if (again < 2 * turn) {
                WG_NAME(wg_slip_press)(slip);
            }
        }
        if (WG_NAME(wg_slip_solved)(power, slip)) {
            return 1;
        }
    }
    return 0;
}

/* The twist about the frame's origin, and its axis: a point c = w x v / |w|^2, the direction w / |w|, and the pitch w . v / |w|^2; whether
 * there is one. */
static inline int WG_NAME(wg_slip_axis)(const struct WG_NAME(wg_tripod) * slip, WG_REAL twist[6], WG_REAL axis[6], WG_REAL *pitch) {
    WG_REAL shift[3], square, size;
    int i, turning;
    for (i = 0; i < 6; ++i) {
        twist[i] = slip->tau[0] * slip->B[0][i] + slip->tau[1] * slip->B[1][i] + slip->tau[2] * slip->B[2][i];
    }
    turning = WG_NAME(wg_norm)(twist + 3) > WG_NONE;
    WG_NAME(wg_cross)(twist + 3, slip->stance.centre, shift);
    for (i = 0; i < 3; ++i) {
        twist[3 + i] = turning ? twist[3 + i] / slip->stance.length : WG_C(0.0);
        twist[i] -= turning ? shift[i] / slip->stance.length : WG_C(0.0);
    }
    size = WG_SQRT(WG_NAME(wg_stance_product)(twist, twist));
    for (i = 0; i < 6; ++i) {
        twist[i] /= size;
    }
    square = WG_NAME(wg_dot)(twist + 3, twist + 3);
    WG_NAME(wg_cross)(twist + 3, twist, axis);
    for (i = 0; i < 3; ++i) {
        axis[i] = turning ? axis[i] / square : WG_NAN;
        axis[3 + i] = turning ? twist[3 + i] / WG_SQRT(square) : WG_NAN;
    }
    *pitch = turning ? WG_NAME(wg_dot)(twist, twist + 3) / square : WG_INFINITY;
    return turning;
}

/* The slip of a tripod that was read: its status, and whether it was found in `*found`. */
static inline int32_t WG_NAME(wg_slip_find)(const WG_REAL *normals, struct WG_NAME(wg_tripod) * slip, int *found) {
    WG_REAL power[3], left;
    int i, pulls = 0;
    *found = WG_NAME(wg_normal_forces)(&slip->stance, normals, slip->N, &left);
    for (i = 0; i < 3; ++i) {
        power[i] = WG_NAME(wg_stance_product)(slip->B[i], slip->stance.load);
        pulls |= slip->N[i] < -WG_NONE;
        slip->tau[i] = slip->T[i] = WG_C(0.0);
    }
    slip->mu = WG_C(0.0);
    slip->held = -1;
    if (!(WG_NAME(wg_norm)(power) > WG_MAX(slip->stance.noise, WG_C(8.0) * WG_EPSILON))) {
        *found = pulls ? 0 : *found;
        return pulls ? WALKGEN_INFEASIBLE : WALKGEN_SINGULAR;
    }
    for (i = 0; i < 3; ++i) {
        slip->N[i] = WG_MAX(slip->N[i], WG_C(1e-3));
    }
    *found = WG_NAME(wg_slip_search)(power, slip);
    return *found ? WALKGEN_OK : pulls ? WALKGEN_INFEASIBLE : WALKGEN_NO_CONVERGENCE;
}

/* The forces of a tripod [3], [3, 3]; NaN unless `found`. */
static inline void WG_NAME(wg_slip_forces)(const struct WG_NAME(wg_tripod) * slip, const WG_REAL *WG_RESTRICT normals, int found,
                                           WG_REAL *WG_RESTRICT normal_forces, WG_REAL *WG_RESTRICT f) {
    WG_REAL V[3], rub;
    int i, j;
    for (i = 0; i < 3; ++i) {
        normal_forces[i] = found ? slip->N[i] * slip->stance.force : WG_NAN;
        for (j = 0; j < 3; ++j) {
            f[3 * i + j] = normal_forces[i] * normals[3 * i + j];
        }
        if (found && slip->mu > WG_C(0.0)) {
            WG_NAME(wg_slip_velocity)(slip, i, slip->tau, V);
            rub = slip->mu * slip->N[i] * slip->stance.force / WG_MAX(WG_NAME(wg_norm)(V), WG_TINY);
            for (j = 0; j < 3; ++j) {
                f[3 * i + j] += i == slip->held ? slip->T[j] * slip->stance.force : -rub * V[j];
            }
        }
    }
}

/* The slip of a tripod, k = 3, at points [3, 3] with unit normals [3, 3], on the verge of which friction mu brings it: mu, normal_forces
 * [3], forces f [3, 3], and the twist [6] (velocity of the frame's origin, angular velocity; length 1) by which it begins: feet slide along
 * the ground against their friction mu N, or one of them stays with less. axis [6]: a point of the twist's axis and its direction; pitch:
 * advance over turn. OK; SINGULAR where the slip is a translation, with no axis (NaN, pitch infinite), where the load has nothing along the
 * ground (mu 0, twist NaN), or with all NaN where feet are on a line; INFEASIBLE where a foot would have to pull on a plane; NO_CONVERGENCE
 * where no slip is found; BAD_INPUT; with NaN. On curved ground there may be another slip. */
static inline void WG_NAME(wg_slip)(int32_t k, const WG_REAL *WG_RESTRICT points, const WG_REAL *WG_RESTRICT normals,
                                    const WG_REAL *WG_RESTRICT wrench, WG_REAL *WG_RESTRICT normal_forces, WG_REAL *WG_RESTRICT f,
                                    WG_REAL *WG_RESTRICT twist, WG_REAL *WG_RESTRICT mu, WG_REAL *WG_RESTRICT axis,
                                    WG_REAL *WG_RESTRICT pitch,
                                    int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_tripod) slip;
    int i, found = WG_NAME(wg_slip_read)(k, points, normals, wrench, &slip);
    *status = found < 0 ? WALKGEN_BAD_INPUT : WALKGEN_SINGULAR;
    *mu = *pitch = WG_NAN;
    for (i = 0; i < 6; ++i) {
        twist[i] = axis[i] = WG_NAN;
    }
    if (found > 0) {
        *status = WG_NAME(wg_slip_find)(normals, &slip, &found);
        if (*status == WALKGEN_OK && !WG_NAME(wg_slip_axis)(&slip, twist, axis, pitch)) {
            *status = WALKGEN_SINGULAR;
        }
        *mu = found ? slip.mu : WG_NAN;
    }
    if (k == 3) {
        WG_NAME(wg_slip_forces)(&slip, normals, found > 0, normal_forces, f);
    }
}

#undef WG_NONE
#endif
