/* SPDX-License-Identifier: Apache-2.0 */
#include "chimera/task/pbo.h"

typedef struct { double last; } ballLocal_t;
PBO_PORTS(ball, (in_var, x, float64, "", "m"))
PBO_MODULE(ball, .doc = "Does not compile.");

int ballCycle(ballLocal_t *local) {
  SVAR_IN(x);
  *x = 1;
  return PBO_OK;
}
