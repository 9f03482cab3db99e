// SPDX-License-Identifier: Apache-2.0
// Which of the last 64 cycles of a task missed their deadlines, and whether `tolerate` allows a miss among them.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include "chimera/base/mechanisms.h"
#include "chimera/base/shared_word.h"
#include "chimera/task/task_spec.h"

namespace chimera {

/// Written at the end of jobs, by the thread of the task. Context: cycle; wait-free.
class MissHistory {
 public:
  /// Adds the cycle that has just ended. True when at most M of the last N cycles, this one included, missed their
  /// deadlines.
  bool add(bool missed, const TaskSpec& spec) noexcept {
    const std::uint64_t now = last_.load(std::memory_order_relaxed) << 1 | (missed ? 1u : 0u);
    last_.store(now, std::memory_order_relaxed);
    return is_within(now, spec);
  }
  /// As add() of a miss, which is not added. Also by the supervisor.
  bool would_tolerate(const TaskSpec& spec) const noexcept {
    return is_within(last_.load(std::memory_order_relaxed) << 1 | 1u, spec);
  }

 private:
  static bool is_within(std::uint64_t last, const TaskSpec& spec) noexcept {
    const std::uint32_t n = spec.tolerated_of;
    const std::uint64_t window = n >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
    return n > 0 && static_cast<std::uint32_t>(std::popcount(last & window)) <= spec.tolerated_misses;
  }

  // Of each cycle one bit, the latest the lowest, 1: the deadline was missed. Relaxed, pairs with nothing: written at
  // the end of jobs, read by the supervisor to see whether a miss is tolerated.
  SharedWord<std::uint64_t> last_{0};
};

/// In an image without reactions, which tolerates no miss.
struct NoMissHistory {
  bool add(bool, const TaskSpec&) noexcept { return false; }
  bool would_tolerate(const TaskSpec&) const noexcept { return false; }
};
using TaskMisses = std::conditional_t<mechanisms::kReactions, MissHistory, NoMissHistory>;

}  // namespace chimera
