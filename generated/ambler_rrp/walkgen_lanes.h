/* walkgen_lanes.h: functions of one row become lanes of vectors; <robot>.c includes this before it reads its functions a second time.
 *
 * The same text is a function of one row, and within a loop over WG_LANES rows, whose like numbers lie side by side, what compilers turn
 * into vectors of any width: it has no branch, and here sine, cosine and arctangent have none either. Beyond their range (walkgen_trig.h)
 * they give NaN, and a row with a NaN among the results that tell of it, or with a status other than OK, is left over: it is computed once
 * more, alone. Lane by lane the bits of one row.
 */
#if defined(WALKGEN_ROWS)
#undef WG_ROW
#undef WG_STATIC_ROW
#undef WG_INLINE_ROW
#define WG_ROW(head) WG_INLINE head##_lane
#define WG_STATIC_ROW(head) WG_INLINE head##_lane
#define WG_INLINE_ROW(head) WG_INLINE head##_lane

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

/* How a block of rows is computed, of which the `first` lies so far on from where each port's numbers do, and for each lane whether it is left
 * over; and how one row is, its numbers side by side. */
#define WG_BLOCK(name) \
    WG_SCHEDULED static void name##_block(const struct WG_NAME(wg_lanes) *ports, ptrdiff_t first, WG_NAME(wg_left) *WG_RESTRICT left)
#define WG_ALONE(name) static void name##_alone(const WG_REAL *WG_RESTRICT given, WG_REAL *WG_RESTRICT found)
#define WG_LANED(name, inputs, outputs, statuses) \
    static const struct WG_NAME(wg_laned) name##_laned = {name##_block, name##_alone, inputs, outputs, statuses}
#define WG_PLACE(real, port, which) \
    real *const WG_RESTRICT wg_##port = (real *)ports[which].at + first; \
    const ptrdiff_t wg_##port##_step = ports[which].step; \
    (void)wg_##port##_step;
#define WG_FROM(port, which) WG_PLACE(const WG_REAL, port, which)
#define WG_FROM_INTEGER(port, which) WG_PLACE(const int32_t, port, which)
#define WG_INTO(port, which) WG_PLACE(WG_REAL, port, which)
/* Arrays of one call lie apart. */
#if defined(__clang__)
#define WG_EACH_LANE _Pragma("clang loop vectorize(assume_safety)") for (int lane = 0; lane < WG_LANES; ++lane)
#elif defined(__GNUC__)
#define WG_EACH_LANE _Pragma("GCC ivdep") for (int lane = 0; lane < WG_LANES; ++lane)
#else
#define WG_EACH_LANE for (int lane = 0; lane < WG_LANES; ++lane)
#endif
#define WG_TAKE_INTEGER(port) port[0] = (WG_STATE)wg_##port[lane];
#define WG_TAKE_1(port) port[0] = wg_##port[lane];
#define WG_TAKE_2(port) WG_TAKE_1(port) port[1] = wg_##port[wg_##port##_step + lane];
#define WG_TAKE_3(port) WG_TAKE_2(port) port[2] = wg_##port[2 * wg_##port##_step + lane];
#define WG_TAKE_4(port) WG_TAKE_3(port) port[3] = wg_##port[3 * wg_##port##_step + lane];
#define WG_TAKE_5(port) WG_TAKE_4(port) port[4] = wg_##port[4 * wg_##port##_step + lane];
#define WG_TAKE_6(port) WG_TAKE_5(port) port[5] = wg_##port[5 * wg_##port##_step + lane];
#define WG_TAKE_7(port) WG_TAKE_6(port) port[6] = wg_##port[6 * wg_##port##_step + lane];
#define WG_TAKE_8(port) WG_TAKE_7(port) port[7] = wg_##port[7 * wg_##port##_step + lane];
#define WG_TAKE_9(port) WG_TAKE_8(port) port[8] = wg_##port[8 * wg_##port##_step + lane];
#define WG_TAKE_10(port) WG_TAKE_9(port) port[9] = wg_##port[9 * wg_##port##_step + lane];
#define WG_TAKE_11(port) WG_TAKE_10(port) port[10] = wg_##port[10 * wg_##port##_step + lane];
#define WG_TAKE_12(port) WG_TAKE_11(port) port[11] = wg_##port[11 * wg_##port##_step + lane];
#define WG_TAKE_13(port) WG_TAKE_12(port) port[12] = wg_##port[12 * wg_##port##_step + lane];
#define WG_TAKE_14(port) WG_TAKE_13(port) port[13] = wg_##port[13 * wg_##port##_step + lane];
#define WG_TAKE_15(port) WG_TAKE_14(port) port[14] = wg_##port[14 * wg_##port##_step + lane];
#define WG_TAKE_16(port) WG_TAKE_15(port) port[15] = wg_##port[15 * wg_##port##_step + lane];
#define WG_TAKE_17(port) WG_TAKE_16(port) port[16] = wg_##port[16 * wg_##port##_step + lane];
#define WG_TAKE_18(port) WG_TAKE_17(port) port[17] = wg_##port[17 * wg_##port##_step + lane];
#define WG_TAKE_19(port) WG_TAKE_18(port) port[18] = wg_##port[18 * wg_##port##_step + lane];
#define WG_TAKE_20(port) WG_TAKE_19(port) port[19] = wg_##port[19 * wg_##port##_step + lane];
#define WG_TAKE_21(port) WG_TAKE_20(port) port[20] = wg_##port[20 * wg_##port##_step + lane];
#define WG_TAKE_22(port) WG_TAKE_21(port) port[21] = wg_##port[21 * wg_##port##_step + lane];
#define WG_TAKE_23(port) WG_TAKE_22(port) port[22] = wg_##port[22 * wg_##port##_step + lane];
#define WG_TAKE_24(port) WG_TAKE_23(port) port[23] = wg_##port[23 * wg_##port##_step + lane];
#define WG_TAKE_25(port) WG_TAKE_24(port) port[24] = wg_##port[24 * wg_##port##_step + lane];
#define WG_TAKE_26(port) WG_TAKE_25(port) port[25] = wg_##port[25 * wg_##port##_step + lane];
#define WG_TAKE_27(port) WG_TAKE_26(port) port[26] = wg_##port[26 * wg_##port##_step + lane];
#define WG_TAKE_28(port) WG_TAKE_27(port) port[27] = wg_##port[27 * wg_##port##_step + lane];
#define WG_TAKE_29(port) WG_TAKE_28(port) port[28] = wg_##port[28 * wg_##port##_step + lane];
#define WG_TAKE_30(port) WG_TAKE_29(port) port[29] = wg_##port[29 * wg_##port##_step + lane];
#define WG_TAKE_31(port) WG_TAKE_30(port) port[30] = wg_##port[30 * wg_##port##_step + lane];
#define WG_TAKE_32(port) WG_TAKE_31(port) port[31] = wg_##port[31 * wg_##port##_step + lane];
/* `telling` is NaN where an angle is beyond its range, or infinite; `status` is 0 in lanes that are done. */
#undef WG_DONE
#undef WG_DONE_IF
#if WG_MASKS
#define WG_DONE(telling) WG_DONE_IF(telling, WG_C(0.0))
#define WG_DONE_IF(telling, status) left[lane] = !((telling) - (telling) == (status));
#else
#define WG_DONE(telling) left[lane] = (telling) - (telling);
#define WG_DONE_IF(telling, status) left[lane] = (telling) - (telling) + (status);
#endif
#define WG_KEEP_1(port) wg_##port[lane] = port[0];
#define WG_KEEP_2(port) WG_KEEP_1(port) wg_##port[wg_##port##_step + lane] = port[1];
#define WG_KEEP_3(port) WG_KEEP_2(port) wg_##port[2 * wg_##port##_step + lane] = port[2];
#define WG_KEEP_4(port) WG_KEEP_3(port) wg_##port[3 * wg_##port##_step + lane] = port[3];
#define WG_KEEP_5(port) WG_KEEP_4(port) wg_##port[4 * wg_##port##_step + lane] = port[4];
#define WG_KEEP_6(port) WG_KEEP_5(port) wg_##port[5 * wg_##port##_step + lane] = port[5];
#define WG_KEEP_7(port) WG_KEEP_6(port) wg_##port[6 * wg_##port##_step + lane] = port[6];
#define WG_KEEP_8(port) WG_KEEP_7(port) wg_##port[7 * wg_##port##_step + lane] = port[7];
#define WG_KEEP_9(port) WG_KEEP_8(port) wg_##port[8 * wg_##port##_step + lane] = port[8];
#define WG_KEEP_10(port) WG_KEEP_9(port) wg_##port[9 * wg_##port##_step + lane] = port[9];
#define WG_KEEP_11(port) WG_KEEP_10(port) wg_##port[10 * wg_##port##_step + lane] = port[10];
#define WG_KEEP_12(port) WG_KEEP_11(port) wg_##port[11 * wg_##port##_step + lane] = port[11];
#define WG_KEEP_13(port) WG_KEEP_12(port) wg_##port[12 * wg_##port##_step + lane] = port[12];
#define WG_KEEP_14(port) WG_KEEP_13(port) wg_##port[13 * wg_##port##_step + lane] = port[13];
#define WG_KEEP_15(port) WG_KEEP_14(port) wg_##port[14 * wg_##port##_step + lane] = port[14];
#define WG_KEEP_16(port) WG_KEEP_15(port) wg_##port[15 * wg_##port##_step + lane] = port[15];
#define WG_KEEP_17(port) WG_KEEP_16(port) wg_##port[16 * wg_##port##_step + lane] = port[16];
#define WG_KEEP_18(port) WG_KEEP_17(port) wg_##port[17 * wg_##port##_step + lane] = port[17];
#define WG_KEEP_19(port) WG_KEEP_18(port) wg_##port[18 * wg_##port##_step + lane] = port[18];
#define WG_KEEP_20(port) WG_KEEP_19(port) wg_##port[19 * wg_##port##_step + lane] = port[19];
#define WG_KEEP_21(port) WG_KEEP_20(port) wg_##port[20 * wg_##port##_step + lane] = port[20];
#define WG_KEEP_22(port) WG_KEEP_21(port) wg_##port[21 * wg_##port##_step + lane] = port[21];
#define WG_KEEP_23(port) WG_KEEP_22(port) wg_##port[22 * wg_##port##_step + lane] = port[22];
#define WG_KEEP_24(port) WG_KEEP_23(port) wg_##port[23 * wg_##port##_step + lane] = port[23];
#define WG_KEEP_25(port) WG_KEEP_24(port) wg_##port[24 * wg_##port##_step + lane] = port[24];
#define WG_KEEP_26(port) WG_KEEP_25(port) wg_##port[25 * wg_##port##_step + lane] = port[25];
#define WG_KEEP_27(port) WG_KEEP_26(port) wg_##port[26 * wg_##port##_step + lane] = port[26];
#define WG_KEEP_28(port) WG_KEEP_27(port) wg_##port[27 * wg_##port##_step + lane] = port[27];
#define WG_KEEP_29(port) WG_KEEP_28(port) wg_##port[28 * wg_##port##_step + lane] = port[28];
#define WG_KEEP_30(port) WG_KEEP_29(port) wg_##port[29 * wg_##port##_step + lane] = port[29];
#define WG_KEEP_31(port) WG_KEEP_30(port) wg_##port[30 * wg_##port##_step + lane] = port[30];
#define WG_KEEP_32(port) WG_KEEP_31(port) wg_##port[31 * wg_##port##_step + lane] = port[31];
#endif
