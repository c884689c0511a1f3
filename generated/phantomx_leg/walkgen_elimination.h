/* walkgen_elimination.h: poses of a three-joint leg that reach a target, down to one unknown; walkgen_math.h explains the macros.
 *
 * Let x be the foot moved by joints 2 and 3 alone, g by joint 3 alone, seen from axis 2. What joint 1 cannot change of x is known from the
 * target, what joint 2 cannot change of it from g. Both leave a plane vector y (x across axis 2; across axis 1 where joint 2 slides) with
 *     M y = k(q3),    |y|^2 = r^2(q3),    M constant;  k = c + w . g + e |g|^2,  r^2 = r0^2 + (|g|^2 - (z2 . g)^2 where joint 2 turns)
 * With the singular values s1 >= |s2| of M and y, k along its singular directions, y = (k1 / s1, y2) and
 *     F(q3) = k2^2 - s2^2 (r^2 - (k1 / s1)^2) = 0,    y2 = k2 / s2
 * is a quartic in tan(q3 / 2), a quadratic in a sliding q3. Where s2 = 0 (axes that meet or are parallel) it is the square of k2 = 0, which
 * is then solved instead, and y2 takes both signs; where s2 is small both are solved, for neither alone would be well conditioned.
 * Three turning joints: Pieper 1968.
 */
#include "walkgen_quartic.h"
#include "walkgen_spatial.h"

#if (WG_REAL_BITS == 64 && !defined(WALKGEN_ELIMINATION_F64)) || (WG_REAL_BITS == 32 && !defined(WALKGEN_ELIMINATION_F32))
#if WG_REAL_BITS == 64
#define WALKGEN_ELIMINATION_F64
#define WG_TOUCHING WG_C(1e-9)
#define WG_NONE WG_C(1e-13)
#define WG_SMALL WG_C(1e-2)
#else
#define WALKGEN_ELIMINATION_F32
#define WG_TOUCHING WG_C(1e-4)
#define WG_NONE WG_C(1e-6)
#define WG_SMALL WG_C(1e-1)
#endif

struct WG_NAME(wg_elimination) {
    const struct WG_NAME(wg_chain) * chain;
    WG_REAL target[3], c[2], w[2][3], e[2], s1, s2, y[2][3], r0; /* r0 is r0^2 */
};

/* What depends on q3: g, k and r^2. */
struct WG_NAME(wg_terms) {
    WG_REAL g[3], k[2], square;
};

/* The rows b of the equations b . x = known, and their terms, before they are made orthogonal: the axis that y is across. */
static inline const WG_REAL *WG_NAME(wg_equations)(struct WG_NAME(wg_elimination) * system, WG_REAL rows[2][3]) {
    const struct WG_NAME(wg_chain) *chain = system->chain;
    const WG_REAL *z1 = chain->axis[0], *z2 = chain->axis[1];
    WG_REAL away[3], between[3], beyond[3];
    int i;
    WG_NAME(wg_add)(system->target, WG_C(-1.0), chain->point[0], away);
    WG_NAME(wg_add)(system->target, WG_C(-1.0), chain->point[1], beyond);
    WG_NAME(wg_add)(chain->point[1], WG_C(-1.0), chain->point[0], between);
    system->e[0] = system->e[1] = system->r0 = WG_C(0.0);
    if (chain->slides[1]) {
        const WG_REAL height = WG_NAME(wg_dot)(z1, away);
        WG_NAME(wg_across)(z2, rows[0], rows[1]);
        for (i = 0; i < 2; ++i) {
            system->c[i] = WG_NAME(wg_dot)(rows[i], between) - height * WG_NAME(wg_dot)(rows[i], z1);
            WG_NAME(wg_add)(rows[i], WG_C(0.0), z1, system->w[i]);
        }
        system->r0 = WG_NAME(wg_dot)(away, away) - height * height;
        return z1;
    }
    if (chain->slides[0]) {
        WG_NAME(wg_across)(z1, rows[0], rows[1]);
        system->c[0] = WG_NAME(wg_dot)(rows[0], beyond);
        system->c[1] = WG_NAME(wg_dot)(rows[1], beyond);
    } else {
        WG_NAME(wg_add)(z1, WG_C(0.0), z1, rows[0]);
        WG_NAME(wg_add)(between, WG_C(0.0), z1, rows[1]);
        system->c[0] = WG_NAME(wg_dot)(z1, beyond);
        system->c[1] = WG_C(0.5) * (WG_NAME(wg_dot)(away, away) - WG_NAME(wg_dot)(between, between));
        system->e[1] = WG_C(-0.5);
    }
    for (i = 0; i < 6; ++i) {
        system->w[i / 3][i % 3] = -WG_NAME(wg_dot)(rows[i / 3], z2) * z2[i % 3];
    }
    return z2;
}

/* (a, b) turned so that the rows of M are orthogonal. */
static inline void WG_NAME(wg_mix)(WG_REAL cosine, WG_REAL sine, WG_REAL *a, WG_REAL *b) {
    const WG_REAL first = cosine * *a + sine * *b;
    *b = cosine * *b - sine * *a;
    *a = first;
}

/* Set the equations up; joints 1 and 2 do not both slide. */
static inline void WG_NAME(wg_eliminate)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3],
                                         struct WG_NAME(wg_elimination) * system) {
    WG_REAL rows[2][3], angle, cosine, sine, unused[3];
    const WG_REAL *normal;
    int i;
    system->chain = chain;
    WG_NAME(wg_add)(target, WG_C(0.0), target, system->target);
    normal = WG_NAME(wg_equations)(system, rows);
    for (i = 0; i < 2; ++i) {
        WG_NAME(wg_add)(rows[i], -WG_NAME(wg_dot)(rows[i], normal), normal, rows[i]);
    }
    angle = WG_C(0.5) * WG_ATAN2(WG_C(2.0) * WG_NAME(wg_dot)(rows[0], rows[1]),
                                 WG_NAME(wg_dot)(rows[0], rows[0]) - WG_NAME(wg_dot)(rows[1], rows[1]));
    cosine = WG_COS(angle);
    sine = WG_SIN(angle);
    WG_NAME(wg_mix)(cosine, sine, &system->c[0], &system->c[1]);
    WG_NAME(wg_mix)(cosine, sine, &system->e[0], &system->e[1]);
    for (i = 0; i < 3; ++i) {
        WG_NAME(wg_mix)(cosine, sine, &rows[0][i], &rows[1][i]);
        WG_NAME(wg_mix)(cosine, sine, &system->w[0][i], &system->w[1][i]);
    }
    system->s1 = WG_NAME(wg_norm)(rows[0]);
    WG_NAME(wg_across)(normal, system->y[0], unused);
    for (i = 0; i < 3 && system->s1 >= WG_NONE; ++i) {
        system->y[0][i] = rows[0][i] / system->s1;
    }
    WG_NAME(wg_cross)(normal, system->y[0], system->y[1]);
    system->s2 = WG_NAME(wg_dot)(rows[1], system->y[1]);
}

static inline void WG_NAME(wg_terms_at)(const struct WG_NAME(wg_elimination) * system, WG_REAL q3, struct WG_NAME(wg_terms) * terms) {
    const struct WG_NAME(wg_chain) *chain = system->chain;
    WG_REAL square, along;
    int i;
    WG_NAME(wg_add)(chain->foot, WG_C(0.0), chain->foot, terms->g);
    WG_NAME(wg_moved)(chain, 2, q3, terms->g);
    WG_NAME(wg_add)(terms->g, WG_C(-1.0), chain->point[1], terms->g);
    square = WG_NAME(wg_dot)(terms->g, terms->g);
    along = WG_NAME(wg_dot)(chain->axis[1], terms->g);
    for (i = 0; i < 2; ++i) {
        terms->k[i] = system->c[i] + WG_NAME(wg_dot)(system->w[i], terms->g) + system->e[i] * square;
    }
    terms->square = system->r0 + (chain->slides[1] ? WG_C(0.0) : square - along * along);
}

/* F, or k2 where that is asked for; where axes 1 and 2 are one, nothing is left of y but its length. */
static inline WG_REAL WG_NAME(wg_left_over)(const struct WG_NAME(wg_elimination) * system, int plain, WG_REAL q3) {
    struct WG_NAME(wg_terms) terms;
    WG_NAME(wg_terms_at)(system, q3, &terms);
    if (plain) {
        return terms.k[1];
    }
    if (system->s1 < WG_NONE) {
        return terms.k[0] * terms.k[0] + terms.k[1] * terms.k[1];
    }
    return terms.k[1] * terms.k[1] -
           system->s2 * system->s2 * (terms.square - (terms.k[0] / system->s1) * (terms.k[0] / system->s1));
}

/* q with this sign of y2, or with y2 = k2 / s2 where that is well conditioned. */
static inline void WG_NAME(wg_pose)(const struct WG_NAME(wg_elimination) * system, WG_REAL q3, WG_REAL sign, WG_REAL q[3]) {
    const struct WG_NAME(wg_chain) *chain = system->chain;
    const WG_REAL *z1 = chain->axis[0], *z2 = chain->axis[1];
    struct WG_NAME(wg_terms) terms;
    WG_REAL y[3], x[3], away[3], first, second;
    int i;
    WG_NAME(wg_terms_at)(system, q3, &terms);
    first = system->s1 < WG_NONE ? WG_SQRT(WG_MAX(terms.square, WG_C(0.0))) : terms.k[0] / system->s1;
    second = WG_ABS(system->s2) >= WG_SMALL ? terms.k[1] / system->s2 : sign * WG_SQRT(WG_MAX(terms.square - first * first, WG_C(0.0)));
    for (i = 0; i < 3; ++i) {
        y[i] = first * system->y[0][i] + second * system->y[1][i];
    }
    WG_NAME(wg_add)(system->target, WG_C(-1.0), chain->point[0], away);
    if (chain->slides[1]) {
        WG_NAME(wg_add)(y, WG_NAME(wg_dot)(z1, away), z1, x);
        WG_NAME(wg_add)(x, WG_C(1.0), chain->point[0], x);
        q[1] = WG_NAME(wg_dot)(z2, x) - WG_NAME(wg_dot)(z2, terms.g) - WG_NAME(wg_dot)(z2, chain->point[1]);
    } else {
        WG_NAME(wg_add)(y, WG_NAME(wg_dot)(z2, terms.g), z2, x);
        WG_NAME(wg_add)(x, WG_C(1.0), chain->point[1], x);
        q[1] = WG_NAME(wg_angle_about)(z2, terms.g, y);
    }
    WG_NAME(wg_add)(x, WG_C(-1.0), chain->point[0], x);
    q[0] = chain->slides[0] ? WG_NAME(wg_dot)(z1, away) - WG_NAME(wg_dot)(z1, x) : WG_NAME(wg_angle_about)(z1, x, away);
    q[2] = q3;
}

/* Zeros q3 of F or of k2, at most 9, touching ones included, and 0 where it vanishes everywhere: their number. */
static inline int WG_NAME(wg_third_joints)(const struct WG_NAME(wg_elimination) * system, int plain, WG_REAL q3[9]) {
    WG_REAL c[5] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)}, forth[5], back[5], roots[4], largest = WG_C(0.0);
    const int slides = system->chain->slides[2];
    int i, j, count = 0, found;
    if (slides) {
        const WG_REAL below = WG_NAME(wg_left_over)(system, plain, WG_C(-1.0)), above = WG_NAME(wg_left_over)(system, plain, WG_C(1.0));
        c[0] = WG_NAME(wg_left_over)(system, plain, WG_C(0.0));
        c[1] = WG_C(0.5) * (above - below);
        c[2] = WG_C(0.5) * (above + below) - c[0];
    } else {
        WG_REAL h[5] = {WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0), WG_C(0.0)}; /* mean, cos q3, sin q3, cos 2 q3, sin 2 q3 */
        for (i = 0; i < 5; ++i) {
            const WG_REAL angle = (WG_REAL)i * (WG_C(0.4) * WG_PI), value = WG_NAME(wg_left_over)(system, plain, angle);
            h[0] += WG_C(0.2) * value;
            for (j = 1; j < 3; ++j) {
                h[2 * j - 1] += WG_C(0.4) * value * WG_COS((WG_REAL)j * angle);
                h[2 * j] += WG_C(0.4) * value * WG_SIN((WG_REAL)j * angle);
            }
        }
        c[0] = h[0] + h[1] + h[3];
        c[1] = WG_C(2.0) * h[2] + WG_C(4.0) * h[4];
        c[2] = WG_C(2.0) * h[0] - WG_C(6.0) * h[3];
        c[3] = WG_C(2.0) * h[2] - WG_C(4.0) * h[4];
        c[4] = h[0] - h[1] + h[3];
    }
    for (i = 0; i < 5; ++i) {
        largest = WG_MAX(largest, WG_ABS(c[i]));
    }
    if (largest < WG_TOUCHING) {
        q3[count++] = WG_C(0.0);
    }
    (void)WG_NAME(wg_scaled_quartic)(c, forth);
    for (i = 0; i < 5; ++i) {
        back[i] = forth[4 - i];
    }
    found = WG_NAME(wg_roots_within)(forth, WG_SPLIT, WG_TOUCHING, roots);
    for (i = 0; i < found; ++i) {
        q3[count++] = slides ? roots[i] : WG_C(2.0) * WG_ATAN2(roots[i], WG_C(1.0));
    }
    found = WG_NAME(wg_roots_within)(back, WG_C(1.0) / WG_SPLIT, WG_TOUCHING, roots);
    for (i = 0; i < found; ++i) {
        if (!slides) {
            q3[count++] = WG_C(2.0) * WG_ATAN2(WG_C(1.0), roots[i]);
        } else if (WG_ABS(roots[i]) > WG_C(1e-12)) {
            q3[count++] = WG_C(1.0) / roots[i];
        }
    }
    return count;
}

/* Poses near every one that reaches the target, and others, at most 36: their number. */
static inline int WG_NAME(wg_candidates)(const struct WG_NAME(wg_chain) * chain, const WG_REAL target[3], WG_REAL q[36][3]) {
    struct WG_NAME(wg_elimination) system;
    int i, plain, count = 0, small, none;
    WG_NAME(wg_eliminate)(chain, target, &system);
    small = WG_ABS(system.s2) < WG_SMALL;
    none = WG_ABS(system.s2) < WG_NONE && system.s1 >= WG_NONE;
    for (plain = 0; plain < 2; ++plain) {
        WG_REAL q3[9];
        const int wanted = plain ? small && system.s1 >= WG_NONE : !none;
        const int found = wanted ? WG_NAME(wg_third_joints)(&system, plain, q3) : 0;
        for (i = 0; i < found; ++i) {
            WG_NAME(wg_pose)(&system, q3[i], WG_C(1.0), q[count++]);
            if (small) {
                WG_NAME(wg_pose)(&system, q3[i], WG_C(-1.0), q[count++]);
            }
        }
    }
    return count;
}

#undef WG_TOUCHING
#undef WG_NONE
#undef WG_SMALL
#endif
