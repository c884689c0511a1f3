/* walkgen_lanes.h: functions of one row become lanes of vectors; <robot>.c includes this before it reads its functions a second time.
 *
 * The same text is a function of one row, and within a loop over WG_LANES rows, whose like numbers lie side by side, what compilers turn
 * into vectors of any width: it has no branch, and here sine, cosine and arctangent have none either. Beyond their range (walkgen_trig.h)
 * they give NaN, and a row with a NaN among the results that tell of it is computed once more, alone. Lane by lane the bits of one row.
 */
#if defined(WALKGEN_ROWS)
#undef WG_ROW
#undef WG_STATIC_ROW
#define WG_ROW(head) WG_INLINE head##_lane
#define WG_STATIC_ROW(head) WG_INLINE head##_lane

/* Choices by the bits; a status is a number like others. */
#undef WG_SELECT
#undef WG_INDICATOR
#undef WG_STATE
#define WG_SELECT(truth, a, b) WG_NAME(walkgen_select)(truth, a, b)
#define WG_INDICATOR(truth) WG_NAME(walkgen_select)(truth, WG_C(1.0), WG_C(0.0))
#define WG_STATE WG_REAL

#undef WG_SIN
#undef WG_COS
#undef WG_ATAN2
#define WG_SIN(x) WG_NAME(wg_sin_lane)(x)
#define WG_COS(x) WG_NAME(wg_cos_lane)(x)
#define WG_ATAN2(y, x) WG_NAME(wg_atan2_lane)(y, x)
#include "walkgen_together.h"

/* Sines beside each other, not one after another: processors look less far ahead than a block has instructions. */
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12 && defined(__OPTIMIZE__) && defined(__x86_64__)
#define WG_SCHEDULED __attribute__((optimize("schedule-insns,sched-pressure")))
#else
#define WG_SCHEDULED
#endif

/* How a block of rows is computed: given [inputs][lane], found [outputs][lane], and last a number for each lane that is 0 where no angle was lost;
 * and how one row is, its numbers side by side. */
#define WG_BLOCK(name) \
    WG_SCHEDULED static void name##_block(const WG_REAL (*WG_RESTRICT given)[WG_LANES], WG_REAL (*WG_RESTRICT found)[WG_LANES])
#define WG_ALONE(name) static void name##_alone(const WG_REAL *WG_RESTRICT given, WG_REAL *WG_RESTRICT found)
#define WG_LANED(name, inputs, outputs) static const struct WG_NAME(wg_laned) name##_laned = {name##_block, name##_alone, inputs, outputs}
#define WG_EACH_LANE for (int lane = 0; lane < WG_LANES; ++lane)
#define WG_TAKE_1(port, first) port[0] = given[first][lane];
#define WG_TAKE_2(port, first) WG_TAKE_1(port, first) port[1] = given[(first) + 1][lane];
#define WG_TAKE_3(port, first) WG_TAKE_2(port, first) port[2] = given[(first) + 2][lane];
#define WG_TAKE_4(port, first) WG_TAKE_3(port, first) port[3] = given[(first) + 3][lane];
#define WG_TAKE_5(port, first) WG_TAKE_4(port, first) port[4] = given[(first) + 4][lane];
#define WG_TAKE_6(port, first) WG_TAKE_5(port, first) port[5] = given[(first) + 5][lane];
#define WG_TAKE_7(port, first) WG_TAKE_6(port, first) port[6] = given[(first) + 6][lane];
#define WG_TAKE_8(port, first) WG_TAKE_7(port, first) port[7] = given[(first) + 7][lane];
#define WG_TAKE_9(port, first) WG_TAKE_8(port, first) port[8] = given[(first) + 8][lane];
#define WG_TAKE_10(port, first) WG_TAKE_9(port, first) port[9] = given[(first) + 9][lane];
#define WG_TAKE_11(port, first) WG_TAKE_10(port, first) port[10] = given[(first) + 10][lane];
#define WG_TAKE_12(port, first) WG_TAKE_11(port, first) port[11] = given[(first) + 11][lane];
#define WG_TAKE_13(port, first) WG_TAKE_12(port, first) port[12] = given[(first) + 12][lane];
#define WG_TAKE_14(port, first) WG_TAKE_13(port, first) port[13] = given[(first) + 13][lane];
#define WG_TAKE_15(port, first) WG_TAKE_14(port, first) port[14] = given[(first) + 14][lane];
#define WG_TAKE_16(port, first) WG_TAKE_15(port, first) port[15] = given[(first) + 15][lane];
#define WG_TAKE_17(port, first) WG_TAKE_16(port, first) port[16] = given[(first) + 16][lane];
#define WG_TAKE_18(port, first) WG_TAKE_17(port, first) port[17] = given[(first) + 17][lane];
#define WG_TAKE_19(port, first) WG_TAKE_18(port, first) port[18] = given[(first) + 18][lane];
#define WG_TAKE_20(port, first) WG_TAKE_19(port, first) port[19] = given[(first) + 19][lane];
#define WG_TAKE_21(port, first) WG_TAKE_20(port, first) port[20] = given[(first) + 20][lane];
#define WG_TAKE_22(port, first) WG_TAKE_21(port, first) port[21] = given[(first) + 21][lane];
#define WG_TAKE_23(port, first) WG_TAKE_22(port, first) port[22] = given[(first) + 22][lane];
#define WG_TAKE_24(port, first) WG_TAKE_23(port, first) port[23] = given[(first) + 23][lane];
#define WG_TAKE_25(port, first) WG_TAKE_24(port, first) port[24] = given[(first) + 24][lane];
#define WG_TAKE_26(port, first) WG_TAKE_25(port, first) port[25] = given[(first) + 25][lane];
#define WG_TAKE_27(port, first) WG_TAKE_26(port, first) port[26] = given[(first) + 26][lane];
#define WG_TAKE_28(port, first) WG_TAKE_27(port, first) port[27] = given[(first) + 27][lane];
#define WG_TAKE_29(port, first) WG_TAKE_28(port, first) port[28] = given[(first) + 28][lane];
#define WG_TAKE_30(port, first) WG_TAKE_29(port, first) port[29] = given[(first) + 29][lane];
#define WG_TAKE_31(port, first) WG_TAKE_30(port, first) port[30] = given[(first) + 30][lane];
#define WG_TAKE_32(port, first) WG_TAKE_31(port, first) port[31] = given[(first) + 31][lane];
/* `telling` is NaN where an angle is beyond its range. */
#define WG_DONE(outputs, telling) found[outputs][lane] = (telling) - (telling);
#define WG_KEEP_1(port, first) found[first][lane] = port[0];
#define WG_KEEP_2(port, first) WG_KEEP_1(port, first) found[(first) + 1][lane] = port[1];
#define WG_KEEP_3(port, first) WG_KEEP_2(port, first) found[(first) + 2][lane] = port[2];
#define WG_KEEP_4(port, first) WG_KEEP_3(port, first) found[(first) + 3][lane] = port[3];
#define WG_KEEP_5(port, first) WG_KEEP_4(port, first) found[(first) + 4][lane] = port[4];
#define WG_KEEP_6(port, first) WG_KEEP_5(port, first) found[(first) + 5][lane] = port[5];
#define WG_KEEP_7(port, first) WG_KEEP_6(port, first) found[(first) + 6][lane] = port[6];
#define WG_KEEP_8(port, first) WG_KEEP_7(port, first) found[(first) + 7][lane] = port[7];
#define WG_KEEP_9(port, first) WG_KEEP_8(port, first) found[(first) + 8][lane] = port[8];
#define WG_KEEP_10(port, first) WG_KEEP_9(port, first) found[(first) + 9][lane] = port[9];
#define WG_KEEP_11(port, first) WG_KEEP_10(port, first) found[(first) + 10][lane] = port[10];
#define WG_KEEP_12(port, first) WG_KEEP_11(port, first) found[(first) + 11][lane] = port[11];
#define WG_KEEP_13(port, first) WG_KEEP_12(port, first) found[(first) + 12][lane] = port[12];
#define WG_KEEP_14(port, first) WG_KEEP_13(port, first) found[(first) + 13][lane] = port[13];
#define WG_KEEP_15(port, first) WG_KEEP_14(port, first) found[(first) + 14][lane] = port[14];
#define WG_KEEP_16(port, first) WG_KEEP_15(port, first) found[(first) + 15][lane] = port[15];
#define WG_KEEP_17(port, first) WG_KEEP_16(port, first) found[(first) + 16][lane] = port[16];
#define WG_KEEP_18(port, first) WG_KEEP_17(port, first) found[(first) + 17][lane] = port[17];
#define WG_KEEP_19(port, first) WG_KEEP_18(port, first) found[(first) + 18][lane] = port[18];
#define WG_KEEP_20(port, first) WG_KEEP_19(port, first) found[(first) + 19][lane] = port[19];
#define WG_KEEP_21(port, first) WG_KEEP_20(port, first) found[(first) + 20][lane] = port[20];
#define WG_KEEP_22(port, first) WG_KEEP_21(port, first) found[(first) + 21][lane] = port[21];
#define WG_KEEP_23(port, first) WG_KEEP_22(port, first) found[(first) + 22][lane] = port[22];
#define WG_KEEP_24(port, first) WG_KEEP_23(port, first) found[(first) + 23][lane] = port[23];
#define WG_KEEP_25(port, first) WG_KEEP_24(port, first) found[(first) + 24][lane] = port[24];
#define WG_KEEP_26(port, first) WG_KEEP_25(port, first) found[(first) + 25][lane] = port[25];
#define WG_KEEP_27(port, first) WG_KEEP_26(port, first) found[(first) + 26][lane] = port[26];
#define WG_KEEP_28(port, first) WG_KEEP_27(port, first) found[(first) + 27][lane] = port[27];
#define WG_KEEP_29(port, first) WG_KEEP_28(port, first) found[(first) + 28][lane] = port[28];
#define WG_KEEP_30(port, first) WG_KEEP_29(port, first) found[(first) + 29][lane] = port[29];
#define WG_KEEP_31(port, first) WG_KEEP_30(port, first) found[(first) + 30][lane] = port[30];
#define WG_KEEP_32(port, first) WG_KEEP_31(port, first) found[(first) + 31][lane] = port[31];
#endif
