/* walkgen_triads.h: what closes the triads of a linkage, continued from a known assembly; for the macros see walkgen_math.h.
 *
 * The unknowns u are roots of a closure r(z, u) = 0, where z are drives and parameters. From the start (z0, u0) the drives go straight to
 * their values, z0 + s (z - z0) with s from 0 to 1, and u with them: the first try is the whole way in one step. A step is taken where
 * Newton's method converges at once (its first correction is short, each is at most half of the one before), where the determinant of
 * dr/du, which changes its sign at a dead point, stays near what it was, and where one correction leads about there and one back, as they do not
 * between assemblies on both sides of a dead point; and where it is much the same halfway, as it is not where the linkage comes to a dead point and
 * back. Else it is cut to a quarter. The guess after the first step is the secant's. So the result is the assembly that the linkage moves to from
 * the start without passing a dead point, or none.
 *
 * A slider that runs off to infinity ends this early: far out, one over its way u + u^3 / 16 goes to 0 in proportion to the part. Where it has done so for three
 * halvings and is 0 before the end of the way, the way leads beyond infinity.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_TRIADS_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_TRIADS_F32))
#ifndef WG_MOST_UNKNOWNS
#define WG_MOST_UNKNOWNS 8
#define WG_MOST_OF_POINT 128
#define WG_FAR_OUT WG_C(6.0)
#define WG_STEADY WG_C(0.02)
#endif
#if WG_REAL_BITS == 64
#define WALKGEN_TRIADS_F64
#define WG_ROUGH WG_C(1e-4)
#define WG_FINE WG_C(1e-10)
#define WG_LEAST_PART WG_C(1e-8)
#define WG_AT_THE_END WG_C(1e-6)
#else
#define WALKGEN_TRIADS_F32
#define WG_ROUGH WG_C(1e-3)
#define WG_FINE WG_C(3e-6)
#define WG_LEAST_PART WG_C(1e-4)
#define WG_AT_THE_END WG_C(1e-3)
#endif

/* r [n], then dr/du [n][n], at a point: z, then u [n]. */
typedef void (*WG_NAME(wg_closure))(const WG_REAL *point, WG_REAL *closure, const void *data);

/* The closure, where it starts, where it goes, and how far it is: part, u and the determinant there. */
struct WG_NAME(wg_triads_way) {
    WG_NAME(wg_closure) closure;
    const void *data;
    const WG_REAL *from, *to;
    int given, unknowns;
    WG_REAL part, u[WG_MOST_UNKNOWNS], determinant;
};

/* M x = b for M [n][n]; both are lost, b becomes x. The determinant, 0 where there is no x. */
static inline WG_REAL WG_NAME(wg_triads_eliminate)(int n, WG_REAL *M, WG_REAL *b) {
    WG_REAL determinant = WG_C(1.0);
    int i, j, k;
    for (k = 0; k < n; ++k) {
        int best = k;
        for (i = k + 1; i < n; ++i) {
            best = WG_ABS(M[n * i + k]) > WG_ABS(M[n * best + k]) ? i : best;
        }
        if (!(WG_ABS(M[n * best + k]) > WG_C(0.0))) {
            return WG_C(0.0);
        }
        if (best != k) {
            const WG_REAL own = b[k];
            b[k] = b[best];
            b[best] = own;
            for (j = 0; j < n; ++j) {
                const WG_REAL entry = M[n * k + j];
                M[n * k + j] = M[n * best + j];
                M[n * best + j] = entry;
            }
            determinant = -determinant;
        }
        determinant *= M[n * k + k];
        for (i = k + 1; i < n; ++i) {
            const WG_REAL factor = M[n * i + k] / M[n * k + k];
            for (j = k; j < n; ++j) {
                M[n * i + j] -= factor * M[n * k + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for (i = n - 1; i >= 0; --i) {
        for (j = i + 1; j < n; ++j) {
            b[i] -= M[n * i + j] * b[j];
        }
        b[i] /= M[n * i + i];
    }
    return determinant;
}

/* One of Newton's corrections [n] at a part of the way, to be taken off u, and the determinant, 0 where there is none. */
static inline WG_REAL WG_NAME(wg_triads_correction)(const struct WG_NAME(wg_triads_way) * linkage, WG_REAL part, const WG_REAL *u,
                                                    WG_REAL *correction) {
    WG_REAL point[WG_MOST_OF_POINT], closure[WG_MOST_UNKNOWNS * (WG_MOST_UNKNOWNS + 1)], determinant;
    const int n = linkage->unknowns;
    int i;
    for (i = 0; i < linkage->given; ++i) {
        point[i] = part < WG_C(1.0) ? linkage->from[i] + part * (linkage->to[i] - linkage->from[i]) : linkage->to[i];
    }
    for (i = 0; i < n; ++i) {
        point[linkage->given + i] = u[i];
    }
    linkage->closure(point, closure, linkage->data);
    determinant = WG_NAME(wg_triads_eliminate)(n, closure + n, closure);
    for (i = 0; i < n; ++i) {
        correction[i] = closure[i];
    }
    return determinant;
}

/* Newton's method from u at a part of the way; 1 where it converges at once, with the determinant met last. */
static inline int WG_NAME(wg_triads_newton)(const struct WG_NAME(wg_triads_way) * linkage, WG_REAL part, WG_REAL close, WG_REAL *u,
                                              WG_REAL *determinant) {
    WG_REAL correction[WG_MOST_UNKNOWNS], last = WG_C(0.5);
    int turn, i;
    for (turn = 0; turn < 16; ++turn) {
        WG_REAL step = WG_C(0.0);
        *determinant = WG_NAME(wg_triads_correction)(linkage, part, u, correction);
        for (i = 0; i < linkage->unknowns; ++i) {
            step = WG_ABS(correction[i]) <= step ? step : WG_ABS(correction[i]);
            u[i] -= correction[i];
        }
        if (!(WG_ABS(*determinant) > WG_C(0.0)) || !(step <= WG_C(0.5) * last || step <= close)) {
            return 0;
        }
        if (step <= close) {
            return 1;
        }
        last = step;
    }
    return 0;
}

/* Whether a determinant is near another. */
static inline int WG_NAME(wg_triads_alike)(WG_REAL determinant, WG_REAL other) {
    const WG_REAL ratio = determinant / other;
    return ratio >= WG_C(0.4) && ratio <= WG_C(2.5);
}

/* Whether a correction of unknowns at a part of the way leads to others: it leaves at most half of the change. */
static inline int WG_NAME(wg_triads_leads)(const struct WG_NAME(wg_triads_way) * linkage, WG_REAL part, const WG_REAL *from, const WG_REAL *to,
                                           WG_REAL change, WG_REAL *determinant) {
    WG_REAL correction[WG_MOST_UNKNOWNS];
    int i, leads;
    *determinant = WG_NAME(wg_triads_correction)(linkage, part, from, correction);
    leads = WG_ABS(*determinant) > WG_C(0.0);
    for (i = 0; i < linkage->unknowns; ++i) {
        leads = leads && WG_ABS(from[i] - correction[i] - to[i]) <= WG_C(0.5) * change + WG_ROUGH;
    }
    return leads;
}

/* Whether the linkage gets from part to part, where its unknowns are u, which change so much. */
static inline int WG_NAME(wg_triads_passes)(const struct WG_NAME(wg_triads_way) * linkage, WG_REAL part, WG_REAL next, const WG_REAL *u,
                                            WG_REAL determinant, WG_REAL change) {
    WG_REAL middle[WG_MOST_UNKNOWNS], between;
    int i;
    for (i = 0; i < linkage->unknowns; ++i) {
        middle[i] = linkage->u[i] + WG_C(0.5) * (u[i] - linkage->u[i]);
    }
    return WG_NAME(wg_triads_leads)(linkage, part, u, linkage->u, change, &between) &&
           WG_NAME(wg_triads_leads)(linkage, next, linkage->u, u, change, &between) &&
           WG_NAME(wg_triads_leads)(linkage, part + WG_C(0.5) * (next - part), middle, middle, change, &between) &&
           WG_NAME(wg_triads_alike)(between, linkage->determinant) && WG_NAME(wg_triads_alike)(between, determinant);
}

/* One step from part to part, whose guess changes u by `slope` per part; 1 where it is taken. */
static inline int WG_NAME(wg_triads_step)(struct WG_NAME(wg_triads_way) * linkage, WG_REAL part, WG_REAL next, WG_REAL *slope) {
    WG_REAL u[WG_MOST_UNKNOWNS], determinant, change = WG_C(0.0);
    int i;
    for (i = 0; i < linkage->unknowns; ++i) {
        u[i] = linkage->u[i] + (next - part) * slope[i];
    }
    if (!WG_NAME(wg_triads_newton)(linkage, next, next < WG_C(1.0) ? WG_ROUGH : WG_FINE, u, &determinant)) {
        return 0;
    }
    for (i = 0; i < linkage->unknowns; ++i) {
        change = WG_MAX(WG_ABS(u[i] - linkage->u[i]), change);
    }
    if (!(change <= WG_C(0.5)) || !WG_NAME(wg_triads_alike)(determinant, linkage->determinant) ||
        !WG_NAME(wg_triads_passes)(linkage, part, next, u, determinant, change)) {
        return 0;
    }
    for (i = 0; i < linkage->unknowns; ++i) {
        slope[i] = (u[i] - linkage->u[i]) / (next - part);
        linkage->u[i] = u[i];
    }
    linkage->determinant = determinant;
    return 1;
}

/* How the farthest unknown went out: which, at which part one over its way was halved last, how fast it fell, and for how many halvings alike. */
struct WG_NAME(wg_triads_flight) {
    int unknown, alike;
    WG_REAL part, inverse, rate;
};

/* Whether the farthest unknown runs off to infinity before the end of the way. */
static inline int WG_NAME(wg_triads_runs_off)(const struct WG_NAME(wg_triads_way) * linkage, struct WG_NAME(wg_triads_flight) * flight) {
    WG_REAL inverse, rate;
    int i, far = 0;
    for (i = 1; i < linkage->unknowns; ++i) {
        far = WG_ABS(linkage->u[i]) > WG_ABS(linkage->u[far]) ? i : far;
    }
    if (!(WG_ABS(linkage->u[far]) > WG_FAR_OUT)) {
        flight->unknown = -1;
        return 0;
    }
    inverse = WG_C(1.0) / (linkage->u[far] * (WG_C(16.0) + linkage->u[far] * linkage->u[far])); /* of 16 times the way in sizes */
    if (flight->unknown != far || !(inverse / flight->inverse <= WG_C(1.0))) {
        flight->unknown = far;
        flight->alike = 0;
        flight->rate = WG_C(0.0);
    } else if (inverse / flight->inverse <= WG_C(0.5)) {
        rate = (flight->inverse - inverse) / (linkage->part - flight->part);
        flight->alike = WG_ABS(rate - flight->rate) <= WG_STEADY * WG_ABS(rate) ? flight->alike + 1 : 0;
        flight->rate = rate;
    } else {
        return 0;
    }
    flight->part = linkage->part;
    flight->inverse = inverse;
    return flight->alike >= 2 && linkage->part + WG_C(1.25) * inverse / flight->rate < WG_C(1.0);
}

/* From the start to the drives. */
static inline int32_t WG_NAME(wg_triads_move)(struct WG_NAME(wg_triads_way) * linkage) {
    struct WG_NAME(wg_triads_flight) flight = {-1, 0, WG_C(0.0), WG_C(0.0), WG_C(0.0)};
    WG_REAL length = WG_C(1.0), slope[WG_MOST_UNKNOWNS];
    int turn, i;
    if (!WG_NAME(wg_triads_newton)(linkage, linkage->part, WG_ROUGH, linkage->u, &linkage->determinant)) {
        return WALKGEN_NO_CONVERGENCE;
    }
    for (i = 0; i < linkage->unknowns; ++i) {
        slope[i] = WG_C(0.0);
    }
    for (turn = 0; turn < 400; ++turn) {
        const WG_REAL next = WG_MIN(linkage->part + length, WG_C(1.0));
        if (WG_NAME(wg_triads_step)(linkage, linkage->part, next, slope)) {
            length = WG_C(2.0) * (next - linkage->part);
            linkage->part = next;
            if (next < WG_C(1.0) && WG_NAME(wg_triads_runs_off)(linkage, &flight)) {
                return WALKGEN_NO_CONVERGENCE;
            }
        } else {
            length = WG_C(0.25) * (next - linkage->part);
        }
        if (!(linkage->part < WG_C(1.0))) {
            return WALKGEN_OK;
        }
        if (length < WG_LEAST_PART) {
            return linkage->part > WG_C(1.0) - WG_AT_THE_END ? WALKGEN_SINGULAR : WALKGEN_UNREACHABLE;
        }
    }
    return WALKGEN_NO_CONVERGENCE;
}

/* How far a linkage comes from its start on the straight way to z, and the unknowns of its triads there.
 *
 * given        how many drives (or coordinates of a foot that is held) and parameters there are; with the unknowns at most 128
 * unknowns     how many, at most 8
 * z            [given] drives and parameters
 * start        [given + unknowns] a point where the linkage is assembled
 * reached      [given] z where the status is OK, else where the linkage comes to a dead point
 * u            [unknowns] there; both are NaN with BAD_INPUT
 * status       OK; UNREACHABLE: on the way the linkage comes to a dead point, or something before the triads does not assemble; SINGULAR:
 *              z is such a point; NO_CONVERGENCE: the start is no assembly, a slider runs off to infinity, or 400 steps were not enough;
 *              BAD_INPUT: z is not finite
 */
static inline void WG_NAME(wg_approach)(int32_t given, int32_t unknowns, const WG_REAL *z, const WG_REAL *start, WG_NAME(wg_closure) closure,
                                        const void *data, WG_REAL *reached, WG_REAL *u, int32_t *status) {
    struct WG_NAME(wg_triads_way) linkage;
    int i, fine = given >= 0 && unknowns > 0 && unknowns <= WG_MOST_UNKNOWNS && given + unknowns <= WG_MOST_OF_POINT;
    *status = WALKGEN_BAD_INPUT;
    for (i = 0; fine && i < given; ++i) {
        fine = isfinite(z[i]) != 0;
    }
    if (fine) {
        linkage.closure = closure;
        linkage.data = data;
        linkage.from = start;
        linkage.to = z;
        linkage.given = given;
        linkage.unknowns = unknowns;
        linkage.part = WG_C(0.0);
        linkage.determinant = WG_C(0.0);
        for (i = 0; i < unknowns; ++i) {
            linkage.u[i] = start[given + i];
        }
        *status = WG_NAME(wg_triads_move)(&linkage);
    }
    for (i = 0; i < given; ++i) {
        reached[i] = !fine ? WG_NAN : linkage.part < WG_C(1.0) ? start[i] + linkage.part * (z[i] - start[i]) : z[i];
    }
    for (i = 0; i < unknowns; ++i) {
        u[i] = fine ? linkage.u[i] : WG_NAN;
    }
}

/* The unknowns of a linkage's triads for its drives: the assembly that the start moves to. As wg_approach, but u is NaN unless the status
 * is OK.
 */
static inline void WG_NAME(wg_close_triads)(int32_t given, int32_t unknowns, const WG_REAL *z, const WG_REAL *start,
                                            WG_NAME(wg_closure) closure, const void *data, WG_REAL *u, int32_t *status) {
    WG_REAL reached[WG_MOST_OF_POINT];
    int i;
    WG_NAME(wg_approach)(given, unknowns, z, start, closure, data, reached, u, status);
    for (i = 0; i < unknowns; ++i) {
        u[i] = *status == WALKGEN_OK ? u[i] : WG_NAN;
    }
}

#undef WG_ROUGH
#undef WG_FINE
#undef WG_LEAST_PART
#undef WG_AT_THE_END
#endif
