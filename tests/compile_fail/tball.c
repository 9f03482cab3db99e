/* SPDX-License-Identifier: Apache-2.0 */
/* Figure 9 of the 2000 paper but for the lines in the table of docs/howto/component-in-c.md. */
#define PBO_PAPER
#include "chimera/task/pbo.h"
typedef struct {
} tballLocal_t;
PBO_PORTS(tball, (out_var, xd, float64, "[3]", "m"))
PBO_MODULE(tball);
int tballInit(tballLocal_t *local) {
  return (int) local;
}
int tballCycle(tballLocal_t *local) {
  SVAR_OUT(xd);
  return PBO_OK;
}
