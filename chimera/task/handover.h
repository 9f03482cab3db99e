/* SPDX-License-Identifier: Apache-2.0 */
/* Bumpless transfer: what a task that goes ON does with the value that stands in its out-var, in one place for the C++
 * and the C interface.
 *
 * Before `on` the framework puts into each out-var what was published last, by a predecessor or by an earlier run of
 * the task itself. The rule of the library:
 *   - published at most 2 periods of its producer ago, or at most 10 ms where that is longer: the value is the present
 *     command (handed over), and the task goes on from it, so that readers see no step;
 *   - older: the plant has moved on since, and the task begins from what it measures, or from 0 where it measures
 *     nothing;
 *   - published by nobody: the out-var holds its initial value, as at every first start.
 */
#ifndef CHIMERA_TASK_HANDOVER_H_
#define CHIMERA_TASK_HANDOVER_H_

#include <stddef.h>
#include <stdint.h>

#include "chimera/task/abi.h"

#define CHIMERA_HANDOVER_PERIODS 2
#define CHIMERA_HANDOVER_LEAST_NS 10000000

/* What the out-var `port` was given at the present `on`; NULL: no task had published it. Context: any; wait-free. */
static inline const chimera_inherited* chimera_inherited_of(const chimera_port* port) {
  return (const chimera_inherited*)(const void*)port->slot;
}

/* 1 when the out-var `port` was given a value that is the present command. Context: any; wait-free. */
static inline int chimera_is_handed_over(const chimera_port* port) {
  const chimera_inherited* const from = chimera_inherited_of(port);
  if (from == NULL) return 0;
  return from->age_ns <= CHIMERA_HANDOVER_LEAST_NS || from->age_ns <= CHIMERA_HANDOVER_PERIODS * from->period_ns;
}

#endif /* CHIMERA_TASK_HANDOVER_H_ */
