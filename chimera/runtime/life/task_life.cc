// SPDX-License-Identifier: Apache-2.0
// Carries out signals by the rules of the state machine.
#include "chimera/runtime/life/task_life.h"

#include <algorithm>
#include <cstring>

#include "chimera/runtime/life/task_set.h"

namespace chimera {
namespace {

// A signal to one task may begin before that to another one has ended.
constexpr bool kSignalsOverlap = mechanisms::kService || mechanisms::kConstants;

std::size_t place_of(TaskId task) noexcept { return kSignalsOverlap ? task.index : 0; }

bool has_changed_outputs(const Task& task) noexcept {
  return std::memcmp(task.group.staging(), task.group.published() + 1, task.group.payload_bytes()) != 0;
}

}  // namespace

void TaskLife::prepare(const ApplicationSpec& spec, SetupMemory& memory) {
  progress_ = memory.take<Progress>(kSignalsOverlap ? spec.tasks.size() : 1);
  judge_.prepare(spec, memory);
}

SignalReport TaskLife::start(Nanoseconds now) {
  const ApplicationSpec& spec = set_.spec();
  for (TaskId id : spec.init_order) {
    Task& task = set_.tasks()[id.index];
    if (task.state != State::kNotCreated || !judge_.rivals().is_created_at_start(id)) continue;
    SignalReport report = carry_out(id, Signal::kSpawn, now);
    if (task.state == State::kOff) continue;
    report.is_accepted = false;
    report.why = Refusal::kFault;
    return report;
  }
  std::size_t n_on = 0;  // when it was asked before
  while (n_on < spec.start.size() && set_.tasks()[spec.start[n_on].index].state == State::kOn) ++n_on;
  if (spec.start.empty()) {  // of a board: Linux turns its tasks ON
    SignalReport report;
    report.is_accepted = true;
    return report;
  }
  return signal(spec.start.subspan(n_on), Signal::kOn, now);
}

void TaskLife::turn_off_started(Nanoseconds now) {
  const auto start = set_.spec().start;
  for (std::size_t i = start.size(); i-- > 0;) {
    const Task& task = set_.tasks()[start[i].index];
    if (task.state == State::kOn || task.standing == Standing::kHalfOn) carry_out(start[i], Signal::kOff, now);
  }
}

void TaskLife::shut_down(Nanoseconds now) {
  const ApplicationSpec& spec = set_.spec();
  const auto tasks = set_.tasks();
  for (std::size_t i = spec.start.size(); i-- > 0;)
    if (tasks[spec.start[i].index].state == State::kOn) carry_out(spec.start[i], Signal::kOff, now);
  for (Task& task : tasks)
    if (task.state == State::kOn) carry_out(task.id, Signal::kOff, now);
  for (std::size_t i = spec.init_order.size(); i-- > 0;)
    if (tasks[spec.init_order[i].index].state != State::kNotCreated) carry_out(spec.init_order[i], Signal::kKill, now);
  set_.on_set_changed();
}

SignalReport TaskLife::signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) {
  SignalReport report;
  report.signal = signal;
  for (TaskId id : tasks) {
    const Task& task = set_.tasks()[id.index];
    report.task = id;
    report.before = report.after = task.shown_state();
    const bool is_due = signal == Signal::kOff && task.owes_off_before(signal);
    if (is_due || next(report.before, signal, task.spec->aperiodic).kind != Next::Kind::kImpossible) continue;
    report.why = Refusal::kState;
    return report;
  }
  report.why = judge_.judge(tasks, signal);
  if (report.why != Refusal::kNone) return report;
  for (TaskId id : tasks) {
    if (mechanisms::kStandbys && signal == Signal::kOff) set_.standbys().let_cool(id, true);
    report = carry_out(id, signal, now);
    if (signal != Signal::kOn || report.after == State::kOn) continue;
    if (report.why == Refusal::kNotYet) break;
    for (TaskId done : tasks) {  // one transaction: tasks that are ON already go OFF again
      if (done == id) break;
      carry_out(done, Signal::kOff, now);
    }
    report.is_accepted = false;
    report.why = Refusal::kFault;
    break;
  }
  set_.on_set_changed();
  return report;
}

SignalReport TaskLife::carry_out(TaskId id, Signal signal, Nanoseconds now) {
  Task& task = set_.tasks()[id.index];
  if (signal == Signal::kOn && task.is_warm()) return show(task);
  if (task.owes_off_before(signal)) {
    const SignalReport settled = settle_off(id, now);
    if (signal == Signal::kOff || next(task.state, signal, false).kind == Next::Kind::kImpossible) return settled;
  }
  Progress& progress = progress_[place_of(id)];
  progress = Progress{};
  progress.is_moved = is_moving_;
  progress.report = {true, false, Refusal::kNone, signal, id, task.state, task.state};
  task.call.now_ns = now.count;
  task.call.illegal = set_.flag().is_up() ? 1u : 0u;
  if (signal == Signal::kSpawn) {
    if (!set_.slow().is_there()) return go_on_constructed(task, set_.methods().construct(task, now), now);
    set_.slow().ask_construction(task);
    progress.report.is_deferred = true;
    return progress.report;
  }
  if (signal == Signal::kOn && task.state == State::kOff && !follow_constants(task, now)) return progress.report;
  if (signal == Signal::kOn) {
    task.call.cycle = 0;
    task.call.dropped = 0;
    task.call.dt_ns = task.spec->period.count;
  }
  return advance(task, next(task.state, signal, false), now);
}

// Other constants may have come into force since the task was initialised: it is re-initialised before `on`.
bool TaskLife::follow_constants(Task& task, Nanoseconds now) {
  if (!mechanisms::kConstants || !set_.constants().has_choice() || !set_.constants().uses_changed(task.id)) return true;
  const std::uint64_t faults = task.faults.count;
  (void)advance(task, next(State::kOff, Signal::kReinit, false), now);
  if (task.state == State::kOff && task.faults.count == faults) return true;
  SignalReport& report = progress_[place_of(task.id)].report;
  report.is_accepted = false;
  report.why = Refusal::kFault;
  return false;
}

SignalReport TaskLife::move(TaskId id, Signal signal, Nanoseconds now) {
  is_moving_ = true;
  const SignalReport report = carry_out(id, signal, now);
  is_moving_ = false;
  set_.on_set_changed();
  return report;
}

SignalReport TaskLife::arm(TaskId id, Nanoseconds now) {
  Task& task = set_.tasks()[id.index];
  is_arming_ = true;
  SignalReport report = carry_out(id, Signal::kOn, now);
  is_arming_ = false;
  report.is_accepted = task.state == State::kOn;
  if (report.is_accepted) {
    report.after = task.state = State::kOff;
    task.standing = Standing::kOwesOff;
  } else {
    if (report.why != Refusal::kNotYet) report.why = Refusal::kFault;
    task.forget_sent();
  }
  return report;
}

SignalReport TaskLife::warm_up(TaskId id, Nanoseconds now) {
  Task& task = set_.tasks()[id.index];
  const SignalReport report = arm(id, now);
  if (report) {
    task.forget_sent();
    task.state = State::kOn;
    task.standing = Standing::kWarm;
  }
  set_.on_set_changed();
  return report;
}

// Readers of the task's variables now read them from its group.
SignalReport TaskLife::show(Task& task) {
  task.standing = Standing::kPlain;
  set_.sources().take_outputs_of(task);
  return {true, false, Refusal::kNone, Signal::kOn, task.id, State::kOff, State::kOn};
}

SignalReport TaskLife::settle_off(TaskId id, Nanoseconds now) {
  Task& task = set_.tasks()[id.index];
  if (task.is_warm()) task.forget_sent();
  task.standing = Standing::kPlain;
  task.state = State::kOn;  // as `off` finds it
  return carry_out(id, Signal::kOff, now);
}

SignalReport TaskLife::finish_slow(TaskId id, Nanoseconds now) {
  Task& task = set_.tasks()[id.index];
  Progress& progress = progress_[place_of(id)];
  const SlowMethods::Outcome outcome = set_.slow().finish(task);
  if (outcome.is_construction) {
    (void)go_on_constructed(task, outcome.answer, now);
  } else {
    progress.used += outcome.used;
    advance(task, conclude(task, rule(progress.step), outcome.answer, now, read_clock(now)), now);
  }
  set_.on_set_changed();
  return progress.report;
}

// The state of the component is constructed, or is not: init is next.
SignalReport TaskLife::go_on_constructed(Task& task, Answer answer, Nanoseconds now) {
  SignalReport& report = progress_[place_of(task.id)].report;
  if (answer == Answer::kOk) return advance(task, next(State::kNotCreated, Signal::kSpawn, false), now);
  report.is_accepted = report.is_deferred = false;
  report.why = Refusal::kFault;
  return report;
}

SignalReport TaskLife::advance(Task& task, Next at, Nanoseconds now) {
  SignalReport& report = progress_[place_of(task.id)].report;
  report.is_deferred = !follow(task, at, now);
  report.after = task.state;
  if (!report.is_deferred && !set_.slow().is_there() && task.state == State::kNotCreated) set_.methods().destroy(task);
  if (!is_arming_) set_.sent().deliver(task);
  return report;
}

// Runs the steps that `at` starts until a state is reached (true), or until the service thread has the next one.
bool TaskLife::follow(Task& task, Next at, Nanoseconds now) {
  Progress& progress = progress_[place_of(task.id)];
  while (at.kind == Next::Kind::kStep) {
    const StepRule& step = rule(at.step);
    const Nanoseconds began = read_clock(now);
    progress.used = {};
    if (!before_step(task, step, now)) {
      at = step.next[static_cast<int>(Answer::kFault)];
      continue;
    }
    if (set_.slow().takes(step.method)) {
      progress.used = read_clock(now) - began;
      progress.step = at.step;
      set_.slow().ask(task, step.method);
      return false;
    }
    at = conclude(task, step, set_.methods().call_at_edge(task, step.method, now), now, began);
  }
  task.state = at.state;
  return true;
}

// The step `began` here, or here again after the service thread had it.
Next TaskLife::conclude(Task& task, const StepRule& step, Answer answer, Nanoseconds now, Nanoseconds began) {
  Progress& progress = progress_[place_of(task.id)];
  progress.has_new_constants = false;
  if (answer == Answer::kOk) answer = after_ok(task, step, now);
  task.profile.add_call(step.method, progress.used + (read_clock(now) - began));
  if (mechanisms::kConstants && progress.has_new_constants && !progress.is_moved) reinit_users(task.id, now);
  if (step.step == Step::kOn) task.standing = answer == Answer::kNotYet ? Standing::kHalfOn : Standing::kPlain;
  if (answer == Answer::kNotYet) {
    progress.report.is_accepted = false;
    progress.report.why = Refusal::kNotYet;
  }
  return step.next[static_cast<int>(answer)];
}

bool TaskLife::before_step(Task& task, const StepRule& step, Nanoseconds now) {
  if (step.before & kReadIn) read_inputs(task);
  stage_outputs(task);
  if (step.before & kReadOut) take_over(task, now);
  if (step.before & kReadConst) {
    FaultWords why;
    if (!set_.constants().give(task.id, why)) {
      record_fault(task, step.method, why.c_str(), now);
      return false;
    }
  }
  return true;
}

Answer TaskLife::after_ok(Task& task, const StepRule& step, Nanoseconds now) {
  if (step.after_ok & kWriteConst) {
    FaultWords why;
    if (!set_.constants().collect(task.id, why)) {
      record_fault(task, step.method, why.c_str(), now);
      return Answer::kFault;
    }
    progress_[place_of(task.id)].has_new_constants = set_.constants().has_new();
  }
  // Outputs that clear did not change keep the age of their publication.
  if (step.step == Step::kClear && !has_changed_outputs(task)) return Answer::kOk;
  if (step.after_ok & kWriteOut) {
    const bool turns_on = step.step == Step::kOn;
    const Answer answer = publish(task, step.method, turns_on ? valid_after_on(task) : task.valid, now);
    if (answer == Answer::kOk && turns_on && !is_arming_) set_.sources().take_outputs_of(task);
    return answer;
  }
  return Answer::kOk;
}

// Exactly the users of the constants that changed, in the order of initialisation; a circle is refused by
// verification, so this ends. Users in other contexts are sent the signal and compare for themselves.
void TaskLife::reinit_users(TaskId of, Nanoseconds now) {
  const ApplicationSpec& spec = set_.spec();
  for (TaskId id : spec.init_order) {
    if (id == of) continue;
    if (!set_.is_mine(id)) {
      const State there = set_.others()->state(id);
      if ((there == State::kOff || there == State::kOn) && spec.uses_constant_of(id, of))
        (void)set_.others()->post(Signal::kReinit, id, of, true);
      continue;
    }
    Task& user = set_.tasks()[id.index];
    const bool waits = user.in_service() || user.is_busy;
    if (waits && spec.uses_constant_of(id, of)) set_.sent().defer(user, Signal::kReinit);
    if (waits || (user.state != State::kOff && user.state != State::kOn)) continue;
    if (set_.constants().uses_changed(id)) (void)carry_out(id, Signal::kReinit, now);
  }
}

// >out-var: what a predecessor left is where this task starts from (2000 paper 5.1). Its age goes with the value.
void TaskLife::take_over(Task& task, Nanoseconds now) noexcept {
  taken_over_valid_ = 0;
  for (std::uint32_t i = 0; i < task.outputs.size(); ++i) {
    Output& output = task.outputs[i];
    output.port->slot = nullptr;
    const VariableId variable = output.spec->variable;
    const Source& source = set_.sources().source(variable);
    const chimera_slot* slot = set_.sources().latest(variable);
    if (slot == nullptr || !((slot->valid >> source.bit) & 1u)) continue;
    std::memcpy(task.group.staging() + output.offset, reinterpret_cast<const std::byte*>(slot + 1) + source.offset,
                output.bytes);
    taken_over_valid_ |= std::uint64_t{1} << i;
    if (!set_.sources().is_initial(variable, slot->sequence)) tell_inherited(task, i, *slot, now);
  }
}

void TaskLife::tell_inherited(Task& task, std::uint32_t output, const chimera_slot& slot, Nanoseconds now) noexcept {
  const Source& source = set_.sources().source(task.outputs[output].spec->variable);
  chimera_inherited& told = task.inherited[output];
  told.slot = slot;
  told.age_ns = std::max<std::int64_t>(now.count - slot.published_ns, 0);
  told.period_ns = 0;
  if (source.task.is_valid() && !set_.spec().tasks[source.task.index].aperiodic)
    told.period_ns = set_.spec().tasks[source.task.index].period.count;
  task.outputs[output].port->slot = &told.slot;
}

std::uint64_t TaskLife::valid_after_on(const Task& task) const noexcept {
  const TaskMemory& memory = set_.memory(task.id);
  std::uint64_t valid = taken_over_valid_ | memory.initial_valid();
  for (std::size_t i = 0; i < task.outputs.size(); ++i)
    if (!memory.is_unwritten(task, i)) valid |= std::uint64_t{1} << i;
  return valid;
}

Nanoseconds TaskLife::read_clock(Nanoseconds otherwise) const noexcept {
  JobClock* clock = set_.methods().clock();
  return clock == nullptr ? otherwise : clock->now();
}

}  // namespace chimera
