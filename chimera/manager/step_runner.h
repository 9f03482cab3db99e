// SPDX-License-Identifier: Apache-2.0
// Between the step function of the subsystem and what carries its actions out: hands events to it, sends its signals to
// the real-time units, its starts to the keeper, keeps what it must not forget, answers commands, logs.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "chimera/manager/manager_state.h"
#include "chimera/manager/rtpu_links.h"
#include "chimera/platform/local_socket.h"

namespace chimera::manager {

/// What became of a command.
using Answered = std::function<void(const subsystem::CommandAnswer&)>;

/// Context: setup; never blocks. Everything outlives it.
class StepRunner {
 public:
  StepRunner(ManagerState& world, RtpuLinks& fleet, Channel& keeper) : world_(world), fleet_(fleet), keeper_(keeper) {}
  StepRunner(const StepRunner&) = delete;
  StepRunner& operator=(const StepRunner&) = delete;

  /// The first step: with what a predecessor remembered in the manager's segment.
  void begin();
  /// One step, and its actions in order.
  void step(const subsystem::Event& event);
  /// A step for each of the events.
  void step(const Events& events) {
    for (const subsystem::Event& event : events) step(event);
  }
  /// When the step function is due though nothing happened.
  Nanoseconds next_due() const noexcept { return world_.logic.next_due(); }
  /// Steps when it is due.
  void look(Nanoseconds at) {
    if (next_due() <= at) step(subsystem::Tick{});
  }
  /// Asks for a signal; `answered` is called when it is over, maybe at once.
  void command(Signal signal, std::vector<TaskId> tasks, Answered answered);

 private:
  void carry_out(const subsystem::Send& send);
  void carry_out(const subsystem::StartRtpu& start);
  void carry_out(const subsystem::RememberGoal& goal);
  void carry_out(const subsystem::RememberHandled& handled);
  void carry_out(const subsystem::RememberRestart& restart);
  void carry_out(const subsystem::RememberStarted&);
  void carry_out(const subsystem::CommandAnswer& answer);
  void carry_out(const subsystem::LogEvent& event);

  ManagerMemory& memory() noexcept { return world_.own.block().memory(); }

  ManagerState& world_;
  RtpuLinks& fleet_;
  Channel& keeper_;
  std::map<std::uint64_t, Answered> waiting_;  // by number of the command
  std::uint64_t last_command_ = 0;
};

}  // namespace chimera::manager
