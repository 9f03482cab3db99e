/* SPDX-License-Identifier: Apache-2.0 */
/* The car of figure 8 of the 2000 paper, which shows the names of its methods. */
#define PBO_PAPER
#include "chimera/task/pbo.h"
typedef struct { int cycles; } carLocal_t;
PBO_MODULE(car);
int carInit(carLocal_t *local) { return (int)local; }
int carOn(carLocal_t *local) { return local->cycles = PBO_OK; }
int carCycle(carLocal_t *local) { return ++local->cycles > 0 ? PBO_OK : PBO_ERROR; }
int carSync(carLocal_t *local) { return local->cycles >= 0 ? PBO_OK : PBO_NO_EVENT; }
int carOff(carLocal_t *local) { return local->cycles >= 0 ? PBO_OK : PBO_ERROR; }
int carTerm(carLocal_t *local) { return local->cycles >= 0 ? PBO_OK : PBO_ERROR; }
