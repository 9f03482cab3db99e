/* SPDX-License-Identifier: Apache-2.0 */
/* The component tderiv of the library, in C. twins_test.cc compares the two. */
#include "chimera/task/pbo.h"

typedef struct { double last; } t_tderivLocal_t;
PBO_PORTS(t_tderiv,
  (in_var,  x,  float64, "", "U", PBO_DOC("any signal")),
  (out_var, dx, float64, "", "U/s", PBO_INITIAL(float64, 0.0), PBO_DOC("its derivative")))
PBO_MODULE(t_tderiv, .doc = "Time derivative of one signal.");

int t_tderivOn(t_tderivLocal_t *local) {
  SVAR_IN(x);
  SVAR_OUT(dx);
  local->last = *x;
  *dx = 0;
  return PBO_OK;
}

int t_tderivCycle(t_tderivLocal_t *local) {
  SVAR_IN(x);
  SVAR_OUT(dx);
  *dx = (*x - local->last) / PBO_DT;
  local->last = *x;
  return PBO_OK;
}
