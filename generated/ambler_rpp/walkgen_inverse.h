/* walkgen_inverse.h: where a yaw-pitch-pitch leg comes closest to a foot target out of its reach; walkgen_math.h explains the macros.
 *
 * Canonical frame: axis 1 is z, the hip (axis 2) crosses the leg plane at (a1, 0). In that plane the foot is at
 *     rho = a1 + a2 cos(phi) + l3 cos(phi + gamma),    h = a2 sin(phi) + l3 sin(phi + gamma)
 * and in space at x = rho cos(t) + w sin(t), y = rho sin(t) - w cos(t), z = h. A sheet is one sign of rho.
 *
 * The distance to a target depends on (rho, h) alone, once t turns the foot to the target's azimuth:
 *     distance^2 = (hypot(rho, w) - radius)^2 + (h - height)^2,   radius = hypot(x, y), height = z
 * Everything below mirrors rho to rho >= 0 (so the hip is at `centre` = a1 or -a1) and h to height >= 0.
 * On a circle of radius r about the hip, u = cos(angle), the derivative to u has the sign of -K,
 *     K(u) = radius rho / hypot(rho, w) - centre - height u / sqrt(1 - u^2),    rho = centre + r u >= 0
 * and K' = 0 is a quadratic in u (raise both terms to the power 2/3): between its roots K rises, outside it falls.
 * Hence at most two minima, each bracketed by known angles, and the bounded Newton below cannot miss the least one.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_INVERSE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_INVERSE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_INVERSE_F64
#define WG_LIBM(name) name
#define WG_HALF_TURN WG_PI /* the greatest number below pi: its sine is positive */
#else
#define WALKGEN_INVERSE_F32
#define WG_LIBM(name) name##f
#define WG_HALF_TURN 3.1415925f
#endif

#if !defined(WALKGEN_NO_CLOSEST)
/* One sheet and one target, mirrored and scaled to a leg of size about 1. */
struct WG_NAME(wg_sheet) {
    WG_REAL centre, outer, inner; /* the hip's rho; radii of the stretched and the folded leg about it */
    WG_REAL w;                    /* offset of the leg plane from axis 1, not negative */
    WG_REAL radius, height;       /* the target's distance from axis 1 and height, not negative */
};

/* A foot in the leg plane, and where it lies seen from the hip. */
struct WG_NAME(wg_sheet_point) {
    WG_REAL rho, height;
    WG_REAL extent, cosine, sine; /* distance from the hip and its direction */
};

#endif

/* Whether one of the statuses is UNREACHABLE: 1 or 0. */
static inline int32_t WG_NAME(wg_any_unreachable)(const int32_t *status, int32_t count) {
    int32_t i;
    for (i = 0; i < count; ++i) {
        if (status[i] == WALKGEN_UNREACHABLE) {
            return 1;
        }
    }
    return 0;
}

/* How many of the statuses are OK. */
static inline int32_t WG_NAME(wg_count_ok)(const int32_t *status, int32_t count) {
    int32_t i, ok = 0;
    for (i = 0; i < count; ++i) {
        ok += status[i] == WALKGEN_OK;
    }
    return ok;
}

/* The angle less full turns, in (-pi, pi]. */
static inline WG_REAL WG_NAME(wg_wrap_angle)(WG_REAL angle) {
    const WG_REAL wrapped = angle - WG_C(2.0) * WG_PI * WG_LIBM(ceil)(angle / (WG_C(2.0) * WG_PI) - WG_C(0.5));
    if (wrapped > WG_PI) { /* by a rounding */
        return wrapped - WG_C(2.0) * WG_PI;
    }
    return wrapped <= -WG_PI ? WG_PI : wrapped;
}

#if !defined(WALKGEN_NO_CLOSEST)
/* The binary exponent of the largest magnitude among three numbers. */
static inline int WG_NAME(wg_exponent_3)(WG_REAL x, WG_REAL y, WG_REAL z) {
    int exponent = 0;
    (void)WG_LIBM(frexp)(WG_MAX(WG_ABS(x), WG_MAX(WG_ABS(y), WG_ABS(z))), &exponent);
    return exponent;
}

/* Half the derivative of distance^2 to the angle on the circle of radius r, over r; and its own derivative. */
static inline WG_REAL WG_NAME(wg_sheet_slope)(const struct WG_NAME(wg_sheet) *sheet, WG_REAL r, WG_REAL angle, WG_REAL *derivative) {
    const WG_REAL cosine = WG_COS(angle), sine = WG_SIN(angle);
    const WG_REAL rho = WG_MAX(sheet->centre + r * cosine, WG_C(0.0));
    const WG_REAL arm = WG_HYPOT(rho, sheet->w);
    const WG_REAL share = arm > WG_C(0.0) ? sheet->w / arm : WG_C(0.0);
    const WG_REAL bend = arm > WG_C(0.0) ? sheet->radius * share * share / arm : WG_C(0.0);
    const WG_REAL pull = sheet->radius * (arm > WG_C(0.0) ? rho / arm : WG_C(1.0)) - sheet->centre;
    *derivative = pull * cosine + sheet->height * sine - bend * r * sine * sine;
    return pull * sine - sheet->height * cosine;
}

/* The angle in [low, high] where the distance is least; K changes its sign there at most once, from - to +. */
WG_CALLED WG_REAL WG_NAME(wg_sheet_minimum)(const struct WG_NAME(wg_sheet) *sheet, WG_REAL r, WG_REAL low, WG_REAL high) {
    WG_REAL derivative, last = high - low, before = last;
    WG_REAL angle = WG_ATAN2_CALLED(sheet->height, sheet->radius - sheet->centre); /* the answer where w = 0 */
    int i;
    if (WG_NAME(wg_sheet_slope)(sheet, r, high, &derivative) <= WG_C(0.0)) {
        return high;
    }
    if (WG_NAME(wg_sheet_slope)(sheet, r, low, &derivative) >= WG_C(0.0)) {
        return low;
    }
    if (!(angle > low && angle < high)) {
        angle = low + WG_C(0.5) * (high - low);
    }
    for (i = 0; i < 128; ++i) {
        const WG_REAL slope = WG_NAME(wg_sheet_slope)(sheet, r, angle, &derivative);
        const WG_REAL step = slope / derivative;
        WG_REAL next = angle - step;
        if (slope < WG_C(0.0)) {
            low = angle;
        } else {
            high = angle;
        }
        if (!(next > low && next < high && WG_C(2.0) * WG_ABS(step) < before)) {
            next = slope < WG_C(0.0) || slope > WG_C(0.0) ? low + WG_C(0.5) * (high - low) : angle;
        }
        before = last;
        last = WG_ABS(next - angle);
        angle = next;
        if (last <= WG_C(0.5) * WG_EPSILON * angle) {
            break;
        }
    }
    return angle;
}

/* Where K turns: it rises with the angle on [0, turns[0]] and on [turns[1], end], and falls between. */
static inline void WG_NAME(wg_sheet_turns)(const struct WG_NAME(wg_sheet) *sheet, WG_REAL r, WG_REAL end, WG_REAL turns[2]) {
    const WG_REAL centre = sheet->centre, w = sheet->w;
    const WG_REAL root_height = WG_LIBM(cbrt)(sheet->height), root_radius = WG_LIBM(cbrt)(sheet->radius * r), root_w = WG_LIBM(cbrt)(w);
    const WG_REAL a = root_height * root_height, b = root_radius * root_radius * (root_w * root_w) * (root_w * root_w);
    const WG_REAL leading = b + a * r * r;
    const WG_REAL discriminant = b * b + a * b * (r * r - centre * centre - w * w) - (a * r * w) * (a * r * w);
    turns[0] = end;
    turns[1] = end;
    if (discriminant > WG_C(0.0) && leading > WG_C(0.0)) {
        const WG_REAL middle = -a * centre * r / leading, half = WG_SQRT(discriminant) / leading;
        const WG_REAL right = WG_MAX(WG_MIN(middle + half, WG_C(1.0)), WG_C(-1.0));
        const WG_REAL left = WG_MAX(WG_MIN(middle - half, WG_C(1.0)), WG_C(-1.0));
        turns[0] = WG_MIN(WG_LIBM(acos)(right), end);
        turns[1] = WG_MIN(WG_LIBM(acos)(left), end);
    }
}

/* Whether point a is closer to the target than point b: a difference of squares, exact for near and for far targets. */
static inline int WG_NAME(wg_sheet_closer)(
    const struct WG_NAME(wg_sheet) *sheet, const struct WG_NAME(wg_sheet_point) *a, const struct WG_NAME(wg_sheet_point) *b) {
    const WG_REAL arm_a = WG_HYPOT(a->rho, sheet->w), arm_b = WG_HYPOT(b->rho, sheet->w);
    const WG_REAL across = (arm_a - arm_b) * ((arm_a - sheet->radius) + (arm_b - sheet->radius));
    const WG_REAL along = (a->height - b->height) * ((a->height - sheet->height) + (b->height - sheet->height));
    return across + along < WG_C(0.0);
}

/* Replaces `best` by the closest point of the circle of radius r, if the sheet holds one that is closer. */
static inline void WG_NAME(wg_sheet_circle)(
    const struct WG_NAME(wg_sheet) *sheet, WG_REAL r, int *found, struct WG_NAME(wg_sheet_point) *best) {
    WG_REAL end = WG_HALF_TURN, turns[2], angles[2];
    int i;
    if (sheet->centre < -r) {
        return;
    }
    if (sheet->centre < r) {
        end = WG_MIN(WG_LIBM(acos)(-sheet->centre / r), WG_HALF_TURN);
    }
    WG_NAME(wg_sheet_turns)(sheet, r, end, turns);
    angles[0] = WG_NAME(wg_sheet_minimum)(sheet, r, WG_C(0.0), turns[0]);
    angles[1] = WG_NAME(wg_sheet_minimum)(sheet, r, turns[1], end);
    for (i = 0; i < 2; ++i) {
        struct WG_NAME(wg_sheet_point) point;
        const int shoulder = sheet->centre < r && angles[i] >= end;
        point.extent = r;
        point.cosine = WG_COS(angles[i]);
        point.sine = WG_SIN(angles[i]);
        point.rho = shoulder ? WG_C(0.0) : WG_MAX(sheet->centre + r * point.cosine, WG_C(0.0));
        point.height = r * point.sine;
        if (!*found || WG_NAME(wg_sheet_closer)(sheet, &point, best)) {
            *best = point;
        }
        *found = 1;
    }
}

/* The point of the sheet closest to the target: the target itself, straight below it on the shoulder, or on a circle. */
static inline struct WG_NAME(wg_sheet_point) WG_NAME(wg_sheet_closest)(const struct WG_NAME(wg_sheet) *sheet) {
    struct WG_NAME(wg_sheet_point) point;
    const WG_REAL beyond = (sheet->radius - sheet->w) * (sheet->radius + sheet->w);
    int found = 0;
    point.rho = WG_SQRT(WG_MAX(beyond, WG_C(0.0)));
    point.height = sheet->height;
    point.extent = WG_HYPOT(point.rho - sheet->centre, sheet->height);
    point.cosine = point.rho - sheet->centre;
    point.sine = sheet->height;
    if (point.extent < sheet->inner || point.extent > sheet->outer) {
        WG_NAME(wg_sheet_circle)(sheet, sheet->outer, &found, &point);
        WG_NAME(wg_sheet_circle)(sheet, sheet->inner, &found, &point);
    }
    return point;
}

/* The leg and target scaled by powers of 2: the leg to size about 1, a very far target to 2^60 (its direction is what counts). */
static inline void WG_NAME(wg_sheet_scale)(const WG_REAL *geometry, const WG_REAL *target, WG_REAL scaled[4], WG_REAL foot[3]) {
    const int size = WG_NAME(wg_exponent_3)(geometry[0], WG_MAX(WG_ABS(geometry[1]), WG_ABS(geometry[2])), geometry[3]);
    const int excess = WG_NAME(wg_exponent_3)(target[0], target[1], target[2]) - size - 60;
    int i;
    for (i = 0; i < 4; ++i) {
        scaled[i] = WG_LIBM(ldexp)(geometry[i], -size);
    }
    for (i = 0; i < 3; ++i) {
        foot[i] = WG_LIBM(ldexp)(target[i], -size - (excess > 0 ? excess : 0));
    }
}

/* Joint values of the closest foot on the sheet of sign `sigma` (the other sheet where this one is empty), for both knee signs. */
static inline void WG_NAME(wg_sheet_joints)(const WG_REAL *geometry, const WG_REAL *target, WG_REAL sigma, WG_REAL joints[6]) {
    struct WG_NAME(wg_sheet) sheet;
    struct WG_NAME(wg_sheet_point) point;
    WG_REAL leg[4], foot[3], yaw, knee, thigh, inside;
    int i, free_yaw;
    WG_NAME(wg_sheet_scale)(geometry, target, leg, foot);
    sheet.outer = leg[1] + leg[2];
    sheet.inner = WG_ABS(leg[1] - leg[2]);
    sigma = sigma * leg[0] + sheet.outer < WG_C(0.0) ? -sigma : sigma;
    sheet.centre = sigma * leg[0];
    sheet.w = WG_ABS(leg[3]) < WG_EPSILON ? WG_C(0.0) : WG_ABS(leg[3]); /* less could not be told from the shoulder's rounding */
    sheet.radius = WG_HYPOT(foot[0], foot[1]);
    sheet.height = WG_ABS(foot[2]);
    point = WG_NAME(wg_sheet_closest)(&sheet);
    yaw = WG_ATAN2_CALLED(target[1], target[0]) - WG_ATAN2_CALLED(-leg[3], sigma * point.rho);
    free_yaw = !(WG_ABS(target[0]) + WG_ABS(target[1]) > WG_C(0.0)) || !(point.rho + sheet.w > WG_C(0.0));
    knee = WG_C(2.0) * WG_ATAN2_CALLED(WG_SQRT(WG_MAX((sheet.outer - point.extent) * (sheet.outer + point.extent), WG_C(0.0))),
                                WG_SQRT(WG_MAX((point.extent - sheet.inner) * (point.extent + sheet.inner), WG_C(0.0))));
    thigh = WG_ATAN2_CALLED(target[2] < WG_C(0.0) ? -point.sine : point.sine, sigma * point.cosine);
    inside = WG_ATAN2_CALLED(leg[2] * WG_SIN(knee), leg[1] + leg[2] * WG_COS(knee));
    for (i = 0; i < 2; ++i, knee = -knee, inside = -inside) {
        joints[3 * i] = free_yaw ? WG_C(0.0) : WG_NAME(wg_wrap_angle)(geometry[4] * (yaw - geometry[5]));
        joints[3 * i + 1] = point.extent > WG_C(0.0) ? WG_NAME(wg_wrap_angle)(geometry[6] * (thigh - inside - geometry[7])) : WG_C(0.0);
        joints[3 * i + 2] = WG_NAME(wg_wrap_angle)(geometry[8] * (knee - geometry[9]));
    }
}

/* Rows of q (one for each branch: (rho, knee) = (+,+), (+,-), (-,+), (-,-)) whose status is UNREACHABLE become the joint values that
 * bring the foot closest to the target on their sheet. geometry: a1, a2 > 0, l3 > 0, w (lengths), then sign and zero of the three joints:
 * joint value = sign (angle - zero), in (-pi, pi]. target: canonical, finite. Statuses stay. A free joint is 0. */
WG_CALLED void WG_NAME(wg_closest_yaw_pitch_pitch)(
    const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT target, WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    int row, i;
    for (row = 0; row < 4; row += 2) {
        WG_REAL joints[6];
        if (status[row] != WALKGEN_UNREACHABLE && status[row + 1] != WALKGEN_UNREACHABLE) {
            continue;
        }
        WG_NAME(wg_sheet_joints)(geometry, target, row == 0 ? WG_C(1.0) : WG_C(-1.0), joints);
        for (i = 0; i < 6; ++i) {
            if (status[row + i / 3] == WALKGEN_UNREACHABLE) {
                q[3 * row + i] = joints[i];
            }
        }
    }
}

/* The same for one branch, 0 to 3; any other branch leaves q alone. */
WG_CALLED void WG_NAME(wg_closest_yaw_pitch_pitch_branch)(const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT target,
                                                          int32_t branch, WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    WG_REAL joints[6];
    int i;
    if (*status != WALKGEN_UNREACHABLE || branch < 0 || branch > 3) {
        return;
    }
    WG_NAME(wg_sheet_joints)(geometry, target, branch < 2 ? WG_C(1.0) : WG_C(-1.0), joints);
    for (i = 0; i < 3; ++i) {
        q[i] = joints[3 * (branch % 2) + i];
    }
}

#else
/* NaN in rows, or the row, whose status is UNREACHABLE. */
static inline void WG_NAME(wg_closest_yaw_pitch_pitch)(
    const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT target, WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    int i;
    (void)geometry, (void)target;
    for (i = 0; i < 12; ++i) {
        if (status[i / 3] == WALKGEN_UNREACHABLE) {
            q[i] = WG_NAN;
        }
    }
}

static inline void WG_NAME(wg_closest_yaw_pitch_pitch_branch)(const WG_REAL *WG_RESTRICT geometry, const WG_REAL *WG_RESTRICT target,
                                                              int32_t branch, WG_REAL *WG_RESTRICT q, int32_t *WG_RESTRICT status) {
    (void)geometry, (void)target, (void)branch;
    if (*status == WALKGEN_UNREACHABLE) {
        q[0] = q[1] = q[2] = WG_NAN;
    }
}
#endif

#undef WG_HALF_TURN
#undef WG_LIBM
#endif
