/* walkgen_serial.h: a chain of up to 16 joints given by their axes: its foot, its Jacobian and how far it is from a target.
 *
 * Or by a function, see walkgen_driven_foot.h: then a foot that is nowhere is infinitely far from its target.
 * Lengths are scaled to about 1 by a power of 2 and seen from the first joint's point. Of a pose, the error is the foot's distance and the
 * rotation vector to the target, times `length`; walkgen_math.h explains the macros.
 */
#include "walkgen_driven_foot.h"
#include "walkgen_spatial.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SERIAL_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SERIAL_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SERIAL_F64
#define WG_LIBM(name) name
#define WG_TOLERANCE WG_C(1e-12)
#define WG_RIGID WG_C(1e-6)
#define WG_ZOOM 20
#else
#define WALKGEN_SERIAL_F32
#define WG_LIBM(name) name##f
#define WG_TOLERANCE (WG_C(8.0) * WG_EPSILON)
#define WG_RIGID WG_C(1e-5)
#define WG_ZOOM 4
#endif
struct WG_NAME(wg_box);
struct WG_NAME(wg_arm_state);

/* Joints at q = 0, base to foot; `lever` leads from a joint's point to the next one's, the last to the foot. The target, which a product of
 * the joints' screws maps the foot and its axes to: `rows` is 3 for a position, 6 for a pose. Slopes are known to `rough` roundings. With a
 * `motion` there are no axes, but `edges` where loops cease to close, `along_edges` of which leads to rest. */
struct WG_NAME(wg_serial) {
    int n, rows, size, slides[WG_MOST_JOINTS];
    WG_REAL axis[WG_MOST_JOINTS][3], point[WG_MOST_JOINTS][3], lever[WG_MOST_JOINTS][3], foot[3];
    WG_REAL target[3], rotation[9], length, reach, tolerance;
    WG_NAME(wg_driven_foot) motion;
    const void *data;
    int edges;
    WG_REAL rough;
    int (*along_edges)(const struct WG_NAME(wg_serial) *, const struct WG_NAME(wg_box) *, struct WG_NAME(wg_arm_state) *);
};

/* Joint values and what follows: columns of the Jacobian (rotations times `length`), directions of the axes that turn, the error. `edge` is
 * 1 or -1 where the foot is known to end above or below a joint's value. */
struct WG_NAME(wg_arm_state) {
    WG_REAL q[WG_MOST_JOINTS], column[WG_MOST_JOINTS][6], turning[WG_MOST_JOINTS][3], error[6], gap;
    int edge[WG_MOST_JOINTS];
};

/* C = A B, or A B transposed; row-major. */
static inline void WG_NAME(wg_product_3)(const WG_REAL A[9], const WG_REAL B[9], int transposed, WG_REAL C[9]) {
    int i, j, k;
    for (i = 0; i < 3; ++i) {
        for (j = 0; j < 3; ++j) {
            WG_REAL sum = WG_C(0.0);
            for (k = 0; k < 3; ++k) {
                sum += A[3 * i + k] * (transposed ? B[3 * j + k] : B[3 * k + j]);
            }
            C[3 * i + j] = sum;
        }
    }
}

/* R times the rotation about a unit axis: its rows turned back. */
static inline void WG_NAME(wg_turned_rows)(const WG_REAL axis[3], WG_REAL cosine, WG_REAL sine, const WG_REAL moved[3], WG_REAL R[9]) {
    int i;
    for (i = 0; i < 3; ++i) {
        WG_REAL *row = R + 3 * i;
        const WG_REAL along = (WG_C(1.0) - cosine) * moved[i], x = row[0], y = row[1], z = row[2];
        row[0] = cosine * x + sine * (y * axis[2] - z * axis[1]) + along * axis[0];
        row[1] = cosine * y + sine * (z * axis[0] - x * axis[2]) + along * axis[1];
        row[2] = cosine * z + sine * (x * axis[1] - y * axis[0]) + along * axis[2];
    }
}

/* The rotation vector of a rotation matrix, at most pi long. */
static inline void WG_NAME(wg_rotation_vector)(const WG_REAL M[9], WG_REAL vector[3]) {
    const WG_REAL cosine = WG_C(0.5) * (M[0] + M[4] + M[8] - WG_C(1.0));
    WG_REAL sine, angle, length, column[3];
    int i, k = 0;
    vector[0] = WG_C(0.5) * (M[7] - M[5]);
    vector[1] = WG_C(0.5) * (M[2] - M[6]);
    vector[2] = WG_C(0.5) * (M[3] - M[1]);
    sine = WG_NAME(wg_norm)(vector);
    angle = WG_ATAN2(sine, cosine);
    if (cosine > WG_C(-0.9)) {
        for (i = 0; i < 3; ++i) {
            vector[i] *= sine > WG_TINY ? angle / sine : WG_C(1.0);
        }
        return;
    }
    for (i = 1; i < 3; ++i) { /* nearly half a turn: the axis from M + M', which is about 2 axis axis' - 2 */
        k = M[4 * i] > M[4 * k] ? i : k;
    }
    for (i = 0; i < 3; ++i) {
        column[i] = WG_C(0.5) * (M[3 * i + k] + M[3 * k + i]) - (i == k ? cosine : WG_C(0.0));
    }
    length = WG_NAME(wg_norm)(column);
    angle = WG_NAME(wg_dot)(column, vector) < WG_C(0.0) ? -angle : angle;
    for (i = 0; i < 3; ++i) {
        vector[i] = column[i] * (angle / length);
    }
}

/* What the foot, and the chain's turn R, lack. */
static inline void WG_NAME(wg_serial_error)(const struct WG_NAME(wg_serial) * arm, const WG_REAL foot[3], const WG_REAL R[9],
                                            struct WG_NAME(wg_arm_state) * at) {
    WG_REAL square = WG_C(0.0), M[9];
    int i;
    WG_NAME(wg_add)(foot, WG_C(-1.0), arm->target, at->error);
    if (arm->rows == 6) {
        WG_NAME(wg_product_3)(R, arm->rotation, 1, M);
        WG_NAME(wg_rotation_vector)(M, at->error + 3);
    }
    for (i = 0; i < arm->rows; ++i) {
        at->error[i] *= i < 3 ? WG_C(1.0) : arm->length;
        square += at->error[i] * at->error[i];
    }
    at->gap = WG_SQRT(square);
}

/* Everything at the stance's q, by the arm's function. */
static inline void WG_NAME(wg_driven_state)(const struct WG_NAME(wg_serial) * arm, struct WG_NAME(wg_arm_state) * at) {
    WG_REAL motion[WG_MOST_MOTION];
    const int there = WG_NAME(wg_driven_foot_at)(arm->motion, arm->data, arm->edges, arm->n, arm->slides, arm->size, at->q,
                                                  motion);
    int i, j;
    for (i = 0; i < 3; ++i) {
        at->error[i] = there ? motion[i] - arm->target[i] : WG_INFINITY;
        for (j = 0; j < arm->n; ++j) {
            at->column[j][i] = there ? motion[3 + arm->edges + arm->n * i + j] : WG_C(0.0);
            at->column[j][3 + i] = at->turning[j][i] = WG_C(0.0);
        }
    }
    at->gap = WG_NAME(wg_norm)(at->error);
}

/* Everything at the stance's q. */
static inline void WG_NAME(wg_serial_at)(const struct WG_NAME(wg_serial) * arm, struct WG_NAME(wg_arm_state) * at) {
    WG_REAL R[9] = {WG_C(1.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(1.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(1.0)};
    WG_REAL origin[WG_MOST_JOINTS][3], x[3], arm_of[3];
    int i, j;
    for (j = 0; j < arm->n; ++j) {
        at->edge[j] = 0;
    }
    if (arm->motion) {
        WG_NAME(wg_driven_state)(arm, at);
        return;
    }
    WG_NAME(wg_add)(arm->point[0], WG_C(0.0), arm->point[0], x);
    for (j = 0; j < arm->n; ++j) {
        WG_REAL *direction = at->turning[j];
        for (i = 0; i < 3; ++i) {
            direction[i] = WG_NAME(wg_dot)(R + 3 * i, arm->axis[j]);
            origin[j][i] = x[i];
        }
        if (arm->slides[j]) {
            WG_NAME(wg_add)(x, at->q[j], direction, x);
        } else {
            WG_NAME(wg_turned_rows)(arm->axis[j], WG_COS(at->q[j]), WG_SIN(at->q[j]), direction, R);
        }
        for (i = 0; i < 3; ++i) {
            x[i] += WG_NAME(wg_dot)(R + 3 * i, arm->lever[j]);
        }
    }
    for (j = 0; j < arm->n; ++j) {
        WG_NAME(wg_add)(x, WG_C(-1.0), origin[j], arm_of);
        WG_NAME(wg_cross)(at->turning[j], arm_of, at->column[j]);
        for (i = 0; i < 3; ++i) {
            at->column[j][i] = arm->slides[j] ? at->turning[j][i] : at->column[j][i];
            at->turning[j][i] = arm->slides[j] ? WG_C(0.0) : at->turning[j][i];
            at->column[j][3 + i] = arm->length * at->turning[j][i];
        }
    }
    WG_NAME(wg_serial_error)(arm, x, R, at);
}

/* Whether the foot, and its rotation, are where they are wanted but for roundings. */
static inline int WG_NAME(wg_serial_reaches)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_arm_state) * at) {
    return WG_NAME(wg_norm)(at->error) <= arm->tolerance &&
           (arm->rows == 3 || WG_NAME(wg_norm)(at->error + 3) <= WG_TOLERANCE * arm->length);
}

/* Points next to each other, the levers between them, and the reach. */
static inline void WG_NAME(wg_serial_levers)(struct WG_NAME(wg_serial) * arm) {
    const WG_REAL *beyond = arm->foot;
    int j;
    arm->reach = WG_C(0.0);
    for (j = arm->n - 1; j >= 0; --j) {
        WG_REAL *lever = arm->lever[j];
        WG_NAME(wg_add)(beyond, WG_C(-1.0), arm->point[j], lever);
        if (arm->slides[j]) {
            WG_NAME(wg_add)(beyond, WG_C(0.0), beyond, arm->point[j]);
        } else {
            WG_NAME(wg_add)(arm->point[j], WG_NAME(wg_dot)(arm->axis[j], lever), arm->axis[j], arm->point[j]);
        }
        WG_NAME(wg_add)(beyond, WG_C(-1.0), arm->point[j], lever);
        arm->reach += WG_NAME(wg_norm)(lever);
        beyond = arm->point[j];
    }
}

/* Lengths by a power of 2 to about 1. A target very far from an arm that does not slide comes nearer: only its direction counts.
 * arm->tolerance is how far from the origin the arm stands, and becomes what roundings leave open; an arm that is one is not enlarged. */
static inline void WG_NAME(wg_serial_scale)(struct WG_NAME(wg_serial) * arm) {
    WG_REAL largest = WG_LIBM(ldexp)(arm->tolerance, -WG_ZOOM), farthest = WG_C(0.0);
    int i, j, far, sliding = 0;
    for (i = 0; i < 3; ++i) {
        farthest = WG_MAX(farthest, WG_ABS(arm->target[i]));
        largest = WG_MAX(largest, WG_ABS(arm->foot[i]));
        for (j = 0; j < arm->n; ++j) {
            largest = WG_MAX(largest, WG_ABS(arm->point[j][i]));
            sliding |= arm->slides[j];
        }
    }
    (void)WG_LIBM(frexp)(sliding ? WG_MAX(largest, farthest) : largest, &arm->size);
    (void)WG_LIBM(frexp)(farthest, &far);
    far = far - arm->size > 20 ? far - 20 : arm->size;
    for (i = 0; i < 3; ++i) {
        arm->target[i] = WG_LIBM(ldexp)(arm->target[i], -far);
        arm->foot[i] = WG_LIBM(ldexp)(arm->foot[i], -arm->size);
        for (j = 0; j < arm->n; ++j) {
            arm->point[j][i] = WG_LIBM(ldexp)(arm->point[j][i], -arm->size);
        }
    }
    WG_NAME(wg_serial_levers)(arm);
    arm->reach += sliding ? WG_NAME(wg_norm)(arm->target) : WG_C(0.0);
    arm->tolerance = WG_TOLERANCE * arm->reach + WG_C(4.0) * WG_EPSILON * WG_LIBM(ldexp)(arm->tolerance, -far);
    arm->length = WG_C(0.25) * WG_MAX(arm->reach, WG_C(0.01));
}

/* The arm from its numbers: for every joint its axis and point, then the foot; a position for a target. Whether there is one. */
static inline int WG_NAME(wg_serial_read)(const WG_REAL *geometry, const WG_REAL p[3], int32_t sequence, struct WG_NAME(wg_serial) * arm) {
    int i, j, fine = sequence > 1 && sequence < (2 << WG_MOST_JOINTS);
    for (arm->n = 0; fine && sequence >> (arm->n + 1) > 0; ++arm->n) {
    }
    for (i = 0; fine && i < 6 * arm->n + 3; ++i) {
        fine = isfinite(geometry[i]) && (i >= 3 || isfinite(p[i]));
    }
    arm->rows = 3;
    arm->motion = NULL;
    arm->data = NULL;
    arm->edges = 0;
    arm->rough = WG_C(1.0);
    arm->along_edges = NULL;
    arm->tolerance = WG_C(0.0);
    for (i = 0; fine && i < 3; ++i) {
        arm->tolerance = WG_MAX(arm->tolerance, WG_ABS(geometry[3 + i]));
        for (j = 0; j < arm->n; ++j) {
            arm->slides[j] = (sequence >> (arm->n - 1 - j)) % 2 == 1;
            arm->axis[j][i] = geometry[6 * j + i];
            arm->point[j][i] = geometry[6 * j + 3 + i] - geometry[3 + i];
        }
        arm->foot[i] = geometry[6 * arm->n + i] - geometry[3 + i];
        arm->target[i] = p[i] - geometry[3 + i];
        fine = isfinite(arm->foot[i]) && isfinite(arm->target[i]);
        for (j = 0; j < arm->n; ++j) {
            fine = fine && isfinite(arm->point[j][i]);
        }
    }
    if (fine) {
        WG_NAME(wg_serial_scale)(arm);
    }
    return fine;
}

/* The same with a rigid transform [4][4] for a target; the foot's rotation at q = 0 follows its position. */
static inline int WG_NAME(wg_serial_read_pose)(const WG_REAL *geometry, const WG_REAL T[16], int32_t sequence,
                                               struct WG_NAME(wg_serial) * arm) {
    WG_REAL p[3], R[9], square[9], next[9], determinant;
    int i, k, fine = WG_ABS(T[15] - WG_C(1.0)) <= WG_RIGID;
    for (i = 0; i < 9; ++i) {
        R[i] = T[i + i / 3];
        p[i / 3] = T[4 * (i / 3) + 3];
        fine = fine && WG_ABS(R[i]) <= WG_C(2.0) && WG_ABS(T[12 + i / 3]) <= WG_RIGID;
    }
    if (!fine || !WG_NAME(wg_serial_read)(geometry, p, sequence, arm)) {
        return 0;
    }
    arm->rows = 6;
    WG_NAME(wg_product_3)(R, geometry + 6 * arm->n + 3, 1, arm->rotation);
    for (k = 0; k < 3 && fine; ++k) { /* the nearest rotation */
        WG_NAME(wg_product_3)(arm->rotation, arm->rotation, 1, square);
        for (i = 0; i < 9; ++i) {
            fine = fine && WG_ABS(square[i] - (i % 4 == 0 ? WG_C(1.0) : WG_C(0.0))) <= WG_RIGID;
            square[i] = (i % 4 == 0 ? WG_C(1.5) : WG_C(0.0)) - WG_C(0.5) * square[i];
        }
        WG_NAME(wg_product_3)(square, arm->rotation, 0, next);
        for (i = 0; i < 9; ++i) {
            arm->rotation[i] = next[i];
        }
    }
    determinant = R[0] * (R[4] * R[8] - R[5] * R[7]) + R[1] * (R[5] * R[6] - R[3] * R[8]) + R[2] * (R[3] * R[7] - R[4] * R[6]);
    return fine && determinant > WG_C(0.0);
}

#undef WG_TOLERANCE
#undef WG_RIGID
#undef WG_ZOOM
#undef WG_LIBM
#endif
