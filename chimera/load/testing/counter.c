/* SPDX-License-Identifier: Apache-2.0 */
/* A good object: counts its cycles, in its state and in a static variable of the object. */
#include "chimera/task/pbo.h"

typedef struct { int32_t unused; } counterLocal_t;
PBO_PORTS(counter,
  (out_var, count, int32, "", "1", PBO_DOC("of the object")))
PBO_MODULE(counter, .doc = "Counts.", .default_rate_hz = 10);

int counterCycle(counterLocal_t *local) {
  static int32_t cycles;
  SVAR_OUT(count);
  *count = ++cycles;
  return PBO_OK;
}
