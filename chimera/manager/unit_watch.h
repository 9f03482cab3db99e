// SPDX-License-Identifier: Apache-2.0
// Watches the processes that do not watch the manager: the real-time units, what each of them is at, and the keeper.
// docs/formats/processes.md, "Who watches whom".
#pragma once

#include <memory>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/manager/method_watch.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera::manager {

/// Single-threaded. Context: setup; never blocks.
class UnitWatch {
 public:
  explicit UnitWatch(ManagerState& world);

  /// When look() is due.
  Nanoseconds due() const noexcept { return due_; }
  /// Looks at everybody, tells what is new, says in the records who does not run and what does not end. The units with
  /// which there is no more patience.
  std::vector<RtpuId> look(Nanoseconds at);
  /// What the keeper says of a manager that did not answer.
  void told(const KeeperMessage& hung, Nanoseconds at);

 private:
  struct Unit {
    std::uint32_t incarnation = 0;
    LifeWatch life;
    MethodWatch serving, at_edge, cycle, background{milliseconds(500), seconds(1)};
  };

  bool look_at_life(RtpuId rtpu, Nanoseconds at);
  void look_at_methods(RtpuId rtpu, Nanoseconds at);
  void look_at_keeper(Nanoseconds at);
  void tell(RtpuId rtpu, const MethodVerdict& verdict, Nanoseconds at);

  ManagerState& world_;
  std::vector<std::unique_ptr<Unit>> units_;
  LifeWatch keeper_;
  Nanoseconds due_;
};

}  // namespace chimera::manager
