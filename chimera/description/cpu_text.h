// SPDX-License-Identifier: Apache-2.0
// The numbers of CPUs, and their names in messages.
#pragma once

#include <cstdint>
#include <string>

namespace chimera {

inline constexpr std::uint32_t kLastCpu = 1023;
/// The number of rtpu i, a board, among the CPUs is this and i: its load is no load of a CPU of Linux.
inline constexpr std::uint32_t kFirstBoardCpu = kLastCpu + 1;

/// "CPU 3", or "the board". Context: setup.
inline std::string cpu_text(std::uint32_t cpu) {
  return cpu < kFirstBoardCpu ? "CPU " + std::to_string(cpu) : "the board";
}

}  // namespace chimera
