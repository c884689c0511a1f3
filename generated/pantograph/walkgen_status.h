/* walkgen_status.h: what every robot's header shares: status codes and `restrict`; one guard, so that several robots link together. */
#ifndef WALKGEN_STATUS_H
#define WALKGEN_STATUS_H

#include <stdint.h>

#if defined(__cplusplus)
#if defined(__GNUC__) || defined(__clang__) || defined(_MSC_VER)
#define WG_RESTRICT __restrict
#else
#define WG_RESTRICT
#endif
#else
#define WG_RESTRICT restrict
#endif

enum walkgen_status {
    WALKGEN_OK = 0,             /* the result is exact to rounding */
    WALKGEN_UNREACHABLE = 1,    /* the result brings the foot closest to the target */
    WALKGEN_BAD_INPUT = 2,      /* an input was NaN, infinite or out of its range; the result is NaN */
    WALKGEN_SINGULAR = 3,       /* the result is not isolated, or damping is active */
    WALKGEN_NO_CONVERGENCE = 4, /* an iteration ended at its bound; the result is its last step */
    WALKGEN_INFEASIBLE = 5,     /* no result exists */
    WALKGEN_DUPLICATE = 6       /* this slot repeats an earlier one */
};

/* The status as a word; "UNKNOWN" for a number that is none. */
static inline const char *walkgen_status_text(int32_t status) {
    switch (status) {
    case WALKGEN_OK: return "OK";
    case WALKGEN_UNREACHABLE: return "UNREACHABLE";
    case WALKGEN_BAD_INPUT: return "BAD_INPUT";
    case WALKGEN_SINGULAR: return "SINGULAR";
    case WALKGEN_NO_CONVERGENCE: return "NO_CONVERGENCE";
    case WALKGEN_INFEASIBLE: return "INFEASIBLE";
    case WALKGEN_DUPLICATE: return "DUPLICATE";
    default: return "UNKNOWN";
    }
}

#endif
