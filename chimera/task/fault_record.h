// SPDX-License-Identifier: Apache-2.0
// The last fault of a task, its last note, and their number. The job step writes it; other processes read it.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/state_machine.h"

namespace chimera {

/// Context: cycle; wait-free. `last.text` is always zero-terminated.
struct FaultRecord {
  std::uint64_t count = 0;
  Nanoseconds at;                 ///< of the last fault
  Method method = Method::kInit;  ///< that answered it
  chimera_fault last{};           ///< its code and text
  std::uint64_t told = 0;         ///< number of faults and notes
  std::uint64_t notes = 0;
  char note[CHIMERA_FAULT_TEXT] = {};  ///< the last one, zero-terminated
  std::uint64_t off_count = 0;         ///< faults that `off` or `kill` answered
  Method off_method = Method::kOff;    ///< that answered the last of them
  char off_text[CHIMERA_FAULT_TEXT] = {};
};

}  // namespace chimera
