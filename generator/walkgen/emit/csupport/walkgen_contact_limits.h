/* walkgen_contact_limits.h: multipliers of balance and of limits on sums of forces; walkgen_math.h explains the macros.
 *
 * The multipliers y of balance and l >= low of rows T f <= t maximise b . y - t . l less half of sum weight |f|^2 of the nearest forces to
 * ease (A' y - T' l), or the bounded form of walkgen_contact_dual.h, which has a maximum always: then less |l|^2 / 2 too.
 */
#include "walkgen_contact_newton.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CONTACT_LIMITS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CONTACT_LIMITS_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CONTACT_LIMITS_F64
#else
#define WALKGEN_CONTACT_LIMITS_F32
#endif
#ifndef WALKGEN_MAX_LIMITS
#define WALKGEN_MAX_LIMITS (6 * WALKGEN_MAX_FEET)
#endif
#ifndef WG_CONTACT_ALL
#define WG_CONTACT_ALL (6 + WALKGEN_MAX_LIMITS)
#endif

/* Rows of size 1 over the feet's components and their ends; multipliers with their slope; `low` their least values. */
struct WG_NAME(wg_contact_limits) {
    int32_t rows;
    WG_REAL T[WALKGEN_MAX_LIMITS][3][WALKGEN_MAX_FEET], end[WALKGEN_MAX_LIMITS], size[WALKGEN_MAX_LIMITS];
    WG_REAL l[WALKGEN_MAX_LIMITS], low[WALKGEN_MAX_LIMITS], slope[WALKGEN_MAX_LIMITS];
    WG_REAL centre[3][WALKGEN_MAX_FEET];
    struct WG_NAME(wg_contact_dual) dual;
};

/* T_r . f. */
static inline WG_REAL WG_NAME(wg_contact_along)(const struct WG_NAME(wg_contact_limits) * limits, int r, int32_t feet,
                                                const WG_REAL f[3][WALKGEN_MAX_FEET]) {
    WG_REAL sum = WG_C(0.0);
    int i;
    for (i = 0; i < feet; ++i) {
        sum += limits->T[r][0][i] * f[0][i] + limits->T[r][1][i] * f[1][i] + limits->T[r][2][i] * f[2][i];
    }
    return sum;
}

/* A' y - T' l. */
static inline void WG_NAME(wg_contact_pull_all)(const struct WG_NAME(wg_contact_stance) * stance,
                                                const struct WG_NAME(wg_contact_limits) * limits,
                                                const WG_REAL y[6], const WG_REAL *l, WG_REAL z[3][WALKGEN_MAX_FEET]) {
    int r, i, j;
    WG_NAME(wg_contact_pull)(stance, y, z);
    for (r = 0; r < limits->rows; ++r) {
        for (j = 0; j < 3 && !(l[r] <= WG_C(0.0) && l[r] >= WG_C(0.0)); ++j) {
            for (i = 0; i < stance->feet; ++i) {
                z[j][i] -= l[r] * limits->T[r][j][i];
            }
        }
    }
}

/* Forces, slopes and the value at the multipliers. */
WG_CALLED WG_REAL WG_NAME(wg_contact_evaluate_all)(const struct WG_NAME(wg_contact_stance) * stance,
                                                   struct WG_NAME(wg_contact_limits) * limits) {
    struct WG_NAME(wg_contact_dual) *dual = &limits->dual;
    WG_REAL z[3][WALKGEN_MAX_FEET], product[6], value = WG_NAME(wg_contact_product)(stance->b, dual->y);
    int i, j, r;
    WG_NAME(wg_contact_pull_all)(stance, limits, dual->y, limits->l, z);
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < ((stance->feet + 3) & ~3); ++i) {
            z[j][i] = i < stance->feet ? limits->centre[j][i] + dual->stretch * stance->ease[i] * z[j][i] : WG_C(0.0);
        }
    }
    WG_NAME(wg_contact_nearest)(&stance->cones, z, &dual->images);
    WG_NAME(wg_contact_rest)(stance, dual->images.f, dual->slope);
    WG_NAME(wg_contact_metric)(stance, dual->y, product);
    value -= WG_C(0.5) * WG_NAME(wg_contact_product)(product, dual->y);
    for (j = 0; j < 6; ++j) {
        dual->slope[j] -= j > 2 && stance->lost[j - 3] ? WG_C(0.0) : product[j];
    }
    for (i = 0; i < stance->feet; ++i) { /* half of |z|^2 - |z - f|^2, whose slope is f */
        for (j = 0; j < 3; ++j) {
            const WG_REAL f = dual->images.f[j][i];
            value -= (z[j][i] * f - WG_C(0.5) * f * f) / (dual->stretch * stance->ease[i]);
        }
    }
    for (r = 0; r < limits->rows; ++r) {
        const WG_REAL given = WG_NAME(wg_contact_along)(limits, r, stance->feet, (const WG_REAL(*)[WALKGEN_MAX_FEET])dual->images.f);
        limits->slope[r] = given - limits->end[r] - limits->l[r];
        value -= limits->l[r] * (limits->end[r] + WG_C(0.5) * limits->l[r]);
    }
    return value;
}

/* Row `a` of A (below 6) or of -T, over the feet's components. */
static inline void WG_NAME(wg_contact_row)(const struct WG_NAME(wg_contact_stance) * stance,
                                           const struct WG_NAME(wg_contact_limits) * limits, int a,
                                           WG_REAL row[3][WALKGEN_MAX_FEET]) {
    WG_REAL unit[6] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    int i, j;
    if (a < 6) {
        unit[a] = WG_C(1.0);
        WG_NAME(wg_contact_pull)(stance, unit, row);
        return;
    }
    for (j = 0; j < 3; ++j) {
        for (i = 0; i < stance->feet; ++i) {
            row[j][i] = -limits->T[a - 6][j][i];
        }
    }
}

/* L, lower triangle, row by row: minus the second derivative over the chosen multipliers. */
WG_CALLED void WG_NAME(wg_contact_curvature_all)(const struct WG_NAME(wg_contact_stance) * stance,
                                                 const struct WG_NAME(wg_contact_limits) * limits,
                                                     const int *chosen, int count, WG_REAL *L) {
    static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    WG_REAL row[3][WALKGEN_MAX_FEET], turned[3][WALKGEN_MAX_FEET], other[3][WALKGEN_MAX_FEET];
    int a, c, i, j;
    for (a = 0; a < count; ++a) {
        WG_NAME(wg_contact_row)(stance, limits, chosen[a], row);
        for (i = 0; i < stance->feet; ++i) {
            for (j = 0; j < 3; ++j) {
                turned[j][i] = limits->dual.stretch * stance->ease[i] *
                               (limits->dual.images.slope[place[j][0]][i] * row[0][i] +
                                limits->dual.images.slope[place[j][1]][i] * row[1][i] +
                                limits->dual.images.slope[place[j][2]][i] * row[2][i]);
            }
        }
        for (c = 0; c <= a; ++c) {
            WG_REAL sum = a == c ? (a < 3 ? stance->mass : WG_C(1.0)) : WG_C(0.0);
            if (a < 6 && c > 2) {
                sum = stance->inertia[place[a - 3][c - 3]];
            }
            WG_NAME(wg_contact_row)(stance, limits, chosen[c], other);
            for (i = 0; i < stance->feet; ++i) {
                sum += turned[0][i] * other[0][i] + turned[1][i] * other[1][i] + turned[2][i] * other[2][i];
            }
            L[a * (a + 1) / 2 + c] = sum;
        }
    }
}

/* step = H^-1 step by L D L' in place; pivots that rounding made nothing move nothing. */
WG_CALLED void WG_NAME(wg_contact_solve_all)(WG_REAL *L, int count, const int *fixed, WG_REAL *step) {
    WG_REAL inverse[WG_CONTACT_ALL], scaled[WG_CONTACT_ALL];
    int i, j, m;
    for (j = 0; j < count; ++j) {
        WG_REAL *row = L + j * (j + 1) / 2, pivot = row[j];
        const WG_REAL size = WG_ABS(row[j]);
        for (m = 0; m < j; ++m) {
            WG_REAL sum = row[m];
            const WG_REAL *above = L + m * (m + 1) / 2;
            for (i = 0; i < m; ++i) {
                sum -= scaled[i] * above[i];
            }
            scaled[m] = sum; /* L D */
            row[m] = sum * inverse[m];
            pivot -= sum * row[m];
            step[j] -= row[m] * step[m];
        }
        inverse[j] = pivot > WG_C(4.0) * WG_EPSILON * size && !fixed[j] ? WG_C(1.0) / pivot : WG_C(0.0);
    }
    for (j = count - 1; j >= 0; --j) {
        step[j] *= inverse[j];
        for (i = j + 1; i < count; ++i) {
            step[j] -= inverse[j] > WG_C(0.0) ? L[i * (i + 1) / 2 + j] * step[i] : WG_C(0.0);
        }
    }
}

/* The length of the slope that multipliers at their least value leave. */
static inline WG_REAL WG_NAME(wg_contact_lacking_all)(const struct WG_NAME(wg_contact_limits) * limits) {
    WG_REAL square = WG_NAME(wg_contact_product)(limits->dual.slope, limits->dual.slope);
    int r;
    for (r = 0; r < limits->rows; ++r) {
        const WG_REAL rise = limits->l[r] > limits->low[r] || limits->slope[r] > WG_C(0.0) ? limits->slope[r] : WG_C(0.0);
        square += rise * rise;
    }
    return WG_SQRT(square);
}

/* The length of all multipliers. */
static inline WG_REAL WG_NAME(wg_contact_length_all)(const struct WG_NAME(wg_contact_limits) * limits) {
    WG_REAL square = WG_NAME(wg_contact_product)(limits->dual.y, limits->dual.y);
    int r;
    for (r = 0; r < limits->rows; ++r) {
        square += limits->l[r] * limits->l[r];
    }
    return WG_SQRT(square);
}

/* One projected Newton step with halved lengths; whether the value rose. */
WG_CALLED int WG_NAME(wg_contact_stride)(const struct WG_NAME(wg_contact_stance) * stance, struct WG_NAME(wg_contact_limits) * limits,
                                         WG_REAL value,
                                             WG_REAL *next) {
    WG_REAL L[WG_CONTACT_ALL * (WG_CONTACT_ALL + 1) / 2], step[WG_CONTACT_ALL], from[WG_CONTACT_ALL], t = WG_C(1.0);
    int chosen[WG_CONTACT_ALL], fixed[WG_CONTACT_ALL], count = 0, turn, i;
    for (i = 0; i < 6 + limits->rows; ++i) {
        const int r = i - 6;
        from[i] = i < 6 ? limits->dual.y[i] : limits->l[r];
        if (i < 6 || limits->l[r] > limits->low[r] || limits->slope[r] > WG_C(0.0)) {
            fixed[count] = i > 2 && i < 6 && stance->lost[i - 3];
            step[count] = i < 6 ? limits->dual.slope[i] : limits->slope[r];
            chosen[count++] = i;
        }
    }
    WG_NAME(wg_contact_curvature_all)(stance, limits, chosen, count, L);
    WG_NAME(wg_contact_solve_all)(L, count, fixed, step);
    for (turn = 0; turn < 40; ++turn, t *= WG_C(0.5)) {
        for (i = 0; i < count; ++i) {
            const WG_REAL to = from[chosen[i]] + t * step[i];
            if (i < 6) {
                limits->dual.y[i] = to;
            } else {
                limits->l[chosen[i] - 6] = WG_MAX(to, limits->low[chosen[i] - 6]);
            }
        }
        *next = WG_NAME(wg_contact_evaluate_all)(stance, limits);
        if (*next > value - WG_C(8.0) * WG_EPSILON * WG_ABS(value) || (turn == 0 && *next >= value)) {
            return *next > value;
        }
    }
    for (i = 0; i < 6 + limits->rows; ++i) {
        if (i < 6) {
            limits->dual.y[i] = from[i];
        } else {
            limits->l[i - 6] = from[i];
        }
    }
    *next = WG_NAME(wg_contact_evaluate_all)(stance, limits);
    return 0;
}

/* The maximum near enough: until the slope is small beside the multipliers. */
WG_CALLED void WG_NAME(wg_contact_settle_all)(const struct WG_NAME(wg_contact_stance) * stance,
                                              struct WG_NAME(wg_contact_limits) * limits) {
    WG_REAL value = WG_NAME(wg_contact_evaluate_all)(stance, limits), next = value;
    int turn, idle = 0;
    for (turn = 0; turn < 60 && idle < 3; ++turn) {
        if (turn > 0 && WG_NAME(wg_contact_lacking_all)(limits) <= WG_C(1e-3) * WG_NAME(wg_contact_length_all)(limits)) {
            return;
        }
        idle = WG_NAME(wg_contact_stride)(stance, limits, value, &next) ? 0 : idle + 1;
        value = next;
    }
}

#endif
