/* SPDX-License-Identifier: Apache-2.0 */
/* @NAME@: smooths one signal with a time constant. Change it into what you need. */
#include <math.h>

#include "chimera/task/pbo.h"

typedef struct {
  uint64_t cycles;
} @NAME@Local_t;

PBO_PORTS(@NAME@,
  (in_var,   x,    float64, "", "U", PBO_DOC("any signal")),
  (in_const, time, float64, "", "s", PBO_INITIAL(float64, 0.1), PBO_RANGE(1e-6, 1e6), PBO_DOC("time constant")),
  (out_var,  y,    float64, "", "U", PBO_DOC("the signal, smoothed")))
PBO_MODULE(@NAME@, .doc = "Smooths one signal.", .default_rate_hz = 100);

int @NAME@On(@NAME@Local_t *local) {
  SVAR_IN(x);
  SVAR_OUT(y);
  *y = *x; /* no step when the task goes ON */
  return PBO_OK;
}

int @NAME@Cycle(@NAME@Local_t *local) {
  SVAR_IN(x);
  SVAR_IN(time);
  SVAR_OUT(y);
  if (!isfinite(*x)) return PBO_FAULT("x is not finite"); /* else it would stay in y for ever */
  *y += (*x - *y) * PBO_DT / (*time + PBO_DT);
  ++local->cycles;
  return PBO_OK;
}
