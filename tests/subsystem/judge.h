// SPDX-License-Identifier: Apache-2.0
// Invariants of the simulation, checked at every event.
#pragma once

#include <span>
#include <vector>

#include "tests/subsystem/world.h"

namespace chimera::simulated {

class Judge {
 public:
  explicit Judge(ManagerState& world)
      : world_(world),
        turning_(world.n_tasks()),
        ended_(world.n_tasks()),
        debts_(world.n_tasks()),
        given_up_(Plan::kRtpus) {}

  /// A status word or a life of a process changed. Checks that no variable has two producers.
  void changed();
  /// After every event: the flag.
  void look();
  /// After the last event: nothing may be lost.
  void look_at_the_end();
  /// The ON set by the words, of processes that live by the keeper's page.
  std::vector<bool> on_as_seen() const;

  void stepped(const subsystem::Event& event, std::span<const subsystem::Action> actions);
  /// All its actions are carried out.
  void step_ended() { ended_.assign(ended_.size(), false); }
  void goal(const subsystem::RememberGoal& goal);
  void answered(const subsystem::CommandAnswer& answer, const Face& face);
  /// A face or a task wants the task created or ON: earlier promises that it stays down end.
  void asked_up(TaskId task) {
    debts_[task.index].no_on = debts_[task.index].no_spawn = false;
    debts_[task.index].asked_up = world_.now();
  }
  void requested(TaskId task) {
    asked_up(task);
    debts_[task.index].requested = world_.now();
  }
  void told(const subsystem::LogEvent& tell);
  /// True: it turns OFF what a transaction turned ON.
  bool sent(const subsystem::Send& send);
  /// A face or a task wants the task OFF or gone.
  void wanted_down(TaskId task);
  void asked_down(TaskId task, Signal signal) {
    debts_[task.index].on = false;
    if (signal == Signal::kKill) debts_[task.index].there = false;
  }
  void published(TaskId task, State state);
  void manager_dies();
  void process_dies(RtpuId rtpu);
  void process_hangs();
  bool is_turning() const noexcept;
  /// Tasks that are ON and produce a variable of the task.
  std::vector<TaskId> rivals(TaskId task) const;

 private:
  void count_revivals(const subsystem::Event& event, std::span<const subsystem::Action> actions);
  bool shares_output(TaskId a, TaskId b) const;
  bool is_on(TaskId task) const;
  void end_transaction(bool is_failed);
  bool is_excused(TaskId task) const;
  RtpuId rtpu_of(TaskId task) const { return world_.plan.spec.tasks[task.index].rtpu; }
  std::string name(TaskId task) const { return std::string(world_.plan.spec.tasks[task.index].name); }

  ManagerState& world_;
  std::vector<bool> turning_;  // `on` was sent, its transaction is not over
  std::vector<bool> ended_;    // its transaction is over, its result is not reported yet
  bool is_rolling_back_ = false;
  /// Debt to a task since its process died: it must be created or ON again, or an event must say why not.
  struct Debt {
    bool there = false;
    bool on = false;
    bool is_down = false;   ///< `off` or `kill` was sent since it went ON
    bool is_gone = false;   ///< `kill` was sent since it was created
    bool no_on = false;     ///< an answer promised that it is not turned ON
    bool no_spawn = false;  ///< nor spawned
    State last = State::kNotCreated;
    Signal sent = Signal::kSpawn;  ///< last by the manager
    Nanoseconds asked_up;   ///< last time at which a face or a task wanted it up
    Nanoseconds requested;  ///< when a task asked for it last
  };
  void promise(const subsystem::CommandAnswer& answer, const Face& face);
  bool is_awaited(TaskId task, Signal signal) const;
  void check_constants(TaskId task);
  std::vector<Debt> debts_;
  std::vector<std::uint32_t> given_up_;  // incarnation, by rtpu
};

}  // namespace chimera::simulated
