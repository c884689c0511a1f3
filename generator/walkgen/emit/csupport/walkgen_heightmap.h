/* walkgen_heightmap.h: a surface through heights on a square grid, bilinear or bicubic, and its point nearest to another; walkgen_math.h
 * explains the macros.
 *
 * heights [rows, columns], row after row: y grows from row to row, x from column to column, grid = (x, y of the first height, spacing).
 * There are two rows and two columns at least. Bicubic is Catmull-Rom in both directions: slopes at the points are central differences, beside
 * the edge those of a parabola through three points, so slopes are continuous and parabolas are met exactly. Beyond the grid the cells
 * at its edge go on. Bounded: one cell for a height, at most WG_HEIGHTMAP_STEPS for a nearest point.
 */
#include "walkgen_math.h"
#include "walkgen_status.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_HEIGHTMAP_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_HEIGHTMAP_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_HEIGHTMAP_F64
#else
#define WALKGEN_HEIGHTMAP_F32
#endif
#define WG_HEIGHTMAP_STEPS 60

/* What the four points about a cell count for the value, the slope and the second derivative over one direction, in spacings; `first` is the
 * index of their first. Points that the grid does not have count nothing: what they would is shared out among those that it has. */
static inline void WG_NAME(wg_heightmap_weights)(WG_REAL place, int32_t count, int32_t bicubic, int32_t *first, WG_REAL weights[3][4]) {
    const WG_REAL last = (WG_REAL)(count - 2), whole = place < last ? place : last;
    const int32_t cell = whole > WG_C(0.0) ? (int32_t)whole : 0;
    const WG_REAL t = place - (WG_REAL)cell, s = WG_C(1.0) - t;
    const WG_REAL linear[3][4] = {
        {WG_C(0.0), s, t, WG_C(0.0)},
        {WG_C(0.0), WG_C(-1.0), WG_C(1.0), WG_C(0.0)},
        {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)},
    };
    const WG_REAL cubic[3][4] = {
        {WG_C(-0.5) * t * s * s, WG_C(1.0) + t * t * (WG_C(1.5) * t - WG_C(2.5)), WG_C(1.0) + s * s * (WG_C(1.5) * s - WG_C(2.5)),
         WG_C(-0.5) * s * t * t},
        {s * (WG_C(1.5) * t - WG_C(0.5)), t * (WG_C(4.5) * t - WG_C(5.0)), s * (WG_C(5.0) - WG_C(4.5) * s), t * (WG_C(1.5) * t - WG_C(1.0))},
        {WG_C(2.0) - WG_C(3.0) * t, WG_C(9.0) * t - WG_C(5.0), WG_C(9.0) * s - WG_C(5.0), WG_C(2.0) - WG_C(3.0) * s},
    };
    int order, i;
    *first = cell - 1;
    for (order = 0; order < 3; ++order) {
        WG_REAL *w = weights[order];
        for (i = 0; i < 4; ++i) {
            w[i] = bicubic ? cubic[order][i] : linear[order][i];
        }
        if (cell == 0) { /* f(-1) = 3 f(0) - 3 f(1) + f(2); of two points 2 f(0) - f(1) */
            w[1] += (count > 2 ? WG_C(3.0) : WG_C(2.0)) * w[0];
            w[2] -= (count > 2 ? WG_C(3.0) : WG_C(1.0)) * w[0];
            w[3] += count > 2 ? w[0] : WG_C(0.0);
            w[0] = WG_C(0.0);
        }
        if (cell == count - 2) {
            w[2] += (count > 2 ? WG_C(3.0) : WG_C(2.0)) * w[3];
            w[1] -= (count > 2 ? WG_C(3.0) : WG_C(1.0)) * w[3];
            w[0] += count > 2 ? w[3] : WG_C(0.0);
            w[3] = WG_C(0.0);
        }
    }
}

/* Height over p (x and y of it) and its derivatives x, y, xx, xy, yy: jet [6]; NaN where p is not finite or the spacing is not positive. */
static inline void WG_NAME(wg_heightmap)(const WG_REAL *WG_RESTRICT heights, int32_t rows, int32_t columns, int32_t bicubic,
                                         const WG_REAL *WG_RESTRICT grid, const WG_REAL *WG_RESTRICT p, WG_REAL *WG_RESTRICT jet) {
    static const int along[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    const WG_REAL x = (p[0] - grid[0]) / grid[2], y = (p[1] - grid[1]) / grid[2];
    const int fine = isfinite(x) && isfinite(y) && grid[2] > WG_C(0.0);
    WG_REAL wx[3][4], wy[3][4];
    int32_t column, row, i, j;
    int entry;
    WG_NAME(wg_heightmap_weights)(fine ? x : WG_C(0.0), columns, bicubic, &column, wx);
    WG_NAME(wg_heightmap_weights)(fine ? y : WG_C(0.0), rows, bicubic, &row, wy);
    for (entry = 0; entry < 6; ++entry) {
        jet[entry] = fine ? WG_C(0.0) : WG_NAN;
    }
    for (i = 0; i < 4 && fine; ++i) {
        const int32_t line = row + i < 0 ? 0 : row + i < rows ? row + i : rows - 1;
        for (j = 0; j < 4; ++j) {
            const int32_t spot = column + j < 0 ? 0 : column + j < columns ? column + j : columns - 1;
            const WG_REAL height = heights[line * columns + spot];
            for (entry = 0; entry < 6; ++entry) {
                jet[entry] += wy[along[entry][1]][i] * wx[along[entry][0]][j] * height;
            }
        }
    }
    for (entry = 1; entry < 6; ++entry) {
        jet[entry] /= entry < 3 ? grid[2] : grid[2] * grid[2];
    }
}

/* Half the gradient of the squared distance from p to the surface over (x, y), and the step that Newton's method takes from there, that of
 * Gauss and Newton where the distance is not convex, damped by lambda. Returns whether the gradient is nothing beside the distances. */
static inline int WG_NAME(wg_heightmap_step)(const WG_REAL jet[6], const WG_REAL *at, const WG_REAL *p, WG_REAL lambda, WG_REAL step[2]) {
    const WG_REAL x = at[0] - p[0], y = at[1] - p[1], z = jet[0] - p[2];
    const WG_REAL gx = x + jet[1] * z, gy = y + jet[2] * z;
    const WG_REAL axx = WG_C(1.0) + jet[1] * jet[1], axy = jet[1] * jet[2], ayy = WG_C(1.0) + jet[2] * jet[2];
    const WG_REAL nxx = axx + jet[3] * z, nxy = axy + jet[4] * z, nyy = ayy + jet[5] * z;
    const int convex = nxx > WG_C(0.0) && nyy > WG_C(0.0) && nxx * nyy - nxy * nxy > WG_C(1e-4) * nxx * nyy;
    const WG_REAL hxx = (convex ? nxx : axx) + lambda * axx, hxy = convex ? nxy : axy, hyy = (convex ? nyy : ayy) + lambda * ayy;
    const WG_REAL det = hxx * hyy - hxy * hxy;
    const WG_REAL size = WG_C(1.0) + WG_ABS(p[0]) + WG_ABS(p[1]) + WG_ABS(p[2]) + WG_ABS(jet[0]);
    const WG_REAL slack = WG_C(1e-9) < WG_C(64.0) * WG_EPSILON ? WG_C(64.0) * WG_EPSILON : WG_C(1e-9);
    step[0] = (hxy * gy - hyy * gx) / det;
    step[1] = (hxy * gx - hxx * gy) / det;
    return gx * gx / axx + gy * gy / ayy <= slack * slack * size * size;
}

/* The squared distance of p from the surface over (x, y). */
static inline WG_REAL WG_NAME(wg_heightmap_distance)(const WG_REAL jet[6], const WG_REAL *at, const WG_REAL *p) {
    const WG_REAL x = at[0] - p[0], y = at[1] - p[1], z = jet[0] - p[2];
    return x * x + y * y + z * z;
}

/* The point of the surface nearest to p that descent from under p reaches: foot [3], OK; NO_CONVERGENCE where the last step was not small (a
 * bilinear map's crease), BAD_INPUT and NaN where p is not finite. */
static inline void WG_NAME(wg_heightmap_project)(const WG_REAL *WG_RESTRICT heights, int32_t rows, int32_t columns, int32_t bicubic,
                                                 const WG_REAL *WG_RESTRICT grid, const WG_REAL *WG_RESTRICT p, WG_REAL *WG_RESTRICT foot,
                                                 int32_t *WG_RESTRICT status) {
    WG_REAL at[2], jet[6], step[2], lambda = WG_C(1e-3);
    int turn, close, fine;
    at[0] = p[0];
    at[1] = p[1];
    WG_NAME(wg_heightmap)(heights, rows, columns, bicubic, grid, at, jet);
    fine = isfinite(jet[0]) && isfinite(p[2]);
    close = WG_NAME(wg_heightmap_step)(jet, at, p, lambda, step);
    for (turn = 0; turn < WG_HEIGHTMAP_STEPS && fine; ++turn) {
        const WG_REAL now = WG_NAME(wg_heightmap_distance)(jet, at, p);
        WG_REAL next[2], ahead[6];
        next[0] = at[0] + step[0];
        next[1] = at[1] + step[1];
        WG_NAME(wg_heightmap)(heights, rows, columns, bicubic, grid, next, ahead);
        if (WG_NAME(wg_heightmap_distance)(ahead, next, p) <= now + WG_C(8.0) * WG_EPSILON * now) {
            int i;
            at[0] = next[0];
            at[1] = next[1];
            for (i = 0; i < 6; ++i) {
                jet[i] = ahead[i];
            }
            lambda = lambda > WG_EPSILON ? lambda * WG_C(0.125) : WG_C(0.0);
            if (close) {
                break; /* one step beyond the bound, which is as good as rounding lets it be */
            }
        } else {
            lambda = lambda > WG_C(1e-3) ? lambda * WG_C(8.0) : WG_C(1e-2);
            if (close) {
                break;
            }
        }
        close = WG_NAME(wg_heightmap_step)(jet, at, p, lambda, step);
    }
    close = close && WG_NAME(wg_heightmap_step)(jet, at, p, lambda, step);
    foot[0] = fine ? at[0] : WG_NAN;
    foot[1] = fine ? at[1] : WG_NAN;
    foot[2] = fine ? jet[0] : WG_NAN;
    *status = !fine ? WALKGEN_BAD_INPUT : close && isfinite(jet[0]) ? WALKGEN_OK : WALKGEN_NO_CONVERGENCE;
}

#undef WG_HEIGHTMAP_STEPS
#endif
