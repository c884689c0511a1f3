/* walkgen_stance.h: feet on the ground and the load they carry: centre, length, grasp map and what cannot be carried; walkgen_math.h
 * explains the macros.
 *
 * Everything is in one frame; wrench is the load on the robot (force, moment about the frame's origin) and f_i the ground's force on foot
 * i, so that G f + wrench = 0 with G = [..., [1; [p_i]x], ...]. About the feet's centre, G G' is k 1 for forces and the inertia of unit
 * masses at the feet for moments, without anything between: so singular values are known in closed form, and what is lost are moments about
 * axes.
 */
#include "walkgen_spatial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_STANCE_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_STANCE_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_STANCE_F64
#define WG_UNIT WG_C(1e-9)
#else
#define WALKGEN_STANCE_F32
#define WG_UNIT WG_C(1e-5)
#endif
#ifndef WALKGEN_MAX_FEET
#define WALKGEN_MAX_FEET 16
#endif
#ifndef WG_CONTACT_STICK
#define WG_CONTACT_STICK 0
#define WG_CONTACT_SLIDE 1
#define WG_CONTACT_FREE 2
#endif

/* Feet about their centre in units of `length` (root mean square distance, 1 where there is none), `blur` of which may be rounding of the
 * points; the load about the centre in units of `force` (its length with moments over `length`), `noise`
 * of which may be rounding. */
struct WG_NAME(wg_stance) {
    int32_t feet;
    WG_REAL centre[3], length, r[WALKGEN_MAX_FEET][3], blur, force, load[6], noise;
};

/* Whether numbers are finite. */
static inline int WG_NAME(wg_stance_finite)(const WG_REAL *values, int32_t count) {
    int fine = 1, i;
    for (i = 0; i < count; ++i) {
        fine &= WG_ABS(values[i]) <= WG_HUGE;
    }
    return fine;
}

/* Whether normals are unit vectors. */
static inline int WG_NAME(wg_stance_unit)(int32_t k, const WG_REAL *normals) {
    int fine = 1, i;
    for (i = 0; i < k; ++i) {
        fine &= WG_ABS(WG_NAME(wg_dot)(normals + 3 * i, normals + 3 * i) - WG_C(1.0)) <= WG_C(2.0) * WG_UNIT;
    }
    return fine;
}

/* Largest size of numbers. */
static inline WG_REAL WG_NAME(wg_stance_largest)(const WG_REAL *values, int32_t count) {
    WG_REAL largest = WG_C(0.0);
    int i;
    for (i = 0; i < count; ++i) {
        largest = WG_MAX(largest, WG_ABS(values[i]));
    }
    return largest;
}

/* The feet placed: 0 where k or a point is none. */
static inline int WG_NAME(wg_stance_place)(int32_t k, const WG_REAL *points, struct WG_NAME(wg_stance) * stance) {
    WG_REAL far, sum = WG_C(0.0);
    int i, j;
    if (k < 1 || k > WALKGEN_MAX_FEET || !WG_NAME(wg_stance_finite)(points, 3 * k)) {
        return 0;
    }
    far = WG_MAX(WG_NAME(wg_stance_largest)(points, 3 * k), WG_TINY);
    stance->feet = k;
    for (j = 0; j < 3; ++j) {
        WG_REAL middle = WG_C(0.0);
        for (i = 0; i < k; ++i) {
            middle += points[3 * i + j] / far / (WG_REAL)k;
        }
        for (i = 0; i < k; ++i) {
            stance->r[i][j] = points[3 * i + j] / far - middle;
            sum += stance->r[i][j] * stance->r[i][j] / (WG_REAL)k;
        }
        stance->centre[j] = far * middle;
    }
    sum = WG_SQRT(sum);
    if (!(sum > WG_C(64.0) * WG_EPSILON)) { /* one point, to rounding */
        stance->length = WG_C(1.0);
        stance->blur = WG_INFINITY;
        sum = WG_INFINITY;
    } else {
        stance->length = far * sum;
        stance->blur = WG_C(64.0) * WG_EPSILON * WG_MAX(WG_C(1.0), WG_C(1.0) / sum);
    }
    for (i = 0; i < k; ++i) {
        for (j = 0; j < 3; ++j) {
            stance->r[i][j] /= sum;
        }
    }
    return stance->length <= WG_HUGE && stance->length > WG_C(0.0);
}

/* The load seen from the centre: 0 where it is none. */
static inline int WG_NAME(wg_stance_load)(const WG_REAL wrench[6], struct WG_NAME(wg_stance) * stance) {
    WG_REAL arm[3], size, squares = WG_C(0.0);
    int j;
    WG_NAME(wg_cross)(stance->centre, wrench, arm);
    for (j = 0; j < 3; ++j) {
        stance->load[j] = wrench[j];
        stance->load[3 + j] = (wrench[3 + j] - arm[j]) / stance->length;
    }
    if (!WG_NAME(wg_stance_finite)(wrench, 6) || !WG_NAME(wg_stance_finite)(stance->load, 6)) {
        return 0;
    }
    size = WG_MAX(WG_NAME(wg_stance_largest)(stance->load, 6), WG_TINY);
    for (j = 0; j < 6; ++j) {
        stance->load[j] /= size;
        squares += stance->load[j] * stance->load[j];
    }
    squares = squares > WG_C(0.0) ? WG_SQRT(squares) : WG_C(1.0);
    stance->force = size * squares;
    for (j = 0; j < 6; ++j) {
        stance->load[j] /= squares;
    }
    stance->noise = WG_NAME(wg_norm)(wrench + 3) + (WG_NAME(wg_norm)(stance->centre) + stance->length) * WG_NAME(wg_norm)(wrench);
    stance->noise *= WG_C(4096.0) * WG_EPSILON / stance->length / stance->force;
    return stance->force <= WG_HUGE;
}

/* The wrench about the centre of a unit force at foot i. */
static inline void WG_NAME(wg_stance_push)(const struct WG_NAME(wg_stance) * stance, int i, const WG_REAL force[3], WG_REAL column[6]) {
    WG_NAME(wg_add)(force, WG_C(0.0), force, column);
    WG_NAME(wg_cross)(stance->r[i], force, column + 3);
}

/* Inner product of wrenches and twists. */
static inline WG_REAL WG_NAME(wg_stance_product)(const WG_REAL a[6], const WG_REAL b[6]) {
    return WG_NAME(wg_dot)(a, b) + WG_NAME(wg_dot)(a + 3, b + 3);
}

/* The orthogonal part of a vector to the first `count` of an orthonormal set, taken twice against rounding; the parts along them in
 * `along`: its length. */
static inline WG_REAL WG_NAME(wg_stance_across)(WG_REAL set[6][6], int count, WG_REAL vector[6], WG_REAL along[6]) {
    int turn, i, j;
    for (i = 0; i < count; ++i) {
        along[i] = WG_C(0.0);
    }
    for (turn = 0; turn < 2; ++turn) {
        for (i = 0; i < count; ++i) {
            const WG_REAL part = WG_NAME(wg_stance_product)(set[i], vector);
            along[i] += part;
            for (j = 0; j < 6; ++j) {
                vector[j] -= part * set[i][j];
            }
        }
    }
    return WG_SQRT(WG_NAME(wg_stance_product)(vector, vector));
}

/* `count` vectors of a set made orthonormal, vector i = sum of triangle[i][j] set[j]: 0 where one depends on those before it, but for
 * `blur` of its length. */
static inline int WG_NAME(wg_stance_orthonormal)(WG_REAL set[6][6], int count, WG_REAL blur, WG_REAL triangle[6][6]) {
    int i, j;
    for (i = 0; i < count; ++i) {
        const WG_REAL before = WG_SQRT(WG_NAME(wg_stance_product)(set[i], set[i]));
        triangle[i][i] = WG_NAME(wg_stance_across)(set, i, set[i], triangle[i]);
        if (!(triangle[i][i] > blur * before)) {
            return 0;
        }
        for (j = 0; j < 6; ++j) {
            set[i][j] /= triangle[i][i];
        }
    }
    return 1;
}

/* An orthonormal set of `count` vectors completed to one of 6. */
static inline void WG_NAME(wg_stance_complete)(WG_REAL set[6][6], int count) {
    WG_REAL tried[6], along[6], longest, length;
    int i, j, axis;
    for (i = count; i < 6; ++i) {
        longest = WG_C(0.0);
        for (axis = 0; axis < 6; ++axis) {
            for (j = 0; j < 6; ++j) {
                tried[j] = WG_INDICATOR(j == axis);
            }
            length = WG_NAME(wg_stance_across)(set, i, tried, along);
            for (j = 0; j < 6 && length > longest; ++j) {
                set[i][j] = tried[j] / length;
            }
            longest = WG_MAX(longest, length);
        }
    }
}

/* Principal moments of the feet (unit masses, length 1), greatest first, with their axes; how many are none to rounding. */
static inline int WG_NAME(wg_stance_moments)(const struct WG_NAME(wg_stance) * stance, WG_REAL moments[3], WG_REAL axes[3][3]) {
    WG_REAL J[3][3], V[3][3];
    int i, j, c, least, lost = 0;
    for (i = 0; i < 3; ++i) {
        for (j = 0; j < 3; ++j) {
            J[i][j] = WG_C(0.0);
            for (c = 0; c < stance->feet; ++c) {
                const WG_REAL *r = stance->r[c];
                J[i][j] += (i == j ? WG_NAME(wg_dot)(r, r) : WG_C(0.0)) - r[i] * r[j];
            }
        }
    }
    WG_NAME(wg_eigen)(3, J, V);
    for (i = 2; i >= 0; --i) {
        least = i;
        for (j = 0; j < i; ++j) {
            least = J[j][j] < J[least][least] ? j : least;
        }
        for (j = 0; j < 3; ++j) {
            const WG_REAL other = V[j][i];
            axes[i][j] = V[j][least];
            V[j][least] = other;
        }
        J[least][least] = J[i][i];
        moments[i] = WG_C(0.0);
        for (c = 0; c < stance->feet; ++c) { /* again from the feet: J has rounding where they are on a line */
            WG_REAL arm[3];
            WG_NAME(wg_cross)(axes[i], stance->r[c], arm);
            moments[i] += WG_NAME(wg_dot)(arm, arm);
        }
        if (!(moments[i] > (WG_REAL)stance->feet * stance->blur * stance->blur)) {
            moments[i] = WG_C(0.0);
            ++lost;
        }
    }
    return lost;
}

/* Six numbers, the greatest first. */
static inline void WG_NAME(wg_stance_descending)(WG_REAL values[6]) {
    int i, j;
    for (i = 0; i < 5; ++i) {
        for (j = 5; j > i; --j) {
            const WG_REAL less = WG_MIN(values[j - 1], values[j]);
            values[j - 1] = WG_MAX(values[j - 1], values[j]);
            values[j] = less;
        }
    }
}

/* G [6, 3k] = [..., [1; [p_i]x], ...] of k points [k, 3]; NaN unless `fine`. */
static inline void WG_NAME(wg_stance_map)(int32_t k, const WG_REAL *WG_RESTRICT points, int fine, WG_REAL *WG_RESTRICT G) {
    WG_REAL unit[3], column[3];
    int i, j, c;
    for (i = 0; i < 3 * k; ++i) {
        for (j = 0; j < 3; ++j) {
            unit[j] = WG_INDICATOR(j == i % 3);
        }
        WG_NAME(wg_cross)(points + i / 3 * 3, unit, column);
        for (c = 0; c < 3; ++c) {
            G[3 * k * c + i] = fine ? unit[c] : WG_NAN;
            G[3 * k * (3 + c) + i] = fine ? column[c] : WG_NAN;
        }
    }
}

/* The grasp map of k feet, G [6, 3 k], its singular values [6], its condition (infinite with anything lost) and rank: of forces and moments
 * about the feet's centre, those over the root mean square distance of the feet from it, so that neither the frame nor the unit of length
 * counts. What cannot be carried: the load components lost [3, 6], one a row, zeros where there are fewer; feet carry a wrench only if
 * lost . wrench = 0. OK; SINGULAR with something lost: coincident feet (rank 3) or collinear ones (rank 5); BAD_INPUT and NaN. */
static inline void WG_NAME(wg_grasp)(int32_t k, const WG_REAL *WG_RESTRICT points, WG_REAL *WG_RESTRICT G,
                                     WG_REAL *WG_RESTRICT singular_values,
                                     WG_REAL *WG_RESTRICT lost, WG_REAL *WG_RESTRICT condition, int32_t *WG_RESTRICT rank,
                                     int32_t *WG_RESTRICT status) {
    struct WG_NAME(wg_stance) stance;
    WG_REAL moments[3], axes[3][3];
    const int fine = WG_NAME(wg_stance_place)(k, points, &stance);
    int i, missing = fine ? WG_NAME(wg_stance_moments)(&stance, moments, axes) : 6;
    *status = !fine ? WALKGEN_BAD_INPUT : missing > 0 ? WALKGEN_SINGULAR : WALKGEN_OK;
    *rank = 6 - missing;
    for (i = 0; i < 18; ++i) {
        lost[i] = fine ? WG_C(0.0) : WG_NAN;
    }
    for (i = 0; i < 3; ++i) {
        WG_REAL *row = lost + 6 * (i - 3 + missing);
        singular_values[i] = fine ? WG_SQRT((WG_REAL)k) : WG_NAN;
        singular_values[3 + i] = fine ? WG_SQRT(moments[i]) : WG_NAN;
        if (fine && i >= 3 - missing) {
            WG_NAME(wg_cross)(stance.centre, axes[i], row);
            WG_NAME(wg_add)(axes[i], WG_C(0.0), axes[i], row + 3);
        }
    }
    if (fine) {
        WG_NAME(wg_stance_descending)(singular_values); /* forces' values among those of moments */
    }
    *condition = fine ? (missing ? WG_INFINITY : singular_values[0] / singular_values[5]) : WG_NAN;
    WG_NAME(wg_stance_map)(k >= 1 && k <= WALKGEN_MAX_FEET ? k : 0, points, fine, G);
}

#undef WG_UNIT
#endif
