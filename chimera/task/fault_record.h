// SPDX-License-Identifier: Apache-2.0
// The last fault of a task, its last note, and their number. The job step writes it; other processes read it.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "chimera/base/mechanisms.h"
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

  /// `off` or `kill` answered the fault in `last`.
  void keep_off() noexcept {
    ++off_count;
    off_method = method;
    std::memcpy(off_text, last.text, CHIMERA_FAULT_TEXT);
  }
};

/// As FaultRecord, where one method runs at a time and no other process reads: texts are of the last task only.
struct LeanFaultRecord {
  std::uint32_t count = 0, told = 0, notes = 0;
  Method method = Method::kInit;
  Nanoseconds at;
  static inline chimera_fault last{};
  static inline char note[CHIMERA_FAULT_TEXT] = {};

  void keep_off() noexcept {}
};

using TaskFaults = std::conditional_t<mechanisms::kCopies, FaultRecord, LeanFaultRecord>;
/// Where a method stores its fault: one for each task, or one for all.
using TaskSaid = std::conditional_t<mechanisms::kCopies, chimera_fault, chimera_fault&>;
inline constinit chimera_fault said_by_method{};

}  // namespace chimera
