/* SPDX-License-Identifier: Apache-2.0 */
/* The C face with PBO_PAPER: Init returns (int)local, and a module needs no ports. Init fails after the time 0. */
#define PBO_PAPER
#include "chimera/task/pbo.h"

typedef struct { int64_t started; } t_paperLocal_t;
PBO_MODULE(t_paper, .default_rate_hz = 10);

int t_paperInit(t_paperLocal_t *local) {
  if (PBO_NOW == 2000000) return PBO_FAULT("it is 2 ms");
  return PBO_NOW == 0 ? (int)local : 0;
}

int t_paperCycle(t_paperLocal_t *local) {
  (void)local;
  return PBO_OK;
}
