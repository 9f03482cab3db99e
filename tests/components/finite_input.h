/* SPDX-License-Identifier: Apache-2.0 */
/* The rules of library/signals/input.h, in C. */
#ifndef TESTS_COMPONENTS_FINITE_INPUT_H_
#define TESTS_COMPONENTS_FINITE_INPUT_H_

#include <stdio.h>

#include "chimera/task/pbo.h"

/* PBO_OK if all elements are finite, PBO_ABORTED if no task wrote the input, else a fault that names an element. */
static inline int judgeInput(const chimera_call* call, const chimera_port* port, const char* name) {
  const double* const x = (const double*)port->value;
  char text[80];
  for (uint32_t i = 0; i < port->count; ++i) {
    if (__builtin_isfinite(x[i])) continue;
    if (!pboValid(port)) return PBO_ABORTED;
    if (port->count == 1) snprintf(text, sizeof text, "%s is not a finite number", name);
    else snprintf(text, sizeof text, "%s[%u] is not a finite number", name, (unsigned)i);
    return pboFault(call, text);
  }
  return PBO_OK;
}

static inline double clamp(double x, double low, double high) { return x < low ? low : high < x ? high : x; }

#endif /* TESTS_COMPONENTS_FINITE_INPUT_H_ */
