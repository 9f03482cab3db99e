/* SPDX-License-Identifier: Apache-2.0 */
/* The rules of library/signals/input.h, in C. */
#ifndef TESTS_COMPONENTS_FINITE_INPUT_H_
#define TESTS_COMPONENTS_FINITE_INPUT_H_

#include "chimera/task/pbo.h"

/* Both lengthen a text with room for them; an index is below 100. An image has no C library, so no snprintf. */
static inline void addText(chimera_fault* fault, const char* more) {
  char* at = fault->text;
  while (*at != '\0') ++at;
  while ((*at++ = *more++) != '\0') {
  }
}
static inline void addIndex(chimera_fault* fault, uint32_t index) {
  char text[5], *at = text;
  *at++ = '[';
  if (index >= 10) *at++ = (char)('0' + index / 10);
  *at++ = (char)('0' + index % 10);
  *at++ = ']';
  *at = '\0';
  addText(fault, text);
}

/* PBO_OK if all elements are finite, PBO_ABORTED if no task wrote the input, else a fault that names an element. */
static inline int judgeInput(const chimera_call* call, const chimera_port* port, const char* name) {
  const double* const x = (const double*)port->value;
  for (uint32_t i = 0; i < port->count; ++i) {
    if (__builtin_isfinite(x[i])) continue;
    if (!pboValid(port)) return PBO_ABORTED;
    pboFault(call, "");
    addText(call->fault, name);
    if (port->count != 1) addIndex(call->fault, i);
    addText(call->fault, " is not a finite number");
    return PBO_ERROR;
  }
  return PBO_OK;
}

static inline double clamp(double x, double low, double high) { return x < low ? low : high < x ? high : x; }

#endif /* TESTS_COMPONENTS_FINITE_INPUT_H_ */
