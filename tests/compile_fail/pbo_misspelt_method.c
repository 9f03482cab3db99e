/* SPDX-License-Identifier: Apache-2.0 */
#include "chimera/task/pbo.h"

typedef struct { double last; } ballLocal_t;
PBO_PORTS(ball, (in_var, x, float64, "", "m"))
PBO_MODULE(ball, .doc = "Does not compile.");

int ballCycle(ballLocal_t *local) { return PBO_LOCAL(local); }
int ballCylce(ballLocal_t *local) { return PBO_LOCAL(local); }
