/* walkgen_planar.h: arrays whose like elements lie together: element e of row r at [e * stride + r], stride at least the number of rows.
 *
 * walkgen_batch.h reads and writes such arrays as it does any other; without blocks one row after another is taken out and put back.
 */
#include "walkgen_math.h"

#if !defined(WALKGEN_PLANAR)
#define WALKGEN_PLANAR
#define WG_PLANAR_OF(data, type, size, kind) \
    {(char *)(uintptr_t)(const void *)(data), (ptrdiff_t)sizeof(type), (ptrdiff_t)(stride * sizeof(type)), size, kind}
#define WG_PLANAR(data, size) WG_PLANAR_OF(data, WG_REAL, size, WG_NUMBER)
#define WG_PLANAR_STATUS(data, size) WG_PLANAR_OF(data, int32_t, size, WG_STATUS)
#define WG_PLANAR_TAKE(port, size) \
    for (size_t at = 0; at < (size); ++at) { \
        port##_row[at] = port[at * stride + row]; \
    }
#define WG_PLANAR_KEEP(port, size) \
    for (size_t at = 0; at < (size); ++at) { \
        port[at * stride + row] = port##_row[at]; \
    }
#endif
