/* by_hand.c: the same leg by a careful person with the closed formulas at hand; a yardstick for every generator, walkgen's included.
 *
 *     rho = a2 cos(q2) + a3 cos(q2 + q3), h = a2 sin(q2) + a3 sin(q2 + q3), foot = (rho cos(q1), rho sin(q1), s1 + h)
 *
 * The inverse uses that atan2(-y, -x) is atan2(y, x) turned by pi and that mirrored branches share every call but the wrapping; it
 * gives no status.
 */
#include <math.h>

#define A2 0.35
#define A3 0.40
#define S1 0.12
#define PI 3.141592653589793

static inline double wrap(double angle) {
    return angle > PI ? angle - 2.0 * PI : angle <= -PI ? angle + 2.0 * PI : angle;
}

static inline void core_foot_position(const double *restrict q, double *restrict p) {
    const double knee = q[1] + q[2];
    const double rho = A2 * cos(q[1]) + A3 * cos(knee);
    p[0] = rho * cos(q[0]);
    p[1] = rho * sin(q[0]);
    p[2] = S1 + A2 * sin(q[1]) + A3 * sin(knee);
}

static inline void core_foot_position_jacobian(const double *restrict q, double *restrict p, double *restrict J) {
    const double knee = q[1] + q[2];
    const double c1 = cos(q[0]), s1 = sin(q[0]);
    const double shank_x = A3 * cos(knee), shank_z = A3 * sin(knee);
    const double rho = A2 * cos(q[1]) + shank_x, h = A2 * sin(q[1]) + shank_z;
    p[0] = rho * c1;
    p[1] = rho * s1;
    p[2] = S1 + h;
    J[0] = -p[1];
    J[1] = -h * c1;
    J[2] = -shank_z * c1;
    J[3] = p[0];
    J[4] = -h * s1;
    J[5] = -shank_z * s1;
    J[6] = 0.0;
    J[7] = rho;
    J[8] = shank_x;
}

static inline void core_foot_hessian(const double *restrict q, double *restrict H) {
    const double knee = q[1] + q[2];
    const double c1 = cos(q[0]), s1 = sin(q[0]);
    const double shank_x = A3 * cos(knee), shank_z = A3 * sin(knee);
    const double rho = A2 * cos(q[1]) + shank_x, h = A2 * sin(q[1]) + shank_z;
    const double x = rho * c1, y = rho * s1, hc = h * c1, hs = h * s1;
    const double sxc = shank_x * c1, sxs = shank_x * s1, szc = shank_z * c1, szs = shank_z * s1;
    const double rows[27] = {-x, hs,  szs, hs, -x, -sxc, szs,  -sxc, -sxc, -y,       -hc, -szc,     -hc,     -y,
                             -sxs, -szc, -sxs, -sxs, 0.0, 0.0, 0.0, 0.0, -h, -shank_z, 0.0, -shank_z, -shank_z};
    for (int i = 0; i < 27; ++i) {
        H[i] = rows[i];
    }
}

/* The knee's cosine, held in [-1, 1]. */
static inline double knee_cosine(double square) {
    const double cosine = (square - (A2 * A2 + A3 * A3)) * (1.0 / (2.0 * A2 * A3));
    return cosine > 1.0 ? 1.0 : cosine < -1.0 ? -1.0 : cosine;
}

static inline void core_inverse_branch(const double *restrict p, const double *restrict signs, double *restrict q) {
    const double square = p[0] * p[0] + p[1] * p[1], rho = signs[0] * sqrt(square), z = p[2] - S1;
    const double cosine = knee_cosine(square + z * z), sine = signs[1] * sqrt((1.0 - cosine) * (1.0 + cosine));
    const double along = A2 + A3 * cosine, across = A3 * sine;
    q[0] = atan2(signs[0] * p[1], signs[0] * p[0]);
    q[1] = atan2(z * along - rho * across, rho * along + z * across);
    q[2] = atan2(sine, cosine);
}

static inline void core_inverse(const double *restrict p, double *restrict q) {
    const double square = p[0] * p[0] + p[1] * p[1], rho = sqrt(square), z = p[2] - S1;
    const double cosine = knee_cosine(square + z * z), sine = sqrt((1.0 - cosine) * (1.0 + cosine));
    const double turn = atan2(p[1], p[0]), back = turn > 0.0 ? turn - PI : turn + PI;
    const double up = atan2(z, rho), bend = atan2(A3 * sine, A2 + A3 * cosine), knee = atan2(sine, cosine);
    q[0] = q[3] = turn;
    q[6] = q[9] = back;
    q[1] = wrap(up - bend);
    q[4] = wrap(up + bend);
    q[7] = wrap(PI - up - bend);
    q[10] = wrap(PI - up + bend);
    q[2] = q[8] = knee;
    q[5] = q[11] = -knee;
}

#include "adapter.h"
