// SPDX-License-Identifier: Apache-2.0
// Connects the step function of the subsystem to the processes. It passes events to the step function, sends signals to
// rtpus and starts to the keeper, remembers, answers commands, and logs.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "chimera/manager/act/rtpu_links.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/platform/local_socket.h"

namespace chimera::manager {

/// Called with the result of a command.
using Answered = std::function<void(const subsystem::CommandAnswer&)>;

/// Context: setup; never blocks. All arguments outlive it.
class StepRunner {
 public:
  StepRunner(ManagerState& state, RtpuLinks& links, Channel& keeper) : state_(state), links_(links), keeper_(keeper) {}
  StepRunner(const StepRunner&) = delete;
  StepRunner& operator=(const StepRunner&) = delete;

  /// The first step, with the memory of a predecessor in the manager's segment.
  void begin();
  /// One step, and its actions in order.
  void step(const subsystem::Event& event);
  /// A step for each of the events.
  void step(const Events& events) {
    for (const subsystem::Event& event : events) step(event);
  }
  /// Time when the step function is due if no event arrives.
  Nanoseconds next_due() const noexcept { return state_.logic.next_due(); }
  /// Steps if the step function is due.
  void look(Nanoseconds at) {
    if (next_due() <= at) step(subsystem::Tick{});
  }
  /// A person switches; call it before the switch is asked for.
  void note_switch(const TaskBits& on, const TaskBits& off) { step(subsystem::PersonSwitches{on, off}); }
  /// Requests a signal; calls `answered` when it is over, maybe at once.
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

  ManagerMemory& memory() noexcept { return state_.own.block().memory(); }

  ManagerState& state_;
  RtpuLinks& links_;
  Channel& keeper_;
  std::map<std::uint64_t, Answered> waiting_;  // by number of the command
  std::uint64_t last_command_ = 0;
};

}  // namespace chimera::manager
