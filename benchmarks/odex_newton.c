/* odex_newton.c: the leg of specs/odex.toml as loop equations, by hand: poses of all links unknown, Newton steps with the analytic Jacobian. */
#define _GNU_SOURCE
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { FRAME = -1, THIGH, SHANK, COUPLER, ROCKER, BELL, LINK, LINKS, UNKNOWNS = 3 * LINKS, PINS = 8, MOST_STEPS = 12 };

typedef struct {
    int link;
    double x, y;
} End;

static const double TOLERANCE = 1e-12; /* m */
static const double MOUNT = 0.4;
static const End FOOT = {SHANK, 0.60, 0.0};
static const End PIN[PINS][2] = {
    {{FRAME, 0.0, 0.0}, {THIGH, 0.0, 0.0}},   {{FRAME, 0.0, 0.0}, {ROCKER, 0.0, 0.0}},     {{THIGH, 0.45, 0.0}, {SHANK, 0.0, 0.0}},
    {{SHANK, -0.12, 0.0}, {COUPLER, 0.45, 0.0}}, {{ROCKER, 0.12, 0.0}, {COUPLER, 0.0, 0.0}}, {{FRAME, -0.02, -0.22}, {BELL, 0.0, 0.0}},
    {{BELL, 0.11, 0.0}, {LINK, 0.0, 0.0}},    {{LINK, 0.22, 0.0}, {ROCKER, 0.0, 0.10}},
};
static const End CYLINDER[2][2] = {{{FRAME, 0.05, -0.20}, {THIGH, 0.20, 0.0}}, {{FRAME, 0.28, -0.34}, {BELL, 0.0, 0.12}}};

typedef struct {
    double at[2], slope[2]; /* the point, and its slope by its link's angle */
} Point;

static Point placed(End end, const double *pose, const double *cosine, const double *sine) {
    if (end.link == FRAME)
        return (Point){{end.x, end.y}, {0.0, 0.0}};
    const double x = cosine[end.link] * end.x - sine[end.link] * end.y, y = sine[end.link] * end.x + cosine[end.link] * end.y;
    return (Point){{pose[3 * end.link] + x, pose[3 * end.link + 1] + y}, {-y, x}};
}

/* Adds factor * d(point . direction) / d(poses) to a row. */
static void slope(double *row, End end, const Point *point, double along_x, double along_y) {
    if (end.link == FRAME)
        return;
    row[3 * end.link] += along_x;
    row[3 * end.link + 1] += along_y;
    row[3 * end.link + 2] += along_x * point->slope[0] + along_y * point->slope[1];
}

/* Solves A x = b in place of b, rows exchanged; 0 where A is singular. */
static int solve(double A[UNKNOWNS][UNKNOWNS], double *b) {
    for (int k = 0; k < UNKNOWNS; ++k) {
        int pivot = k;
        for (int i = k + 1; i < UNKNOWNS; ++i)
            if (fabs(A[i][k]) > fabs(A[pivot][k]))
                pivot = i;
        if (A[pivot][k] == 0.0)
            return 0;
        if (pivot != k) {
            for (int j = k; j < UNKNOWNS; ++j) {
                const double kept = A[k][j];
                A[k][j] = A[pivot][j];
                A[pivot][j] = kept;
            }
            const double kept = b[k];
            b[k] = b[pivot];
            b[pivot] = kept;
        }
        for (int i = k + 1; i < UNKNOWNS; ++i) {
            const double factor = A[i][k] / A[k][k];
            if (factor == 0.0) /* most are: the equations join two links each */
                continue;
            for (int j = k + 1; j < UNKNOWNS; ++j)
                A[i][j] -= factor * A[k][j];
            b[i] -= factor * b[k];
        }
    }
    for (int k = UNKNOWNS - 1; k >= 0; --k) {
        for (int j = k + 1; j < UNKNOWNS; ++j)
            b[k] -= A[k][j] * b[j];
        b[k] /= A[k][k];
    }
    return 1;
}

/* Residuals and Jacobian; the last two equations put the foot on a target or give the cylinders their lengths. */
static double equations(const double *pose, int by_foot, const double *given, double A[UNKNOWNS][UNKNOWNS], double *b) {
    double cosine[LINKS], sine[LINKS], worst = 0.0;
    memset(A, 0, sizeof(double[UNKNOWNS][UNKNOWNS]));
    for (int link = 0; link < LINKS; ++link)
        sincos(pose[3 * link + 2], &sine[link], &cosine[link]);
    for (int pin = 0; pin < PINS; ++pin) {
        const Point first = placed(PIN[pin][0], pose, cosine, sine), second = placed(PIN[pin][1], pose, cosine, sine);
        for (int axis = 0; axis < 2; ++axis) {
            b[2 * pin + axis] = second.at[axis] - first.at[axis];
            slope(A[2 * pin + axis], PIN[pin][0], &first, axis == 0, axis == 1);
            slope(A[2 * pin + axis], PIN[pin][1], &second, -(axis == 0), -(axis == 1));
        }
    }
    for (int last = 0; last < 2; ++last) {
        double *row = A[2 * PINS + last];
        if (by_foot) {
            const Point foot = placed(FOOT, pose, cosine, sine);
            b[2 * PINS + last] = given[last] - foot.at[last];
            slope(row, FOOT, &foot, last == 0, last == 1);
        } else {
            const Point base = placed(CYLINDER[last][0], pose, cosine, sine), end = placed(CYLINDER[last][1], pose, cosine, sine);
            const double x = end.at[0] - base.at[0], y = end.at[1] - base.at[1], length = sqrt(x * x + y * y);
            b[2 * PINS + last] = given[last] - length;
            slope(row, CYLINDER[last][1], &end, x / length, y / length);
        }
    }
    for (int i = 0; i < UNKNOWNS; ++i)
        worst = fmax(worst, fabs(b[i]));
    return worst;
}

/* Newton steps from the pose given; how many, or -1. */
static int32_t closed(double *pose, int by_foot, const double *given) {
    double A[UNKNOWNS][UNKNOWNS], b[UNKNOWNS];
    for (int32_t step = 0; step < MOST_STEPS; ++step) {
        if (equations(pose, by_foot, given, A, b) < TOLERANCE)
            return step;
        if (!solve(A, b))
            return -1;
        for (int i = 0; i < UNKNOWNS; ++i)
            pose[i] += b[i];
    }
    return -1;
}

static double length_of(int cylinder, const double *pose) {
    double cosine[LINKS], sine[LINKS];
    const int link = CYLINDER[cylinder][1].link;
    sincos(pose[3 * link + 2], &sine[link], &cosine[link]);
    const Point end = placed(CYLINDER[cylinder][1], pose, cosine, sine);
    return hypot(end.at[0] - CYLINDER[cylinder][0].x, end.at[1] - CYLINDER[cylinder][0].y);
}

/* in: foot [3], a pose of the links near the answer [18]; out: drives [3], foot again [3]; the Newton steps, -1 where they fail. */
__attribute__((visibility("default"))) int32_t bench_newton(const double *in, int32_t branch, double *out, int32_t *status);
int32_t bench_newton(const double *in, int32_t branch, double *out, int32_t *status) {
    double pose[UNKNOWNS];
    const double target[2] = {hypot(in[0] - MOUNT, in[1]), in[2]};
    memcpy(pose, in + 3, sizeof pose);
    const int32_t back = closed(pose, 1, target);
    out[0] = atan2(in[1], in[0] - MOUNT);
    out[1] = length_of(0, pose);
    out[2] = length_of(1, pose);
    *status = back;
    if (branch < 0) /* the drives are all that is asked for */
        return back;
    memcpy(pose, in + 3, sizeof pose);
    const int32_t forth = closed(pose, 0, out + 1);
    double sine, cosine;
    sincos(pose[3 * SHANK + 2], &sine, &cosine);
    const double reach = pose[3 * SHANK] + FOOT.x * cosine;
    out[5] = pose[3 * SHANK + 1] + FOOT.x * sine;
    sincos(out[0], &sine, &cosine);
    out[3] = MOUNT + reach * cosine;
    out[4] = reach * sine;
    *status = back < 0 || forth < 0 ? -1 : back + forth;
    return *status;
}
