/* SPDX-License-Identifier: Apache-2.0 */
/* Lists of the preprocessor. pbo.h turns the lists of ports, options and members into C with them. */
#ifndef CHIMERA_TASK_PBO_EACH_H_
#define CHIMERA_TASK_PBO_EACH_H_

#define PBO_JOIN_(a, b) a##b
#define PBO_JOIN(a, b) PBO_JOIN_(a, b)

/* The second, third and fourth element. A name that is no macro is one element, so the next ones serve as defaults. */
#define PBO_2_(a, b, ...) b
#define PBO_2(...) PBO_2_(__VA_ARGS__, ~)
#define PBO_3_(a, b, c, ...) c
#define PBO_3(...) PBO_3_(__VA_ARGS__, ~)
#define PBO_4_(a, b, c, d, ...) d
#define PBO_4(...) PBO_4_(__VA_ARGS__, ~)

/* 1 if x is in parentheses, 0 if it is anything else or nothing. */
#define PBO_IS_LIST(x) PBO_2(PBO_PROBE x, 0)
#define PBO_PROBE(...) ~, 1
#define PBO_UNWRAP(...) __VA_ARGS__

/* PBO_EACH(do, m, (a, b), (c, d), ...): do(m, a, b, , ) do(m, c, d, , ) ..., up to 64 elements. */
#define PBO_EACH(do, m, ...) \
  PBO_EACH_(do, m, __VA_ARGS__, ,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,)
#define PBO_EACH_(do, m, a1, a2, a3, a4, a5, a6, a7, a8, b1, b2, b3, b4, b5, b6, b7, b8, c1, c2, c3, c4, c5, c6, c7, \
                  c8, d1, d2, d3, d4, d5, d6, d7, d8, e1, e2, e3, e4, e5, e6, e7, e8, f1, f2, f3, f4, f5, f6, f7, f8, \
                  g1, g2, g3, g4, g5, g6, g7, g8, h1, h2, h3, h4, h5, h6, h7, h8, more, ...)                          \
  PBO_EIGHT(do, m, a1, a2, a3, a4, a5, a6, a7, a8) PBO_EIGHT(do, m, b1, b2, b3, b4, b5, b6, b7, b8)                   \
  PBO_EIGHT(do, m, c1, c2, c3, c4, c5, c6, c7, c8) PBO_EIGHT(do, m, d1, d2, d3, d4, d5, d6, d7, d8)                   \
  PBO_EIGHT(do, m, e1, e2, e3, e4, e5, e6, e7, e8) PBO_EIGHT(do, m, f1, f2, f3, f4, f5, f6, f7, f8)                   \
  PBO_EIGHT(do, m, g1, g2, g3, g4, g5, g6, g7, g8) PBO_EIGHT(do, m, h1, h2, h3, h4, h5, h6, h7, h8)                   \
  PBO_ONE(PBO_BEYOND_64, m, more)
#define PBO_EIGHT(do, m, a, b, c, d, e, f, g, h)                                                        \
  PBO_ONE(do, m, a) PBO_ONE(do, m, b) PBO_ONE(do, m, c) PBO_ONE(do, m, d) PBO_ONE(do, m, e) PBO_ONE(do, m, f) \
  PBO_ONE(do, m, g) PBO_ONE(do, m, h)
#define PBO_ONE(do, m, x) PBO_JOIN(PBO_ONE_, PBO_IS_LIST(x))(do, m, x)
#define PBO_ONE_0(do, m, x) x
#define PBO_ONE_1(do, m, x) PBO_APPLY(do, m, PBO_UNWRAP x, , )
#define PBO_APPLY(do, ...) do(__VA_ARGS__)
#define PBO_BEYOND_64(...) more_than_64_elements

/* PBO_OPTIONS(do, k, n, t, (a, b), ...): do(k, n, t, a, b) ..., up to 10 options of one element of PBO_EACH. */
#define PBO_OPTIONS(do, k, n, t, ...) PBO_OPTIONS_(do, k, n, t, __VA_ARGS__, , , , , , , , , , , )
#define PBO_OPTIONS_(do, k, n, t, a, b, c, d, e, f, g, h, i, j, more, ...)                                    \
  PBO_OPTION(do, k, n, t, a) PBO_OPTION(do, k, n, t, b) PBO_OPTION(do, k, n, t, c) PBO_OPTION(do, k, n, t, d) \
  PBO_OPTION(do, k, n, t, e) PBO_OPTION(do, k, n, t, f) PBO_OPTION(do, k, n, t, g) PBO_OPTION(do, k, n, t, h) \
  PBO_OPTION(do, k, n, t, i) PBO_OPTION(do, k, n, t, j) PBO_OPTION(PBO_BEYOND_10, k, n, t, more)
#define PBO_OPTION(do, k, n, t, x) PBO_JOIN(PBO_OPTION_, PBO_IS_LIST(x))(do, k, n, t, x)
#define PBO_OPTION_0(do, k, n, t, x) x
#define PBO_OPTION_1(do, k, n, t, x) PBO_APPLY_OPTION(do, k, n, t, PBO_UNWRAP x)
#define PBO_APPLY_OPTION(do, ...) do(__VA_ARGS__)
#define PBO_BEYOND_10(...) more_than_10_options

#endif /* CHIMERA_TASK_PBO_EACH_H_ */
