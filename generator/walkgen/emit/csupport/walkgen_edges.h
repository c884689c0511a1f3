/* walkgen_edges.h: a chain of closed loops at rest where a loop ceases to close; walkgen_math.h explains the macros.
 *
 * Descents in a chart stop at a root's bound as at a joint's. Whether that is at rest is told at the first bound, where slopes are known
 * well (they lose eps / u^2 where both ends of a dyad are at one place at its dead point); lower bounds then lead closer to the edge.
 */
#include "walkgen_chart.h"
#include "walkgen_resting.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_EDGES_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_EDGES_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_EDGES_F64
#define WG_LEVELS {WG_C(9.765625e-4), WG_C(3.0517578125e-5), WG_C(9.5367431640625e-7), WG_C(2.384185791015625e-7), \
                   WG_C(1.1920928955078125e-7), WG_C(5.9604644775390625e-8), WG_C(2.98023223876953125e-8)}
#else
#define WALKGEN_EDGES_F32
#define WG_LEVELS {WG_C(0.03125), WG_C(0.0078125), WG_C(0.001953125), WG_C(0.0017), WG_C(0.0014), WG_C(0.0009765625), WG_C(0.00069053396)}
#endif
#ifndef WG_CHARTS
#define WG_CHARTS 8
#endif

/* The chart as a chain, in the arm's scale; its bounds, of roots the least one, and where it starts. */
static inline void WG_NAME(wg_chart_arm)(const struct WG_NAME(wg_chart) * chart, const WG_REAL *motion, WG_REAL least,
                                         struct WG_NAME(wg_serial) * arm, struct WG_NAME(wg_box) * box, struct WG_NAME(wg_arm_state) * here) {
    int j, k;
    *arm = *chart->arm;
    *box = *chart->box;
    arm->motion = WG_NAME(wg_charted_foot);
    arm->data = chart;
    arm->edges = arm->size = 0;
    arm->rough = WG_C(1.0) / WG_SQRT(WG_EPSILON);
    arm->along_edges = NULL;
    for (j = 0; j < arm->n; ++j) {
        here->q[j] = chart->q[j];
    }
    for (k = 0; k < chart->count; ++k) {
        j = chart->joint[k];
        arm->slides[j] = 0;
        box->low[j] = least;
        box->high[j] = WG_INFINITY;
        here->q[j] = WG_MAX(WG_SQRT(WG_MAX(motion[3 + chart->edge[k]], WG_C(0.0))), least);
    }
}

/* Lead the chart's stance to rest above the roots' first bound, then closer to the edge as bounds sink: whether the first is at rest. */
static inline int WG_NAME(wg_chart_rest)(const struct WG_NAME(wg_chart) * chart, const struct WG_NAME(wg_serial) * arm, const WG_REAL *levels,
                                         struct WG_NAME(wg_box) * box, struct WG_NAME(wg_arm_state) * here) {
    int level, k;
    const int rests = WG_NAME(wg_settle_down)(arm, box, here);
    for (level = 1; rests && level <= 2; ++level) {
        for (k = 0; k < chart->count; ++k) {
            box->low[chart->joint[k]] = levels[level];
        }
        (void)WG_NAME(wg_settle_down)(arm, box, here);
    }
    return rests;
}

/* Whether the foot is there however the last digits of q are rounded: with margins made smaller by that. */
static inline int WG_NAME(wg_chart_firm)(const struct WG_NAME(wg_chart) * chart, const WG_REAL *q, const WG_REAL *motion) {
    struct WG_NAME(wg_arm_state) tried;
    int j, k, firm = 1;
    for (k = 0; k < chart->count && firm; ++k) {
        for (j = 0; j < chart->arm->n; ++j) {
            const WG_REAL slope = WG_NAME(wg_row_slope)(chart->arm, motion, 3 + chart->edge[k], j);
            const WG_REAL turn = chart->arm->slides[j] ? WG_C(0.0) : WG_PI; /* may be taken off or added */
            const WG_REAL roundings = WG_C(2.0) * WG_EPSILON * (turn + WG_ABS(q[j]));
            tried.q[j] = slope > WG_C(0.0) ? q[j] - roundings : slope < WG_C(0.0) ? q[j] + roundings : q[j];
        }
        WG_NAME(wg_serial_at)(chart->arm, &tried);
        firm = tried.gap < WG_INFINITY;
    }
    return firm;
}

/* From the chart's stance back to q, roots at their last bound made smaller if that leads nearer; whether there is a foot. */
static inline int WG_NAME(wg_chart_left)(const struct WG_NAME(wg_chart) * chart, const struct WG_NAME(wg_arm_state) * here,
                                         const WG_REAL *levels, struct WG_NAME(wg_arm_state) * at) {
    WG_REAL y[WG_MOST_JOINTS], motion[WG_MOST_MOTION];
    struct WG_NAME(wg_arm_state) tried;
    int j, k, i, found = 0;
    at->gap = WG_INFINITY;
    for (i = 2; i < 7; ++i) {
        for (j = 0; j < chart->arm->n; ++j) {
            y[j] = here->q[j];
        }
        for (k = 0; k < chart->count; ++k) {
            j = chart->joint[k];
            y[j] = y[j] <= levels[2] ? levels[i] : y[j];
        }
        if (!WG_NAME(wg_chart_pose)(chart, y, tried.q, motion)) {
            continue;
        }
        for (j = 0; j < chart->arm->n; ++j) {
            tried.q[j] = WG_MIN(WG_MAX(tried.q[j], chart->box->low[j]), chart->box->high[j]);
        }
        WG_NAME(wg_serial_at)(chart->arm, &tried);
        if (tried.gap < at->gap && (i == 2 || WG_NAME(wg_chart_firm)(chart, tried.q, motion))) {
            *at = tried;
            found = 1;
        }
    }
    return found;
}

/* Lead at->q, near where loops cease to close, to rest there or elsewhere, by at most eight charts: whether it gets there. */
static inline int WG_NAME(wg_along_edges)(const struct WG_NAME(wg_serial) * arm, const struct WG_NAME(wg_box) * box,
                                          struct WG_NAME(wg_arm_state) * at) {
    struct WG_NAME(wg_arm_state) here, found;
    struct WG_NAME(wg_chart) chart;
    struct WG_NAME(wg_serial) charted;
    struct WG_NAME(wg_box) bounds;
    const WG_REAL levels[7] = WG_LEVELS;
    WG_REAL motion[WG_MOST_MOTION];
    int i, k, rests, tired[WG_MOST_JOINTS] = {0};
    for (i = 0; i < WG_CHARTS; ++i) {
        if (!WG_NAME(wg_driven_foot_at)(arm->motion, arm->data, arm->edges, arm->n, arm->slides, arm->size, at->q, motion)) {
            return 0;
        }
        WG_NAME(wg_chart_at)(arm, box, at->q, motion, tired, &chart);
        WG_NAME(wg_chart_arm)(&chart, motion, levels[0], &charted, &bounds, &here);
        WG_NAME(wg_serial_at)(&charted, &here);
        if (chart.count == 0 || !(here.gap < WG_INFINITY)) {
            return 0;
        }
        rests = WG_NAME(wg_chart_rest)(&chart, &charted, levels, &bounds, &here);
        if (WG_NAME(wg_chart_left)(&chart, &here, levels, &found) && (rests || found.gap < at->gap)) {
            *at = found;
            if (rests) {
                return 1;
            }
        }
        for (k = 0; k < arm->n; ++k) {
            tired[k] = 0;
        }
        for (k = 0; k < chart.count; ++k) { /* the chart ends for its joints */
            tired[chart.joint[k]] = 1;
        }
    }
    return 0;
}

#undef WG_LEVELS
#endif
