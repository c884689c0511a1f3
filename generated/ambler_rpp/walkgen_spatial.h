/* walkgen_spatial.h: vectors, and a foot moved by up to three joints given by their axes, or by three as a function has it; walkgen_math.h
 * explains the macros.
 *
 * wg_nearest leads joint values to a local minimum of the foot's distance to a target: Newton on the equations while that helps, then
 * Newton on half the squared distance with the eigenvalues of its matrix made positive, damped as far as the distance needs it to fall.
 */
#include "walkgen_driven_foot.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_SPATIAL_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_SPATIAL_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_SPATIAL_F64
#define WG_LEAST WG_C(1e-300)
#else
#define WALKGEN_SPATIAL_F32
#define WG_LEAST WG_C(1e-36)
#endif

/* Joints at q = 0, base to foot: unit axes through points; a joint slides along its axis or turns about it. Of three joints a function may
 * have the foot instead (NULL where it does not), in a frame: its rotation [9], its origin [3]. */
struct WG_NAME(wg_chain) {
    int n, slides[3];
    WG_REAL axis[3][3], point[3][3], foot[3];
    WG_NAME(wg_driven_foot) motion;
    const void *data;
    const WG_REAL *frame;
};

/* The foot at some q, its Jacobian by columns, and second derivatives [i][j] for i <= j. */
struct WG_NAME(wg_motion) {
    WG_REAL foot[3], column[3][3], second[3][3][3];
};

static inline WG_REAL WG_NAME(wg_dot)(const WG_REAL a[3], const WG_REAL b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline WG_REAL WG_NAME(wg_norm)(const WG_REAL a[3]) { return WG_SQRT(WG_NAME(wg_dot)(a, a)); }

static inline void WG_NAME(wg_cross)(const WG_REAL a[3], const WG_REAL b[3], WG_REAL c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* c = a + factor b. */
static inline void WG_NAME(wg_add)(const WG_REAL a[3], WG_REAL factor, const WG_REAL b[3], WG_REAL c[3]) {
    int i;
    for (i = 0; i < 3; ++i) {
        c[i] = a[i] + factor * b[i];
    }
}

/* Rodrigues: the vector turned in place about a unit axis. */
static inline void WG_NAME(wg_turn)(const WG_REAL axis[3], WG_REAL cosine, WG_REAL sine, WG_REAL vector[3]) {
    const WG_REAL along = (WG_C(1.0) - cosine) * WG_NAME(wg_dot)(axis, vector);
    WG_REAL side[3];
    int i;
    WG_NAME(wg_cross)(axis, vector, side);
    for (i = 0; i < 3; ++i) {
        vector[i] = cosine * vector[i] + sine * side[i] + along * axis[i];
    }
}

/* The angle about a unit axis from one vector to another, 0 where one of them is along it. */
static inline WG_REAL WG_NAME(wg_angle_about)(const WG_REAL axis[3], const WG_REAL start[3], const WG_REAL end[3]) {
    WG_REAL side[3];
    WG_NAME(wg_cross)(start, end, side);
    return WG_ATAN2(WG_NAME(wg_dot)(axis, side),
                    WG_NAME(wg_dot)(start, end) - WG_NAME(wg_dot)(axis, start) * WG_NAME(wg_dot)(axis, end));
}

/* Two unit vectors across a unit axis, right-handed with it. */
static inline void WG_NAME(wg_across)(const WG_REAL axis[3], WG_REAL first[3], WG_REAL second[3]) {
    WG_REAL other[3] = {WG_C(0.0), WG_C(0.0), WG_C(0.0)}, length;
    int i, least = 0;
    for (i = 1; i < 3; ++i) {
        least = WG_ABS(axis[i]) < WG_ABS(axis[least]) ? i : least;
    }
    other[least] = WG_C(1.0);
    WG_NAME(wg_cross)(axis, other, first);
    length = WG_NAME(wg_norm)(first);
    for (i = 0; i < 3; ++i) {
        first[i] /= length;
    }
    WG_NAME(wg_cross)(axis, first, second);
}

/* Where a joint takes a point, in place. */
static inline void WG_NAME(wg_moved)(const struct WG_NAME(wg_chain) *chain, int joint, WG_REAL q, WG_REAL point[3]) {
    if (chain->slides[joint]) {
        WG_NAME(wg_add)(point, q, chain->axis[joint], point);
        return;
    }
    WG_NAME(wg_add)(point, WG_C(-1.0), chain->point[joint], point);
    WG_NAME(wg_turn)(chain->axis[joint], WG_COS(q), WG_SIN(q), point);
    WG_NAME(wg_add)(point, WG_C(1.0), chain->point[joint], point);
}

/* wg_motion_at by the chain's function; NaN and no derivatives where it has no foot. */
static inline void WG_NAME(wg_driven_motion)(const struct WG_NAME(wg_chain) *chain, const WG_REAL q[3], struct WG_NAME(wg_motion) *at) {
    const WG_REAL *frame = chain->frame;
    WG_REAL values[39];
    int i, j, k, row, fine = 1;
    chain->motion(q, values, chain->data);
    for (i = 0; i < 39; ++i) {
        fine = fine && isfinite(values[i]);
    }
    for (row = 0; row < 3; ++row) {
        at->foot[row] = fine ? frame[9 + row] : WG_NAN;
        for (j = 0; j < 3; ++j) {
            at->column[j][row] = at->second[0][j][row] = at->second[1][j][row] = at->second[2][j][row] = WG_C(0.0);
        }
        for (i = 0; i < 3 && fine; ++i) {
            const WG_REAL share = frame[3 * row + i];
            at->foot[row] += share * values[i];
            for (j = 0; j < 3; ++j) {
                at->column[j][row] += share * values[3 + 3 * i + j];
                for (k = j; k < 3; ++k) {
                    at->second[j][k][row] += share * values[12 + 9 * i + 3 * j + k];
                }
            }
        }
    }
}

/* Foot, Jacobian and second derivatives at q: what lies beyond a joint moves with it. */
static inline void WG_NAME(wg_motion_at)(const struct WG_NAME(wg_chain) *chain, const WG_REAL q[3], struct WG_NAME(wg_motion) *at) {
    WG_REAL direction[3][3];
    int i, j;
    if (chain->motion != NULL) {
        WG_NAME(wg_driven_motion)(chain, q, at);
        return;
    }
    for (i = 0; i < 3; ++i) {
        at->foot[i] = chain->foot[i];
    }
    for (j = chain->n - 1; j >= 0; --j) {
        const WG_REAL *axis = chain->axis[j];
        const WG_REAL cosine = WG_COS(q[j]), sine = WG_SIN(q[j]);
        WG_REAL arm[3];
        for (i = 0; i < 3; ++i) {
            direction[j][i] = at->column[j][i] = axis[i];
        }
        if (chain->slides[j]) {
            WG_NAME(wg_add)(at->foot, q[j], axis, at->foot);
            continue;
        }
        for (i = j + 1; i < chain->n; ++i) {
            WG_NAME(wg_turn)(axis, cosine, sine, direction[i]);
            WG_NAME(wg_turn)(axis, cosine, sine, at->column[i]);
        }
        WG_NAME(wg_add)(at->foot, WG_C(-1.0), chain->point[j], arm);
        WG_NAME(wg_turn)(axis, cosine, sine, arm);
        WG_NAME(wg_cross)(axis, arm, at->column[j]);
        WG_NAME(wg_add)(chain->point[j], WG_C(1.0), arm, at->foot);
    }
    for (i = 0; i < chain->n; ++i) {
        for (j = i; j < chain->n; ++j) {
            WG_NAME(wg_cross)(direction[i], at->column[j], at->second[i][j]);
            if (chain->slides[i]) {
                at->second[i][j][0] = at->second[i][j][1] = at->second[i][j][2] = WG_C(0.0);
            }
        }
    }
}

/* Eigenvalues and eigenvectors (columns of V) of a symmetric n by n matrix, n <= 3, by Jacobi's rotations; A becomes diagonal. */
static inline void WG_NAME(wg_eigen)(int n, WG_REAL A[3][3], WG_REAL V[3][3]) {
    int sweep, i, j, k;
    for (i = 0; i < n; ++i) {
        for (j = 0; j < n; ++j) {
            V[i][j] = i == j ? WG_C(1.0) : WG_C(0.0);
        }
    }
    for (sweep = 0; sweep < 10; ++sweep) {
        for (i = 0; i < n - 1; ++i) {
            for (j = i + 1; j < n; ++j) {
                const WG_REAL angle = WG_C(0.5) * WG_ATAN2(WG_C(2.0) * A[i][j], A[j][j] - A[i][i]);
                const WG_REAL c = WG_COS(angle), s = WG_SIN(angle);
                if (!(WG_ABS(A[i][j]) > WG_C(0.01) * WG_EPSILON * WG_SQRT(WG_ABS(A[i][i])) * WG_SQRT(WG_ABS(A[j][j])))) {
                    continue;
                }
                for (k = 0; k < n; ++k) {
                    const WG_REAL a = A[k][i], b = A[k][j], v = V[k][i], w = V[k][j];
                    A[k][i] = c * a - s * b;
                    A[k][j] = s * a + c * b;
                    V[k][i] = c * v - s * w;
                    V[k][j] = s * v + c * w;
                }
                for (k = 0; k < n; ++k) {
                    const WG_REAL a = A[i][k], b = A[j][k];
                    A[i][k] = c * a - s * b;
                    A[j][k] = s * a + c * b;
                }
                A[i][j] = A[j][i] = WG_C(0.0);
            }
        }
    }
}

/* Newton's step J^-1 away of three joints; whether there is one. */
static inline int WG_NAME(wg_exact_step)(const struct WG_NAME(wg_motion) *at, const WG_REAL away[3], WG_REAL step[3]) {
    WG_REAL minor[3][3], determinant;
    int i;
    for (i = 0; i < 3; ++i) {
        WG_NAME(wg_cross)(at->column[(i + 1) % 3], at->column[(i + 2) % 3], minor[i]);
    }
    determinant = WG_NAME(wg_dot)(at->column[0], minor[0]);
    if (!(WG_ABS(determinant) > WG_LEAST)) {
        return 0;
    }
    for (i = 0; i < 3; ++i) {
        step[i] = WG_NAME(wg_dot)(minor[i], away) / determinant;
    }
    return 1;
}

/* (|H| + damping)^-1 gradient of half the squared distance, at most 1 long; the trace of J'J. `fixed` is a joint that stays, or -1. */
static inline WG_REAL WG_NAME(wg_descent)(const struct WG_NAME(wg_chain) *chain, const struct WG_NAME(wg_motion) *at,
                                          const WG_REAL away[3], WG_REAL damping, int fixed, WG_REAL step[3]) {
    WG_REAL H[3][3], V[3][3], gradient[3], floor_value = WG_C(0.0), longest = WG_C(0.0), trace = WG_C(0.0);
    int i, j;
    for (i = 0; i < chain->n; ++i) {
        gradient[i] = i == fixed ? WG_C(0.0) : WG_NAME(wg_dot)(at->column[i], away);
        trace += WG_NAME(wg_dot)(at->column[i], at->column[i]);
        step[i] = WG_C(0.0);
        for (j = i; j < chain->n; ++j) {
            H[i][j] = WG_NAME(wg_dot)(at->column[i], at->column[j]) + WG_NAME(wg_dot)(away, at->second[i][j]);
            if (i == fixed || j == fixed) {
                H[i][j] = i == j ? WG_C(1.0) : WG_C(0.0);
            }
            H[j][i] = H[i][j];
        }
    }
    WG_NAME(wg_eigen)(chain->n, H, V);
    for (i = 0; i < chain->n; ++i) {
        floor_value = WG_MAX(floor_value, WG_C(50.0) * WG_EPSILON * WG_ABS(H[i][i]));
    }
    for (i = 0; i < chain->n; ++i) {
        const WG_REAL size = WG_MAX(WG_ABS(H[i][i]), floor_value) + damping;
        WG_REAL along = WG_C(0.0);
        for (j = 0; j < chain->n; ++j) {
            along += V[j][i] * gradient[j];
        }
        for (j = 0; j < chain->n; ++j) {
            step[j] += size > WG_C(0.0) ? V[j][i] * along / size : WG_C(0.0);
        }
    }
    for (i = 0; i < chain->n; ++i) {
        longest = WG_MAX(longest, WG_ABS(step[i]));
    }
    for (i = 0; i < chain->n && longest > WG_C(1.0); ++i) {
        step[i] /= longest;
    }
    return trace;
}

/* q less the step, if that brings the foot nearer: whether it does. */
static inline int WG_NAME(wg_try_step)(const struct WG_NAME(wg_chain) *chain, const WG_REAL target[3], const WG_REAL step[3], WG_REAL q[3],
                                       struct WG_NAME(wg_motion) *at, WG_REAL away[3], WG_REAL *gap) {
    struct WG_NAME(wg_motion) after;
    WG_REAL tried[3], left[3], distance;
    int i;
    for (i = 0; i < chain->n; ++i) {
        tried[i] = q[i] - step[i];
    }
    WG_NAME(wg_motion_at)(chain, tried, &after);
    WG_NAME(wg_add)(after.foot, WG_C(-1.0), target, left);
    distance = WG_NAME(wg_norm)(left);
    if (!(distance < *gap)) {
        return 0;
    }
    for (i = 0; i < 3; ++i) {
        away[i] = left[i];
        q[i] = i < chain->n ? tried[i] : WG_C(0.0);
    }
    *gap = distance;
    *at = after;
    return 1;
}

/* q brought to a local minimum of the foot's distance to the target: that distance. Lengths are about 1.
 * `fixed` is a joint that stays, -1 for none; 3 for none too, but q does not leave its neighbourhood by Newton's long steps. */
static inline WG_REAL WG_NAME(wg_nearest)(const struct WG_NAME(wg_chain) *chain, const WG_REAL target[3], int fixed, WG_REAL q[3]) {
    struct WG_NAME(wg_motion) at;
    WG_REAL away[3], step[3], gap, damping = WG_C(0.0);
    int i, k;
    WG_NAME(wg_motion_at)(chain, q, &at);
    WG_NAME(wg_add)(at.foot, WG_C(-1.0), target, away);
    gap = WG_NAME(wg_norm)(away);
    for (i = 0; i < 5 && chain->n == 3 && fixed < 0 && gap > WG_C(0.0); ++i) {
        if (!WG_NAME(wg_exact_step)(&at, away, step) || !WG_NAME(wg_try_step)(chain, target, step, q, &at, away, &gap)) {
            break;
        }
    }
    for (i = 0; i < 60 && gap > WG_C(2.0) * WG_EPSILON; ++i) {
        const WG_REAL trace = WG_NAME(wg_descent)(chain, &at, away, damping, fixed, step);
        WG_REAL longest = WG_C(0.0);
        for (k = 0; k < chain->n; ++k) {
            longest = WG_MAX(longest, WG_ABS(step[k]));
        }
        if (WG_NAME(wg_try_step)(chain, target, step, q, &at, away, &gap)) {
            damping = damping < WG_C(1e-5) * trace ? WG_C(0.0) : WG_C(0.01) * damping;
        } else {
            damping = WG_MAX(WG_C(100.0) * damping, WG_C(1e-6) * trace);
            if (!(longest > WG_EPSILON && damping < WG_C(1e6) * trace)) {
                break;
            }
        }
    }
    return gap;
}

#undef WG_LEAST
#endif
