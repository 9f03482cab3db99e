// SPDX-License-Identifier: Apache-2.0
// A task and its present activity in one word, (task + 1) << 8 | what. A process shows such words in
// BlockHead::running, serving, at_edge, background and hung, and in DecisionPage::making. Another process reads the
// word after it found the first one dead or hanging; it may be anything then.
#pragma once

#include <cstdint>

#include "chimera/base/ids.h"
#include "chimera/task/signal.h"

namespace chimera {

/// Plain value. Context of everything: any; wait-free.
class TaskWord {
 public:
  /// Numbers of `what` that are no methods: the task's shared object is opened, its background method runs.
  static constexpr std::uint32_t kOpening = 254, kInBackground = 255;

  /// Nothing is under way: the word 0.
  constexpr TaskWord() noexcept = default;
  constexpr TaskWord(TaskId task, std::uint32_t what) noexcept : word_((task.index + 1) << 8 | what) {}
  constexpr TaskWord(TaskId task, Method method) noexcept : TaskWord(task, static_cast<std::uint32_t>(method)) {}
  /// A word as it was read.
  static constexpr TaskWord found(std::uint32_t word) noexcept {
    TaskWord made;
    made.word_ = word;
    return made;
  }

  constexpr std::uint32_t word() const noexcept { return word_; }
  constexpr bool is_none() const noexcept { return word_ == 0; }
  /// Not valid if the word names no task. May be the number of a task that does not exist.
  constexpr TaskId task() const noexcept { return TaskId((word_ >> 8) - 1); }
  constexpr std::uint32_t what() const noexcept { return word_ & 255u; }
  /// True if `what` is one of the nine methods.
  constexpr bool has_method() const noexcept { return task().is_valid() && what() < CHIMERA_METHODS; }
  /// Requires: has_method().
  constexpr Method method() const noexcept { return static_cast<Method>(what()); }

 private:
  std::uint32_t word_ = 0;
};

}  // namespace chimera
