// SPDX-License-Identifier: Apache-2.0
// Sources of events beside rings: interrupt lines of a microcontroller, descriptors on Linux.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/task/task.h"

namespace chimera {

/// Read by the executive at each tick (RunOptions::tick).
class EventInputs {
 public:
  /// Number of events of the task since the last call; 0 for a task without an input. `waits`: an event of the task is
  /// not answered yet; an input that stays up until `sync` has read it gives no event then. Context: cycle; wait-free.
  virtual std::uint32_t take(const Task& task, bool waits) noexcept = 0;

 protected:
  ~EventInputs() = default;
};

/// An interrupt line: its handler calls count() and nothing else. Not copyable, because the handler knows its address.
class InterruptLine {
 public:
  InterruptLine() noexcept = default;
  explicit InterruptLine(TaskId task) noexcept : task_(task) {}
  InterruptLine(const InterruptLine&) = delete;
  InterruptLine& operator=(const InterruptLine&) = delete;

  /// The task whose events come on this line; not valid: none. Context: setup.
  void lead_to(TaskId task) noexcept { task_ = task; }
  TaskId task() const noexcept { return task_; }
  /// One event. Only one handler (or thread) calls it. Context: interrupt; wait-free.
  void count() noexcept { count_.store(count_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed); }
  /// Number of events since the last call, exact for up to 2^32 - 1 events. Context: cycle; wait-free.
  std::uint32_t take() noexcept {
    const std::uint32_t count = count_.load(std::memory_order_relaxed), fresh = count - taken_;
    taken_ = count;
    return fresh;
  }

 private:
  TaskId task_;
  std::atomic<std::uint32_t> count_{0};  // relaxed, pairs with nothing: `sync` reads the device itself
  std::uint32_t taken_ = 0;
};

/// Lines whose events interrupt handlers count.
class InterruptLines final : public EventInputs {
 public:
  /// `lines` outlive this. Context: setup.
  explicit InterruptLines(std::span<InterruptLine> lines) noexcept : lines_(lines) {}
  std::uint32_t take(const Task& task, bool /*waits*/) noexcept override {
    std::uint32_t fresh = 0;
    for (InterruptLine& line : lines_)
      if (line.task() == task.id) fresh += line.take();
    return fresh;
  }

 private:
  std::span<InterruptLine> lines_;
};

}  // namespace chimera
