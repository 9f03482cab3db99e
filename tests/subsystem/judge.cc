// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/judge.h"

#include <algorithm>

#include "tests/subsystem/driver.h"
#include "tests/subsystem/face.h"
#include "tests/subsystem/keeper.h"
#include "tests/subsystem/process.h"

namespace chimera::simulated {

using namespace subsystem;

bool Judge::is_on(TaskId task) const { return world_.process_of(task).state(task) == State::kOn; }

bool Judge::shares_output(TaskId a, TaskId b) const {
  for (const Variable& variable : world_.variables.all()) {
    const auto makes = [&](TaskId task) {
      return std::any_of(variable.producers.begin(), variable.producers.end(),
                         [task](const PortOf& port) { return port.task == task; });
    };
    if (makes(a) && makes(b)) return true;
  }
  return false;
}

std::vector<TaskId> Judge::rivals(TaskId task) const {
  std::vector<TaskId> found;
  for (std::size_t t = 0; t < world_.n_tasks(); ++t)
    if (TaskId(t) != task && is_on(TaskId(t)) && shares_output(task, TaskId(t))) found.push_back(TaskId(t));
  return found;
}

void Judge::changed() {
  ++world_.changes;
  for (const auto& process : world_.processes) process->look_soon();
  for (const Variable& variable : world_.variables.all()) {
    const auto n = std::count_if(variable.producers.begin(), variable.producers.end(),
                                 [this](const PortOf& port) { return is_on(port.task); });
    if (n > 1) world_.fail("two tasks that are ON produce " + std::string(variable.name));
  }
}

std::vector<bool> Judge::on_as_seen() const {
  std::vector<bool> on(world_.n_tasks());
  for (std::size_t t = 0; t < on.size(); ++t)
    on[t] = world_.keeper->is_alive(world_.plan.spec.tasks[t].rtpu) &&
            world_.process_of(TaskId(t)).word(TaskId(t)).state == State::kOn;
  return on;
}

void Judge::look() {
  bool has_looked = false;
  for (const auto& process : world_.processes) {
    if (process->has_flag()) return;
    has_looked = has_looked || (process->is_alive() && process->seen_changes() == world_.changes);
  }
  if (has_looked && !world_.variables.is_legal(on_as_seen())) world_.fail("the ON set is illegal and no flag is up");
}

void Judge::count_revivals(const Event& event, std::span<const Action> actions) {
  const auto* command = std::get_if<Commanded>(&event);
  if (command == nullptr) return;
  for (const Action& action : actions) {
    if (std::holds_alternative<RememberRestart>(action))
      world_.tally.count(std::string("revived by ") + signal_name(command->signal));
    const auto* goal = std::get_if<RememberGoal>(&action);
    if (goal != nullptr && goal->goal != 0 && command->signal == Signal::kKill)
      world_.tally.count("killed while dead");
  }
}

// A goal ends when the task reaches it, when a face takes it back, or with an event or answer about it.
void Judge::stepped(const Event& event, std::span<const Action> actions) {
  count_revivals(event, actions);
  bool says_something = std::holds_alternative<RtpuDown>(event);
  for (const Action& action : actions)
    if (std::holds_alternative<LogEvent>(action) || std::holds_alternative<subsystem::CommandAnswer>(action))
      says_something = true;
  if (says_something) return;
  const auto* report = std::get_if<Reported>(&event);
  for (const Action& action : actions) {
    const auto* goal = std::get_if<RememberGoal>(&action);
    if (goal == nullptr || is_excused(goal->task)) continue;
    const std::uint32_t gone = world_.keeper->memory.goals[goal->task.index] & ~goal->goal;
    const State state = world_.driver->subsystem().state(goal->task);
    const bool is_spawned = report != nullptr && report->task == goal->task && report->signal == Signal::kSpawn;
    if ((gone & kGoalSpawn) != 0 && state == State::kNotCreated && !is_spawned)
      world_.fail("the goal spawn of " + name(goal->task) + " is lost without a word");
    if ((gone & kGoalOn) != 0 && state != State::kOn)
      world_.fail("the goal on of " + name(goal->task) + " is lost without a word");
  }
}

// True if a face wants the task OFF.
bool Judge::is_excused(TaskId task) const {
  return std::any_of(world_.faces.begin(), world_.faces.end(),
                     [task](const auto& face) { return face->wants_down(task); });
}

bool Judge::is_turning() const noexcept { return std::find(turning_.begin(), turning_.end(), true) != turning_.end(); }

bool Judge::sent(const Send& send) {
  bool is_roll_back = false;
  for (TaskId task : send.tasks) {
    if (send.signal == Signal::kOff || send.signal == Signal::kKill) wanted_down(task);
    if (send.signal == Signal::kKill) debts_[task.index].is_gone = true;
    debts_[task.index].sent = send.signal;
    if (send.signal == Signal::kOff && turning_[task.index] && !is_excused(task)) is_roll_back = true;
    const Debt& debt = debts_[task.index];
    if (send.signal == Signal::kSpawn) check_constants(task);
    if (send.signal == Signal::kSpawn && debt.no_spawn) world_.fail(name(task) + " is spawned against a promise");
    if (send.signal == Signal::kOn && debt.no_on) world_.fail(name(task) + " is turned ON against a promise");
    if (send.signal != Signal::kOn) continue;
    turning_[task.index] = true;
    for (TaskId rival : rivals(task))
      world_.fail("on is sent to " + name(task) + " while " + name(rival) + " produces the same and is ON");
  }
  if (is_roll_back) world_.tally.count("transaction rolled back");
  is_rolling_back_ = is_rolling_back_ || is_roll_back;
  return is_roll_back;
}

void Judge::goal(const RememberGoal& goal) {
  if ((goal.goal & kGoalOn) != 0 || !turning_[goal.task.index]) return;
  turning_[goal.task.index] = false;
  ended_[goal.task.index] = true;
}

void Judge::answered(const subsystem::CommandAnswer& answer, const Face& face) {
  end_transaction(!answer.is_accepted());
  promise(answer, face);
  if (!answer.is_accepted()) return;
  for (const auto& outcome : answer.outcomes) {
    if (face.signal() == Signal::kOn && outcome.after != State::kOn) world_.fail("on is accepted and a task is not ON");
    if (face.signal() == Signal::kKill && outcome.after != State::kNotCreated)
      world_.fail("kill is accepted and a task is there");
  }
}

bool Judge::is_awaited(TaskId task, Signal signal) const {
  return std::any_of(world_.faces.begin(), world_.faces.end(), [&](const auto& face) {
    const auto& tasks = face->tasks();
    return face->is_waiting() && face->signal() == signal && std::find(tasks.begin(), tasks.end(), task) != tasks.end();
  });
}

// After an answer that a task is OFF or gone, or that its init ended the process, it must not come back by itself.
void Judge::promise(const subsystem::CommandAnswer& answer, const Face& face) {
  const bool met_death = answer.refusal.kind == RefusalKind::kEnded;
  const bool was_deadly = met_death && face.signal() == Signal::kSpawn;
  for (TaskId task : face.tasks()) {
    const bool is_done = answer.is_accepted() || (met_death && rtpu_of(task) == rtpu_of(answer.at));
    const bool goes_down = is_done && (face.signal() == Signal::kOff || face.signal() == Signal::kKill);
    const bool is_there = world_.process_of(task).word(task).state != State::kNotCreated;
    Debt& debt = debts_[task.index];
    if (goes_down && debt.requested + seconds(10) < world_.now() && debt.asked_up < face.asked_at()) {
      debt.no_on = !is_awaited(task, Signal::kOn);
      debt.no_spawn = face.signal() == Signal::kKill && (!is_there || met_death) && !is_awaited(task, Signal::kSpawn) &&
                      !is_awaited(task, Signal::kClear);
    }
    if (was_deadly && !is_there && task == answer.at)
      debt.no_spawn = !is_awaited(task, Signal::kSpawn) && !is_awaited(task, Signal::kClear);
  }
}

void Judge::check_constants(TaskId task) {
  const auto& tasks = world_.plan.spec.tasks;
  for (const PortSpec& in : tasks[task.index].ports)
    for (std::size_t m = 0; in.kind == CHIMERA_IN_CONST && m < tasks.size(); ++m)
      for (const PortSpec& out : tasks[m].ports)
        if (out.kind == CHIMERA_OUT_CONST && out.constant == in.constant && TaskId(m) != task &&
            (world_.keeper->memory.goals[m] & kGoalSpawn) != 0 && world_.defect != Defect::kForgetsGoals &&
            world_.process_of(TaskId(m)).word(TaskId(m)).state == State::kNotCreated)
          world_.fail(name(task) + " is spawned before " + name(TaskId(m)) + ", which makes a constant of it");
}

void Judge::told(const LogEvent& tell) {
  if (tell.kind == "rtpu-given-up") given_up_[tell.rtpu.index] = world_.keeper->incarnation(tell.rtpu);
  for (std::size_t t = 0; t < debts_.size(); ++t) {
    const bool is_meant = tell.task == TaskId(t) || (tell.kind == "rtpu-given-up" && rtpu_of(TaskId(t)) == tell.rtpu);
    if (is_meant) debts_[t].there = false;
    if (is_meant || tell.kind == "refused" || tell.kind == "rtpu-given-up") debts_[t].on = false;
  }
  const bool is_failed = tell.kind == "refused";
  const auto says = [&](const char* words) { return tell.text.find(words) != std::string::npos; };
  if (is_failed && says(" ended ") && !says("is not restarted") && !says("on sent by"))
    world_.fail("goals are given up because a process died: " + tell.text);
  if (is_failed || tell.kind == "started" || tell.kind == "signal") end_transaction(is_failed);
}

void Judge::end_transaction(bool is_failed) {
  for (std::size_t t = 0; t < ended_.size(); ++t) {
    const TaskId task(t);
    const Process& process = world_.process_of(task);
    const bool goes_off = process.is_hung() || process.is_sent(Signal::kOff, task);  // when it answers again
    if (ended_[t] && is_failed && is_on(task) && !is_excused(task) && !goes_off)
      world_.fail("a transaction failed and " + name(task) + " stays ON");
    ended_[t] = false;
  }
  if (!is_turning()) is_rolling_back_ = false;
}

void Judge::manager_dies() {
  turning_.assign(turning_.size(), false);
  ended_.assign(ended_.size(), false);
  is_rolling_back_ = false;
  for (TaskId task : world_.plan.spec.init_order) asked_up(task);  // the next manager may finish its last step
}

void Judge::wanted_down(TaskId task) {
  debts_[task.index].on = false;
  debts_[task.index].is_down = true;
}

void Judge::published(TaskId task, State state) {
  Debt& debt = debts_[task.index];
  if (state != State::kNotCreated) debt.there = debt.no_spawn = false;  // tasks spawn each other too
  if (state == State::kOn) debt.on = false;
  if (state != State::kNotCreated && debt.last == State::kNotCreated) debt.is_gone = false;
  if (state == State::kOn && debt.last != State::kOn) debt.is_down = false;
  debt.last = state;
  if (state == State::kError) debt.on = false;
}

void Judge::process_dies(RtpuId rtpu) {
  for (std::size_t t = 0; t < debts_.size(); ++t) {
    const TaskId task(t);
    if (rtpu_of(task) != rtpu) continue;
    const State last = world_.process_of(task).word(task).state;
    const bool is_wanted = !is_excused(task) && !debts_[t].is_gone;
    const bool goes_off = debts_[t].is_down || debts_[t].sent == Signal::kOff || turning_[t];
    if (last != State::kNotCreated && is_wanted) debts_[t].there = true;
    if (last == State::kOn && is_wanted && !goes_off) debts_[t].on = true;
    debts_[t].last = State::kNotCreated;
  }
  if (is_rolling_back_) world_.tally.count("death in a rollback");
  else if (is_turning()) world_.tally.count("death in a transaction");
}

void Judge::process_hangs() {
  if (is_turning()) world_.tally.count("hang in a transaction");
}

void Judge::look_at_the_end() {
  if (!world_.driver->is_alive()) return world_.fail("no manager at the end");
  const Subsystem& subsystem = world_.driver->subsystem();
  if (!subsystem.is_settled()) world_.fail("not settled at the end");
  for (const auto& face : world_.faces)
    if (face->is_waiting()) world_.fail("a command is never answered");
  for (std::size_t r = 0; r < Plan::kRtpus; ++r)
    if (!world_.processes[r]->is_alive() && given_up_[r] != world_.processes[r]->incarnation())
      world_.fail("an rtpu is dead and no event says that it is given up");
  for (std::size_t t = 0; t < world_.n_tasks(); ++t) {
    const TaskId task(t);
    if (debts_[t].there && world_.process_of(task).state(task) == State::kNotCreated)
      world_.fail(name(task) + " is lost: its process died and it did not come back");
    if (debts_[t].on && world_.process_of(task).state(task) == State::kOff)
      world_.fail(name(task) + " was ON when its process died and did not go ON again");
    const std::uint32_t goal = world_.keeper->memory.goals[t];
    if ((goal & (kGoalSpawn | kGoalOn)) != 0) world_.fail("the goal of " + name(task) + " is neither reached nor told");
    const Process& process = world_.process_of(task);
    const State last = process.word(task).state;
    const bool is_lost = !process.is_alive() && last != State::kNotCreated && goal == 0;
    const State truth = is_lost ? State::kError : process.state(task);
    // A task that died again before it came back is missing too, though its last status does not show it.
    const bool is_missed = !process.is_alive() && subsystem.state(task) == State::kError && goal == 0;
    if (subsystem.state(task) != truth && !is_missed)
      world_.fail(name(task) + " is said to be " + state_name(subsystem.state(task)) + " and is " + state_name(truth));
  }
}

}  // namespace chimera::simulated
