/* walkgen_chart.h: a chain of closed loops in other coordinates, near where a loop ceases to close; walkgen_math.h explains the macros.
 *
 * There the foot's slopes are infinite: its place is a smooth function of the root of the loop's margin, which is itself smooth. In a chart
 * the roots u of small margins stand for as many joint values, those that move them most,
 *     margin(q) = u^2,    u >= a bound,
 * which Newton's method solves for these joint values.
 */
#include "walkgen_boxed.h"
#include "walkgen_triads.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_CHART_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_CHART_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_CHART_F64
#else
#define WALKGEN_CHART_F32
#endif
#ifndef WG_CHART_STEPS
#define WG_CHART_STEPS 20
#define WG_LONGEST_STEP WG_C(0.1)
#define WG_SMALL_MARGIN WG_C(1e-2)
#define WG_LEAST_SLOPE WG_C(1e-3)
#define WG_TIRED WG_C(0.01)
#endif

/* What is charted; which margins' roots stand for which joints, in a pose q [n]. */
struct WG_NAME(wg_chart) {
    const struct WG_NAME(wg_serial) * arm;
    const struct WG_NAME(wg_box) * box;
    int count, edge[WG_MOST_EDGES], joint[WG_MOST_EDGES];
    WG_REAL q[WG_MOST_JOINTS];
};

/* How q moves with the chart's values: the joints that roots stand for [count][n]; each other one as its own. */
struct WG_NAME(wg_chart_slopes) {
    WG_REAL inverse[WG_MOST_EDGES * WG_MOST_EDGES], root[WG_MOST_EDGES], move[WG_MOST_EDGES][WG_MOST_JOINTS], own[WG_MOST_JOINTS];
};

/* The slope of a row of a motion by a joint, and where its second derivatives [n][n] are. */
static inline WG_REAL WG_NAME(wg_row_slope)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *motion, int row, int joint) {
    return motion[3 + arm->edges + arm->n * row + joint];
}

static inline const WG_REAL *WG_NAME(wg_row_bends)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *motion, int row) {
    return motion + (3 + arm->edges) * (1 + arm->n) + arm->n * arm->n * row;
}

/* The slopes of the chart's margins by its joints [count][count]. */
static inline void WG_NAME(wg_chart_matrix)(const struct WG_NAME(wg_chart) * chart, const WG_REAL *motion, WG_REAL *M) {
    int k, l;
    for (k = 0; k < chart->count; ++k) {
        for (l = 0; l < chart->count; ++l) {
            M[chart->count * k + l] = WG_NAME(wg_row_slope)(chart->arm, motion, 3 + chart->edge[k], chart->joint[l]);
        }
    }
}

/* What margins lack of the squared roots in y [n], and a step [count] that would make up for it; the greatest, infinite where there is none. */
static inline WG_REAL WG_NAME(wg_chart_lack)(const struct WG_NAME(wg_chart) * chart, const WG_REAL *y, const WG_REAL *motion, WG_REAL *step) {
    WG_REAL M[WG_MOST_EDGES * WG_MOST_EDGES], worst = WG_C(0.0);
    int k, fine;
    WG_NAME(wg_chart_matrix)(chart, motion, M);
    for (k = 0; k < chart->count; ++k) {
        const WG_REAL root = y[chart->joint[k]];
        step[k] = root * root - motion[3 + chart->edge[k]];
        worst = WG_MAX(worst, WG_ABS(step[k]));
    }
    fine = isfinite(worst) && WG_NAME(wg_triads_eliminate)(chart->count, M, step) != WG_C(0.0);
    for (k = 0; k < chart->count; ++k) {
        fine = fine && isfinite(step[k]);
        step[k] = WG_MIN(WG_MAX(step[k], -WG_LONGEST_STEP), WG_LONGEST_STEP);
    }
    return fine ? worst : WG_INFINITY;
}

/* Whether the chart's joints are within their bounds, but for roundings. */
static inline int WG_NAME(wg_chart_inside)(const struct WG_NAME(wg_chart) * chart, const WG_REAL *q) {
    int k, inside = 1;
    for (k = 0; k < chart->count; ++k) {
        const int j = chart->joint[k];
        const WG_REAL slack = WG_C(8.0) * WG_EPSILON * (WG_C(1.0) + WG_ABS(q[j]));
        inside = inside && q[j] >= chart->box->low[j] - slack && q[j] <= chart->box->high[j] + slack;
    }
    return inside;
}

/* The pose q [n] that the chart's values y [n] stand for, and the motion there; whether there is one, within bounds. */
static inline int WG_NAME(wg_chart_pose)(const struct WG_NAME(wg_chart) * chart, const WG_REAL *y, WG_REAL *q, WG_REAL *motion) {
    const struct WG_NAME(wg_serial) *arm = chart->arm;
    WG_REAL own[WG_MOST_JOINTS], step[WG_MOST_EDGES], before = WG_INFINITY, part = WG_C(1.0);
    int i, k, there, ended = 0;
    for (k = 0; k < WG_MOST_EDGES; ++k) {
        step[k] = WG_C(0.0);
    }
    for (k = 0; k < arm->n; ++k) {
        q[k] = y[k];
    }
    for (k = 0; k < chart->count; ++k) {
        q[chart->joint[k]] = chart->q[chart->joint[k]];
    }
    for (i = 0; i < WG_CHART_STEPS && !ended; ++i) {
        WG_REAL next[WG_MOST_EDGES], worst;
        WG_NAME(wg_driven_values)(arm->n, arm->slides, arm->size, q, own);
        arm->motion(own, motion, arm->data);
        there = WG_NAME(wg_driven_scaled)(arm->edges, arm->n, arm->slides, arm->size, motion);
        worst = WG_NAME(wg_chart_lack)(chart, y, motion, next);
        ended = there && (worst <= WG_C(0.0) || (worst <= WG_C(64.0) * WG_EPSILON && !(worst < WG_C(0.5) * before)));
        part = worst < WG_INFINITY ? WG_C(1.0) : WG_C(0.5) * part;
        for (k = 0; k < chart->count && !ended; ++k) { /* back where loops are open before it can be told */
            q[chart->joint[k]] += worst < WG_INFINITY ? next[k] : -part * step[k];
            step[k] = worst < WG_INFINITY ? next[k] : step[k];
        }
        before = worst;
    }
    return ended && WG_NAME(wg_chart_inside)(chart, q);
}

/* What the chart's joints do when its values move. */
static inline void WG_NAME(wg_chart_slopes_at)(const struct WG_NAME(wg_chart) * chart, const WG_REAL *motion,
                                               struct WG_NAME(wg_chart_slopes) * slopes) {
    const int n = chart->arm->n, count = chart->count;
    WG_REAL M[WG_MOST_EDGES * WG_MOST_EDGES], unit[WG_MOST_EDGES];
    int j, k, l;
    for (j = 0; j < n; ++j) {
        slopes->own[j] = WG_C(1.0);
    }
    for (k = 0; k < count; ++k) {
        slopes->own[chart->joint[k]] = WG_C(0.0);
        slopes->root[k] = WG_SQRT(WG_MAX(motion[3 + chart->edge[k]], WG_C(0.0)));
        WG_NAME(wg_chart_matrix)(chart, motion, M);
        for (l = 0; l < count; ++l) {
            unit[l] = l == k ? WG_C(1.0) : WG_C(0.0);
        }
        (void)WG_NAME(wg_triads_eliminate)(count, M, unit);
        for (l = 0; l < count; ++l) {
            slopes->inverse[count * l + k] = unit[l];
        }
    }
    for (l = 0; l < count; ++l) {
        for (j = 0; j < n; ++j) {
            slopes->move[l][j] = WG_C(0.0);
            for (k = 0; k < count; ++k) {
                const WG_REAL by = j == chart->joint[k] ? WG_C(2.0) * slopes->root[k] : WG_C(0.0);
                const WG_REAL lost = slopes->own[j] * WG_NAME(wg_row_slope)(chart->arm, motion, 3 + chart->edge[k], j);
                slopes->move[l][j] += slopes->inverse[count * l + k] * (by - lost);
            }
        }
    }
}

/* Second derivatives [n][n] by q as one by the chart's values i and j. */
static inline WG_REAL WG_NAME(wg_chart_bend)(const struct WG_NAME(wg_chart) * chart, const struct WG_NAME(wg_chart_slopes) * slopes,
                                             const WG_REAL *bends, int i, int j) {
    const int n = chart->arm->n, count = chart->count;
    WG_REAL sum = WG_C(0.0);
    int k, l;
    for (k = 0; k <= count; ++k) {
        const WG_REAL *row = bends + n * (k < count ? chart->joint[k] : i);
        const WG_REAL left = k < count ? slopes->move[k][i] : slopes->own[i];
        for (l = 0; l <= count; ++l) {
            sum += left * (l < count ? slopes->move[l][j] : slopes->own[j]) * row[l < count ? chart->joint[l] : j];
        }
    }
    return sum;
}

/* How the chart's joints curve [count] by its values i and j. */
static inline void WG_NAME(wg_chart_curves)(const struct WG_NAME(wg_chart) * chart, const struct WG_NAME(wg_chart_slopes) * slopes,
                                            const WG_REAL *motion, int i, int j, WG_REAL *curves) {
    const int count = chart->count;
    int k, l;
    for (l = 0; l < count; ++l) {
        curves[l] = WG_C(0.0);
    }
    for (k = 0; k < count; ++k) {
        const WG_REAL own = i == j && i == chart->joint[k] ? WG_C(2.0) : WG_C(0.0);
        const WG_REAL *bends = WG_NAME(wg_row_bends)(chart->arm, motion, 3 + chart->edge[k]);
        const WG_REAL lacks = own - WG_NAME(wg_chart_bend)(chart, slopes, bends, i, j);
        for (l = 0; l < count; ++l) {
            curves[l] += slopes->inverse[count * l + k] * lacks;
        }
    }
}

/* The foot with its derivatives by the chart's values y [n], as a chain's function; `data` is the chart. */
static inline void WG_NAME(wg_charted_foot)(const WG_REAL *y, WG_REAL *values, const void *data) {
    const struct WG_NAME(wg_chart) *chart = (const struct WG_NAME(wg_chart) *)data;
    const int n = chart->arm->n, count = chart->count;
    struct WG_NAME(wg_chart_slopes) slopes;
    WG_REAL q[WG_MOST_JOINTS], motion[WG_MOST_MOTION], curves[WG_MOST_EDGES];
    const int there = WG_NAME(wg_chart_pose)(chart, y, q, motion);
    int i, j, k, row;
    WG_NAME(wg_chart_slopes_at)(chart, motion, &slopes);
    for (row = 0; row < 3; ++row) {
        values[row] = there ? motion[row] : WG_NAN;
        for (i = 0; i < n; ++i) {
            WG_REAL *slope = values + 3 + n * row + i;
            *slope = slopes.own[i] * WG_NAME(wg_row_slope)(chart->arm, motion, row, i);
            for (k = 0; k < count; ++k) {
                *slope += slopes.move[k][i] * WG_NAME(wg_row_slope)(chart->arm, motion, row, chart->joint[k]);
            }
        }
    }
    for (i = 0; i < n; ++i) {
        for (j = 0; j < n; ++j) {
            WG_NAME(wg_chart_curves)(chart, &slopes, motion, i, j, curves);
            for (row = 0; row < 3; ++row) {
                WG_REAL *bend = values + 3 + 3 * n + n * (n * row + i) + j;
                *bend = WG_NAME(wg_chart_bend)(chart, &slopes, WG_NAME(wg_row_bends)(chart->arm, motion, row), i, j);
                for (k = 0; k < count; ++k) {
                    *bend += WG_NAME(wg_row_slope)(chart->arm, motion, row, chart->joint[k]) * curves[k];
                }
            }
        }
    }
}

/* The margin and the joint with the greatest slope of `left` [edges][n]; whether there are any. */
static inline int WG_NAME(wg_chart_pivot)(const struct WG_NAME(wg_serial) * arm, const WG_REAL *left, int *edge, int *joint) {
    WG_REAL most = WG_LEAST_SLOPE;
    int j, k, found = 0;
    for (k = 0; k < arm->edges; ++k) {
        for (j = 0; j < arm->n; ++j) {
            if (WG_ABS(left[arm->n * k + j]) > most) {
                most = WG_ABS(left[arm->n * k + j]);
                *edge = k;
                *joint = j;
                found = 1;
            }
        }
    }
    return found;
}

/* The chart of a pose's small margins, by joints that are not at their bounds and move these margins' roots most; rather by others than those
 * that are tired. */
static inline void WG_NAME(wg_chart_at)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box, const WG_REAL *q,
                                        const WG_REAL *motion, const int *tired, struct WG_NAME(wg_chart) * chart) {
    WG_REAL left[WG_MOST_EDGES * WG_MOST_JOINTS];
    const int n = arm->n;
    int j, k, edge, joint;
    chart->arm = arm;
    chart->box = box;
    chart->count = 0;
    for (j = 0; j < n; ++j) {
        const WG_REAL slack = WG_C(64.0) * WG_EPSILON * (WG_C(1.0) + WG_ABS(q[j]));
        const int held = q[j] <= box->low[j] + slack || q[j] >= box->high[j] - slack;
        const WG_REAL factor = WG_C(0.5) * (tired[j] ? WG_TIRED : WG_C(1.0));
        chart->q[j] = q[j];
        for (k = 0; k < arm->edges; ++k) {
            const WG_REAL slope = WG_NAME(wg_row_slope)(arm, motion, 3 + k, j);
            const int open = held || !isfinite(slope) || !(motion[3 + k] < WG_SMALL_MARGIN);
            left[n * k + j] = open ? WG_C(0.0) : factor * slope / WG_SQRT(WG_MAX(motion[3 + k], WG_EPSILON * WG_EPSILON));
        }
    }
    while (chart->count < WG_MOST_EDGES && WG_NAME(wg_chart_pivot)(arm, left, &edge, &joint)) {
        for (k = 0; k < arm->edges; ++k) {
            const WG_REAL factor = left[n * k + joint] / left[n * edge + joint];
            for (j = 0; j < n && k != edge; ++j) {
                left[n * k + j] = j == joint ? WG_C(0.0) : left[n * k + j] - factor * left[n * edge + j];
            }
        }
        for (j = 0; j < n; ++j) {
            left[n * edge + j] = WG_C(0.0);
        }
        chart->edge[chart->count] = edge;
        chart->joint[chart->count++] = joint;
    }
}

#endif
