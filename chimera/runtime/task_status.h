// SPDX-License-Identifier: Apache-2.0
// The state of a task as its process shows it to others, in one word.
#pragma once

#include <cstdint>

#include "chimera/task/state_machine.h"

namespace chimera {

/// State of a task in one word: bits 0-7 State, bit 8 service (init or kill under way), bits 32-63 incarnation.
struct TaskStatus {
  State state = State::kNotCreated;
  bool in_service = false;
  std::uint32_t incarnation = 0;

  constexpr bool operator==(const TaskStatus&) const noexcept = default;
  constexpr std::uint64_t word() const noexcept {
    return static_cast<std::uint64_t>(incarnation) << 32 | (in_service ? 256u : 0u) | static_cast<std::uint64_t>(state);
  }
  /// Would an owner write it?
  static constexpr bool is_one(std::uint64_t word) noexcept { return of(word).word() == word; }
  /// A word that no owner would write reads as ERROR.
  static constexpr TaskStatus of(std::uint64_t word) noexcept {
    const auto state = word & 255u;
    return {state < kStates ? static_cast<State>(state) : State::kError, (word & 256u) != 0,
            static_cast<std::uint32_t>(word >> 32)};
  }
};

}  // namespace chimera
