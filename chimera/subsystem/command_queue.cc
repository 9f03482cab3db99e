// SPDX-License-Identifier: Apache-2.0
// Judges, sends and answers the commands of clients other than `on`.
#include "chimera/subsystem/command_queue.h"

#include <algorithm>

namespace chimera::subsystem {

void CommandQueue::add(const Commanded& commanded) {
  Command command;
  command.id = commanded.id;
  command.signal = commanded.signal;
  command.arrived = state_.now;
  for (TaskId task : state_.sorted(commanded.tasks, takes_down(commanded.signal))) {
    Part part;
    part.task = task;
    part.before = state_.observed.state(task);
    command.parts.push_back(part);
  }
  commands_.push_back(std::move(command));
}

bool CommandQueue::advance() {
  bool changed = false;
  for (auto command = commands_.begin(); command != commands_.end();) {
    if (!command->is_begun && try_begin(*command, changed)) changed = true;
    const bool is_refused = !command->is_begun && command->refusal.is_refused();
    if (is_refused) state_.emit(CommandAnswer{command->id, command->refusal, command->failed_at, {}});
    const bool is_over = is_refused || (command->is_begun && try_finish(*command));
    changed = changed || is_over;
    command = is_over ? commands_.erase(command) : std::next(command);
  }
  return changed;
}

// Starts a command that may go. True if it began. `off` and `kill` take goals and transactions back at once, even if
// they must wait.
bool CommandQueue::try_begin(Command& command, bool& changed) {
  for (Part& part : command.parts)
    part.has_seen_spawning = part.has_seen_spawning || goals_.has(part.task, kGoalSpawn) ||
                             state_.observed.status(part.task).in_service;
  const bool waits = refuse_or_wait(command);
  if (command.refusal.is_refused()) return false;
  if (takes_down(command.signal)) changed = take_back(command) || changed;
  if (!waits) begin(command);
  return !waits;
}

// True if one of its tasks must wait. A command with a wrong task is refused as a whole.
bool CommandQueue::refuse_or_wait(Command& command) {
  bool waits = false;
  for (const Part& part : command.parts) {
    const Verdict verdict = judge(command, part);
    if (verdict == Verdict::kIllegal)
      fail(command, part.task,
           state_.illegal(command.signal, part.task, state_for(command.signal, part.task), tasks_of(command)));
    if (verdict == Verdict::kRival) fail(command, part.task, state_.rivalry(part.task, state_.find_rival(part.task)));
    if (verdict == Verdict::kNoAnswer) fail(command, part.task, state_.no_answer(part.task));
    waits = waits || verdict == Verdict::kWait;
  }
  return waits;
}

// The state in which the signal finds the task. While an `on` is under way, the task takes `off` after it.
State CommandQueue::state_for(Signal signal, TaskId task) const noexcept {
  const bool turns_on = takes_down(signal) && state_.pending.is_awaited(task, Signal::kOn);
  return turns_on && state_.observed.status(task).state == State::kOff ? State::kOn : state_.observed.state(task);
}

bool CommandQueue::is_revival(const Command& command, TaskId task) const noexcept {
  return command.signal == Signal::kSpawn || (command.signal == Signal::kClear && state_.observed.is_lost(task));
}

// True if a goal brought the task up while its `spawn` waited: the command is then fulfilled.
bool CommandQueue::is_spawned_meanwhile(const Command& command, const Part& part) const noexcept {
  const State state = state_.observed.state(part.task);
  return command.signal == Signal::kSpawn && part.has_seen_spawning && (state == State::kOff || state == State::kOn);
}

std::vector<TaskId> CommandQueue::tasks_of(const Command& command) {
  std::vector<TaskId> tasks;
  for (const Part& part : command.parts) tasks.push_back(part.task);
  return tasks;
}

// Time until which a command waits for a process that does not serve this manager; kNever: it does not wait.
Nanoseconds CommandQueue::due_for_rtpu(const Command& command, const Part& part) const noexcept {
  const RtpuLife life = state_.observed.life_of(part.task);
  if (goals_.is_pursued(part.task)) return kNever;
  if (life == RtpuLife::kUnknown) return std::max(command.arrived, state_.complete_since) + kAnswerLimit;
  if (life == RtpuLife::kStarting && !is_revival(command, part.task) && !state_.observed.is_lost(part.task))
    return state_.observed.since(state_.observed.rtpu(part.task)) + kStartLimit;
  return kNever;
}

// Time until which a `kill` waits for an `init` under way; kNever: it does not wait.
Nanoseconds CommandQueue::due_for_spawn(const Command& command, const Part& part) const noexcept {
  const bool waits = command.signal == Signal::kKill && state_.is_spawning(part.task);
  return waits ? command.arrived + kKillLimit : kNever;
}

CommandQueue::Verdict CommandQueue::judge(const Command& command, const Part& part) const {
  const Nanoseconds due = due_for_rtpu(command, part);
  if (due <= state_.now) return Verdict::kNoAnswer;
  if (due != kNever && !state_.observed.is_seen(part.task)) return Verdict::kWait;
  if (takes_down(command.signal)) return judge_taking_down(command, part, due != kNever);
  if (goals_.is_pursued(part.task) || state_.is_busy(part.task)) return Verdict::kWait;
  if (is_spawned_meanwhile(command, part)) return Verdict::kGo;
  if (command.signal == Signal::kSpawn && state_.observed.is_lost(part.task)) return Verdict::kGo;
  if (!is_legal(state_.observed.state(part.task), command.signal)) return Verdict::kIllegal;
  if (command.signal == Signal::kSpawn && state_.find_rival(part.task).is_valid()) return Verdict::kRival;
  return due == kNever || is_revival(command, part.task) ? Verdict::kGo : Verdict::kWait;
}

// True if `off` or `kill` can stop a cause that would bring the task up: a transaction, a goal, for `kill` also a spawn
// under way.
bool CommandQueue::can_be_taken_back(Signal signal, TaskId task) const {
  return transaction_.has(task) || goals_.is_pursued(task) || (signal == Signal::kKill && state_.is_spawning(task));
}

CommandQueue::Verdict CommandQueue::judge_taking_down(const Command& command, const Part& part,
                                                      bool waits_for_rtpu) const {
  const State state = state_for(command.signal, part.task);
  const bool is_kill = command.signal == Signal::kKill;
  // The task is OFF already, unless an `on` that was given up may still be carried out.
  const bool is_off = !is_kill && state == State::kOff && !state_.pending.is_possible(part.task, Signal::kOn);
  const bool can_go = is_off || is_legal(state, command.signal);
  if (!can_go && !part.is_taken_back && !can_be_taken_back(command.signal, part.task)) return Verdict::kIllegal;
  if (const Nanoseconds due = due_for_spawn(command, part); due != kNever)
    return state_.now < due ? Verdict::kWait : Verdict::kNoAnswer;
  if (!is_kill && part.is_taken_back && state_.pending.is_awaited(part.task, Signal::kOff)) return Verdict::kWait;
  return waits_for_rtpu && can_go ? Verdict::kWait : Verdict::kGo;
}

bool CommandQueue::take_back(Command& command) {
  bool changed = false;
  for (Part& part : command.parts) {
    part.is_taken_back = part.is_taken_back || can_be_taken_back(command.signal, part.task);
    changed = transaction_.withdraw(part.task, command.signal) || changed;
    changed = goals_.clear(part.task, command.signal == Signal::kKill ? kGoalSpawn | kGoalOn : kGoalOn) || changed;
    goals_.add(part.task, kGoalOff);
  }
  return changed;
}

void CommandQueue::begin(Command& command) {
  command.is_begun = true;
  for (Part& part : command.parts) {
    begin(command, part);
    part.after = state_.observed.state(part.task);
  }
  send(command);
}

void CommandQueue::begin(const Command& command, Part& part) {
  if (command.signal == Signal::kKill && state_.observed.is_lost(part.task)) {
    state_.observed.forget(part.task);
    goals_.set(part.task, kGoalGone);
    part.stage = Stage::kOver;
  } else if (is_spawned_meanwhile(command, part)) {
    part.stage = Stage::kOver;
  } else if (is_revival(command, part.task)) {
    revive(command, part);
  } else if (!is_legal(state_for(command.signal, part.task), command.signal)) {
    part.stage = Stage::kOver;  // no signal to send: taken back, or OFF already
    part.is_already = !part.is_taken_back;
  }
}

// Sets the goal of a task whose rtpu is dead. An rtpu that was given up gets a fresh budget of restarts.
void CommandQueue::revive(const Command& command, Part& part) {
  part.stage = Stage::kGoal;
  goals_.set(part.task, kGoalSpawn);
  const RtpuId rtpu = state_.observed.rtpu(part.task);
  if (state_.observed.life(rtpu) != RtpuLife::kDown) return;
  // `clear` of one task also spawns the other lost tasks of the rtpu, so that a later `on` of all finds them OFF.
  for (const TaskId task : state_.spec.on_order)
    if (command.signal == Signal::kClear && state_.observed.rtpu(task) == rtpu && state_.observed.is_wanted_back(task))
      goals_.set(task, kGoalSpawn);
  state_.observed.restarts(rtpu) = {};
  state_.emit(RememberRestart{rtpu, {}});
  state_.observed.starting(rtpu, state_.now);
  state_.emit(StartRtpu{rtpu});
}

// Sends the signal for the open tasks; neighbours of one rtpu go in one list.
void CommandQueue::send(Command& command) {
  auto& parts = command.parts;
  const auto is_open = [](const Part& part) { return part.stage == Stage::kOpen; };
  for (auto first = std::ranges::find_if(parts, is_open); first != parts.end();) {
    std::vector<TaskId> tasks;
    std::vector<Part*> sent;
    const RtpuId rtpu = state_.observed.rtpu(first->task);
    for (; first != parts.end() && (!is_open(*first) || state_.observed.rtpu(first->task) == rtpu); ++first) {
      if (!is_open(*first)) continue;
      tasks.push_back(first->task);
      sent.push_back(&*first);
    }
    const std::uint64_t number = state_.send(command.signal, tasks);
    for (Part* part : sent) {
      part->command = number;
      part->stage = Stage::kSent;
    }
  }
}

void CommandQueue::on_result(const SignalResult& result) {
  for (Command& command : commands_)
    for (Part& part : command.parts) {
      if (part.stage != Stage::kSent || part.task != result.task || part.command != result.command) continue;
      part.stage = Stage::kOver;
      part.before = result.before;
      part.after = result.after;
      if (!result.is_done()) fail(command, part.task, state_.named(result));
      return;
    }
}

void CommandQueue::on_rtpu_down(RtpuId rtpu, const std::string& cause) {
  for (Command& command : commands_)
    for (Part& part : command.parts) {
      if (part.stage != Stage::kGoal || state_.observed.rtpu(part.task) != rtpu) continue;
      goals_.clear(part.task, kGoalSpawn | kGoalOn);  // a task whose init kills its process is not tried again
      part.stage = Stage::kOver;
      fail(command, part.task, state_.ended(rtpu, cause));
    }
}

void CommandQueue::look_at_goals(Command& command) {
  for (Part& part : command.parts) {
    if (part.stage != Stage::kGoal || goals_.has(part.task, kGoalSpawn)) continue;
    part.stage = Stage::kOver;
    part.after = state_.observed.state(part.task);
    if (const SignalRefusal& why = goals_.failure(part.task); why.is_refused()) fail(command, part.task, why);
  }
}

// Keeps the first reason. A list that was refused as a whole gives its reason with only one of its tasks.
void CommandQueue::fail(Command& command, TaskId task, SignalRefusal why) {
  if (command.refusal.add(std::move(why))) command.failed_at = task;
}

bool CommandQueue::try_finish(Command& command) {
  look_at_goals(command);
  if (!std::ranges::all_of(command.parts, [](const Part& part) { return part.stage == Stage::kOver; })) return false;
  SignalRefusal& refusal = command.refusal;
  if (refusal.is_refused() && refusal.reason.empty())
    refusal.reason = state_.name(command.failed_at) + ": " + signal_name(command.signal) + " failed";
  CommandAnswer answer{command.id, refusal, command.failed_at, {}};
  for (const Part& part : command.parts)
    answer.outcomes.push_back({part.task, part.before, part.after, part.is_already});
  state_.emit(std::move(answer));
  return true;
}

Nanoseconds CommandQueue::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const Command& command : commands_)
    for (const Part& part : command.parts)
      if (!command.is_begun) next = std::min({next, due_for_rtpu(command, part), due_for_spawn(command, part)});
  return next;
}

}  // namespace chimera::subsystem
