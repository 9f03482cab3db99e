/* SPDX-License-Identifier: Apache-2.0 */
/* Bumpless transfer: how a task that goes ON uses the value in its out-var. One rule for the C++ and the C interface.
 *
 * Before `on` the framework copies the last published value into each out-var. A predecessor published it, or an
 * earlier run of the task itself. The rule of the library:
 *   - published at most 2 periods of its producer ago, or at most 10 ms if that is longer: the value is the present
 *     command (handed over), and the task continues from it, so that readers see no step;
 *   - older: the plant has moved since, and the task begins from measured values, or from 0 if it measures nothing;
 *   - never published: the out-var holds its initial value, as at every first start.
 */
#ifndef CHIMERA_TASK_HANDOVER_H_
#define CHIMERA_TASK_HANDOVER_H_

#include <stddef.h>
#include <stdint.h>

#include "chimera/task/abi.h"

#define CHIMERA_HANDOVER_PERIODS 2
#define CHIMERA_HANDOVER_LEAST_NS 10000000

/* The inherited value of the out-var `port` at the present `on`; NULL: none was published. Context: any; wait-free. */
static inline const chimera_inherited* chimera_inherited_of(const chimera_port* port) {
  return (const chimera_inherited*)(const void*)port->slot;
}

/* 1 if the inherited value of the out-var `port` is the present command. Context: any; wait-free. */
static inline int chimera_is_handed_over(const chimera_port* port) {
  const chimera_inherited* const from = chimera_inherited_of(port);
  if (from == NULL) return 0;
  return from->age_ns <= CHIMERA_HANDOVER_LEAST_NS || from->age_ns <= CHIMERA_HANDOVER_PERIODS * from->period_ns;
}

#endif /* CHIMERA_TASK_HANDOVER_H_ */
