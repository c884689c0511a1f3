/* dynamics_by_hand.c: the dynamics of the leg of specs/mero_leg.toml as a person writes them who has the equations simplified:
 * a yaw that carries a double pendulum, with seven numbers of inertia.
 */
#define _GNU_SOURCE
#include <math.h>

#define THIGH 0.35
#define SHANK 0.40
#define YAW 0.0035            /* kg m^2: what turns with the yaw at any pose */
#define THIGH_SWUNG 0.113125  /* across the thigh less along it, the shank's mass at its end */
#define SHANK_SWUNG 0.0315
#define COUPLED 0.042
#define THIGH_PITCHED 0.114125
#define SHANK_PITCHED 0.032
#define THIGH_WEIGHT 3.77556025 /* N m */
#define SHANK_WEIGHT 1.176798

/* Efforts without acceleration, of yaw, thigh and shank (absolute angles); COUPLED times the cosine of the knee; inertia about the yaw. */
struct loads {
    double yaw, thigh, shank, coupling, yawed;
};

static inline struct loads loads_of(const double *q, const double *qd, const double *f) {
    double cy, sy, ct, st, cs, ss;
    sincos(q[0], &sy, &cy);
    sincos(q[1], &st, &ct);
    sincos(q[1] + q[2], &ss, &cs);
    const double wide = THIGH_SWUNG * ct + COUPLED * cs, narrow = SHANK_SWUNG * cs + COUPLED * ct;
    const double thigh_lever = st * wide, shank_lever = ss * narrow;
    const double twist = COUPLED * (st * cs - ct * ss), yaw = qd[0] * qd[0], turn = qd[1] + qd[2];
    const double radial = cy * f[0] + sy * f[1], across = cy * f[1] - sy * f[0];
    struct loads found;
    found.yaw = -2.0 * qd[0] * (qd[1] * thigh_lever + turn * shank_lever) - (THIGH * ct + SHANK * cs) * across;
    found.thigh = twist * (turn * turn) + yaw * thigh_lever + ct * (THIGH_WEIGHT - THIGH * f[2]) + THIGH * st * radial;
    found.shank = yaw * shank_lever - twist * (qd[1] * qd[1]) + cs * (SHANK_WEIGHT - SHANK * f[2]) + SHANK * ss * radial;
    found.coupling = COUPLED * (ct * cs + st * ss);
    found.yawed = YAW + ct * wide + cs * narrow;
    return found;
}

static inline void core_leg_inverse_dynamics(const double *q, const double *qd, const double *qdd, const double *f, double *out) {
    const struct loads held = loads_of(q, qd, f);
    const double turn = qdd[1] + qdd[2];
    const double shank = held.shank + SHANK_PITCHED * turn + held.coupling * qdd[1];
    const double thigh = held.thigh + THIGH_PITCHED * qdd[1] + held.coupling * turn;
    out[0] = held.yaw + held.yawed * qdd[0];
    out[1] = thigh + shank;
    out[2] = shank;
}

static inline void core_leg_mass_matrix(const double *q, double *out) {
    double ct, st, cs, ss;
    sincos(q[1], &st, &ct);
    sincos(q[1] + q[2], &ss, &cs);
    const double mixed = SHANK_PITCHED + COUPLED * (ct * cs + st * ss);
    out[0] = YAW + ct * (THIGH_SWUNG * ct + 2.0 * COUPLED * cs) + SHANK_SWUNG * cs * cs;
    out[4] = (THIGH_PITCHED - SHANK_PITCHED) + 2.0 * mixed;
    out[5] = out[7] = mixed;
    out[8] = SHANK_PITCHED;
    out[1] = out[2] = out[3] = out[6] = 0.0;
}

static inline void core_leg_forward_dynamics(const double *q, const double *qd, const double *tau, const double *f, double *out) {
    const struct loads held = loads_of(q, qd, f);
    const double thigh = tau[1] - tau[2] - held.thigh, shank = tau[2] - held.shank, k = held.coupling;
    const double scale = 1.0 / (THIGH_PITCHED * SHANK_PITCHED - k * k);
    const double swing = scale * (SHANK_PITCHED * thigh - k * shank), turn = scale * (THIGH_PITCHED * shank - k * thigh);
    out[0] = (tau[0] - held.yaw) / held.yawed;
    out[1] = swing;
    out[2] = turn - swing;
}

static inline void core_leg_bias_acceleration(const double *q, const double *qd, double *out) {
    double cy, sy, ct, st, cs, ss;
    sincos(q[0], &sy, &cy);
    sincos(q[1], &st, &ct);
    sincos(q[1] + q[2], &ss, &cs);
    const double turn = qd[1] + qd[2], thigh = THIGH * qd[1], shank = SHANK * turn;
    const double outwards = -(thigh * qd[1] * ct + shank * turn * cs) - (THIGH * ct + SHANK * cs) * (qd[0] * qd[0]);
    const double across = -2.0 * qd[0] * (thigh * st + shank * ss), leaning = qd[0] * turn;
    out[0] = cy * outwards - sy * across;
    out[1] = sy * outwards + cy * across;
    out[2] = -(thigh * qd[1] * st + shank * turn * ss);
    out[3] = leaning * cy;
    out[4] = leaning * sy;
    out[5] = 0.0;
}

static inline void core_leg_inverse_rates(const double *q, const double *v, const double *a, double *out) {
    double cy, sy, ct, st, cs, ss;
    sincos(q[0], &sy, &cy);
    sincos(q[1], &st, &ct);
    sincos(q[1] + q[2], &ss, &cs);
    const double reach = THIGH * ct + SHANK * cs, inverse = 1.0 / reach, scale = 1.0 / (ct * ss - st * cs);
    const double out_v = cy * v[0] + sy * v[1], yaw = (cy * v[1] - sy * v[0]) * inverse;
    const double thigh = scale * (out_v * cs + v[2] * ss) * (1.0 / THIGH), shank = -scale * (out_v * ct + v[2] * st) * (1.0 / SHANK);
    const double pull = THIGH * thigh * thigh, push = SHANK * shank * shank;
    const double out_a = cy * a[0] + sy * a[1] + pull * ct + push * cs + reach * yaw * yaw, up = a[2] + pull * st + push * ss;
    const double swing = scale * (out_a * cs + up * ss) * (1.0 / THIGH), turn = -scale * (out_a * ct + up * st) * (1.0 / SHANK);
    out[0] = yaw;
    out[1] = thigh;
    out[2] = shank - thigh;
    out[3] = (cy * a[1] - sy * a[0] - 2.0 * yaw * out_v) * inverse;
    out[4] = swing;
    out[5] = turn - swing;
}
