/* walkgen_contact_work.h: what a caller of contact forces keeps between stances; plain C99 and C++.
 *
 * All zeros to begin with, and one for every stance that is solved again and again: the next search starts where the last one ended. It
 * changes the time that a search takes, never the verdict, and the forces only by rounding.
 */
#ifndef WALKGEN_CONTACT_WORK_H
#define WALKGEN_CONTACT_WORK_H

#include <stdint.h>

#ifndef WALKGEN_MAX_FEET
#define WALKGEN_MAX_FEET 16
#endif

/* The multipliers (force, moment) of the last forces and their number of feet; 0 feet: none. */
typedef struct walkgen_contact_work {
    int32_t feet;
    double start[6];
} walkgen_contact_work;

typedef struct walkgen_contact_work_f32 {
    int32_t feet;
    float start[6];
} walkgen_contact_work_f32;

#endif
