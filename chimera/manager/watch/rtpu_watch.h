// SPDX-License-Identifier: Apache-2.0
// Watches the processes that do not watch the manager: rtpus, their running methods, the keeper and the guard.
// docs/formats/processes.md, "Who watches whom".
#pragma once

#include <memory>
#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/manager/watch/method_watch.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

/// Single-threaded. Context: setup; never blocks.
class RtpuWatch {
 public:
  explicit RtpuWatch(ManagerState& state);

  /// Time when look() is due.
  Nanoseconds due() const noexcept { return due_; }
  /// Checks all rtpus, the keeper and the guard, and reports changes. Records rtpus that do not run and methods that do
  /// not return. Returns the rtpus that must be killed.
  std::vector<RtpuId> look(Nanoseconds at);
  /// The keeper reports a manager that did not answer.
  void told(const KeeperMessage& hung, Nanoseconds at);

 private:
  struct Rtpu {
    std::uint32_t incarnation = 0;
    LifeWatch life;
    MethodWatch serving, at_edge, cycle, background{milliseconds(500), seconds(1)};
  };

  bool look_at_life(RtpuId rtpu, Nanoseconds at);
  void look_at_methods(RtpuId rtpu, Nanoseconds at);
  std::string look_at(LifeWatch& watch, const char* name, const LifeSample& sample);
  void tell(RtpuId rtpu, const MethodVerdict& verdict, Nanoseconds at);

  ManagerState& state_;
  std::vector<std::unique_ptr<Rtpu>> rtpus_;
  LifeWatch keeper_, guard_;
  Nanoseconds due_;
};

}  // namespace chimera::manager
