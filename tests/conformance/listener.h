// SPDX-License-Identifier: Apache-2.0
// A boundary listener that records its calls.
#pragma once

#include <functional>
#include <vector>

#include "chimera/platform/clock.h"
#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/life/boundary_listener.h"

namespace chimera::toy {

class Listener final : public BoundaryListener {
 public:
  struct Miss {
    TaskId task, culprit;
    bool is_blocked = false;
    Nanoseconds told;
  };

  explicit Listener(const std::atomic<std::uint32_t>& bell) : BoundaryListener(bell) {}

  std::vector<Miss> of(TaskId task) const {
    std::vector<Miss> found;
    for (const Miss& miss : misses)
      if (miss.task == task) found.push_back(miss);
    return found;
  }

  void take(BoundarySignals& signals, Nanoseconds now) noexcept override {
    listen();
    if (on_take) on_take(signals, now);
  }
  void publish() noexcept override {}
  void told(const SignalReport&, Nanoseconds) noexcept override {}
  void missed(TaskId task, const MissCause::Verdict& verdict, Nanoseconds now) noexcept override {
    misses.push_back({task, verdict.culprit, verdict.is_blocked, now});
    if (on_miss) on_miss(task, verdict);
  }
  void hangs(TaskWord, Nanoseconds, Nanoseconds, Nanoseconds) noexcept override {}
  void gave_way(TaskId task, Nanoseconds, Nanoseconds) noexcept override {
    if (on_gave_way) on_gave_way(task);
  }
  void show(const Task&) noexcept override {}

  std::vector<Miss> misses;
  std::function<void(TaskId, const MissCause::Verdict&)> on_miss;
  std::function<void(BoundarySignals&, Nanoseconds)> on_take;
  std::function<void(TaskId)> on_gave_way;
};

}  // namespace chimera::toy
