/* SPDX-License-Identifier: Apache-2.0 */
/* Stands before the values of every slot of a group, and beside every local copy of one: docs/formats/table.md. */
#ifndef CHIMERA_TABLE_SLOT_HEADER_H_
#define CHIMERA_TABLE_SLOT_HEADER_H_

#include <stdint.h>

typedef struct chimera_slot {
  int64_t published_ns; /* clock of the executor; 0 with sequence 0 */
  uint64_t sequence;    /* publications of the group so far; 0 = never */
  uint64_t valid;       /* bit i: out-var i of the producing task has been written or has an initial value */
  uint64_t reserved;
} chimera_slot;

#endif /* CHIMERA_TABLE_SLOT_HEADER_H_ */
