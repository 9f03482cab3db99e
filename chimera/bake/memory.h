// SPDX-License-Identifier: Apache-2.0
// Memory that an image needs, as far as it is known before compiling: tables in flash; records, groups and constants in
// RAM. Code and the other members of components are known behind the compiler of the target only.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chimera/bake/target.h"
#include "chimera/runtime/application_spec.h"

namespace chimera::bake {

/// One task. Bytes of a 32-bit machine.
struct TaskMemoryNeed {
  std::size_t flash_bytes = 0;  ///< its tables
  std::size_t ram_bytes = 0;    ///< its record, live ports, out-vars and constants
  std::size_t float64_in = 0;   ///< numbers of type float64 that it reads in each cycle
  std::size_t float64_out = 0;  ///< that it writes
};

struct MemoryNeed {
  std::vector<TaskMemoryNeed> tasks;
  std::size_t record_bytes = 0;        ///< of each task, part of its ram_bytes: all that has a fixed size
  std::size_t shared_flash_bytes = 0;  ///< tables of no single task
  std::size_t shared_ram_bytes = 0;    ///< operator variables and given constants
  std::size_t stack_bytes = 0;         ///< both stacks

  std::size_t flash_bytes() const noexcept;
  std::size_t ram_bytes() const noexcept;  ///< with the stacks
};

/// RAM for switches in an image with more than one configuration: in all, for each task, for each variable.
inline constexpr std::size_t kSwitchBytes = 1024, kSwitchTaskBytes = 250, kSwitchVariableBytes = 290;
/// Instructions of the compiler's library on a core without double precision, as measured on a Cortex-M3.
inline constexpr std::size_t kDoubleAdd = 75, kDoubleMultiply = 53, kDoubleDivide = 581, kDoubleCompare = 49;
/// Longest slice of the shell, and cycles of the core for one instruction: an upper bound without wait states.
inline constexpr std::size_t kShellInstructions = 2000, kCyclesPerInstruction = 2;

/// RAM of the link to Linux: a frame of each direction. Context: setup.
std::size_t link_ram(const ApplicationSpec& part);
/// Context: setup.
MemoryNeed memory_need(const ApplicationSpec& spec, std::size_t n_acts, const Target& target);

}  // namespace chimera::bake
