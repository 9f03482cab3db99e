/* SPDX-License-Identifier: Apache-2.0 */
/* Applies a macro to each element of a list, up to 32 elements. pbo.h turns its list of ports into C with it. */
#ifndef CHIMERA_TASK_PBO_EACH_H_
#define CHIMERA_TASK_PBO_EACH_H_

#define PBO_JOIN_(a, b) a##b
#define PBO_JOIN(a, b) PBO_JOIN_(a, b)
#define PBO_COUNT_(a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, \
                   a22, a23, a24, a25, a26, a27, a28, a29, a30, a31, a32, n, ...) n
#define PBO_COUNT(...) \
  PBO_COUNT_(__VA_ARGS__, 32, 31, 30, 29, 28, 27, 26, 25, 24, 23, 22, 21, 20, 19, 18, 17, 16, 15, 14, 13, 12, 11, \
             10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0)

/* PBO_EACH(do, m, x1, x2, ...): do(m, x1) do(m, x2) ... */
#define PBO_EACH(do, m, ...) PBO_JOIN(PBO_EACH_, PBO_COUNT(__VA_ARGS__))(do, m, __VA_ARGS__)
#define PBO_EACH_1(do, m, x) do(m, x)
#define PBO_EACH_2(do, m, x, ...) do(m, x) PBO_EACH_1(do, m, __VA_ARGS__)
#define PBO_EACH_3(do, m, x, ...) do(m, x) PBO_EACH_2(do, m, __VA_ARGS__)
#define PBO_EACH_4(do, m, x, ...) do(m, x) PBO_EACH_3(do, m, __VA_ARGS__)
#define PBO_EACH_5(do, m, x, ...) do(m, x) PBO_EACH_4(do, m, __VA_ARGS__)
#define PBO_EACH_6(do, m, x, ...) do(m, x) PBO_EACH_5(do, m, __VA_ARGS__)
#define PBO_EACH_7(do, m, x, ...) do(m, x) PBO_EACH_6(do, m, __VA_ARGS__)
#define PBO_EACH_8(do, m, x, ...) do(m, x) PBO_EACH_7(do, m, __VA_ARGS__)
#define PBO_EACH_9(do, m, x, ...) do(m, x) PBO_EACH_8(do, m, __VA_ARGS__)
#define PBO_EACH_10(do, m, x, ...) do(m, x) PBO_EACH_9(do, m, __VA_ARGS__)
#define PBO_EACH_11(do, m, x, ...) do(m, x) PBO_EACH_10(do, m, __VA_ARGS__)
#define PBO_EACH_12(do, m, x, ...) do(m, x) PBO_EACH_11(do, m, __VA_ARGS__)
#define PBO_EACH_13(do, m, x, ...) do(m, x) PBO_EACH_12(do, m, __VA_ARGS__)
#define PBO_EACH_14(do, m, x, ...) do(m, x) PBO_EACH_13(do, m, __VA_ARGS__)
#define PBO_EACH_15(do, m, x, ...) do(m, x) PBO_EACH_14(do, m, __VA_ARGS__)
#define PBO_EACH_16(do, m, x, ...) do(m, x) PBO_EACH_15(do, m, __VA_ARGS__)
#define PBO_EACH_17(do, m, x, ...) do(m, x) PBO_EACH_16(do, m, __VA_ARGS__)
#define PBO_EACH_18(do, m, x, ...) do(m, x) PBO_EACH_17(do, m, __VA_ARGS__)
#define PBO_EACH_19(do, m, x, ...) do(m, x) PBO_EACH_18(do, m, __VA_ARGS__)
#define PBO_EACH_20(do, m, x, ...) do(m, x) PBO_EACH_19(do, m, __VA_ARGS__)
#define PBO_EACH_21(do, m, x, ...) do(m, x) PBO_EACH_20(do, m, __VA_ARGS__)
#define PBO_EACH_22(do, m, x, ...) do(m, x) PBO_EACH_21(do, m, __VA_ARGS__)
#define PBO_EACH_23(do, m, x, ...) do(m, x) PBO_EACH_22(do, m, __VA_ARGS__)
#define PBO_EACH_24(do, m, x, ...) do(m, x) PBO_EACH_23(do, m, __VA_ARGS__)
#define PBO_EACH_25(do, m, x, ...) do(m, x) PBO_EACH_24(do, m, __VA_ARGS__)
#define PBO_EACH_26(do, m, x, ...) do(m, x) PBO_EACH_25(do, m, __VA_ARGS__)
#define PBO_EACH_27(do, m, x, ...) do(m, x) PBO_EACH_26(do, m, __VA_ARGS__)
#define PBO_EACH_28(do, m, x, ...) do(m, x) PBO_EACH_27(do, m, __VA_ARGS__)
#define PBO_EACH_29(do, m, x, ...) do(m, x) PBO_EACH_28(do, m, __VA_ARGS__)
#define PBO_EACH_30(do, m, x, ...) do(m, x) PBO_EACH_29(do, m, __VA_ARGS__)
#define PBO_EACH_31(do, m, x, ...) do(m, x) PBO_EACH_30(do, m, __VA_ARGS__)
#define PBO_EACH_32(do, m, x, ...) do(m, x) PBO_EACH_31(do, m, __VA_ARGS__)

#endif /* CHIMERA_TASK_PBO_EACH_H_ */
