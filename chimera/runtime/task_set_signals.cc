// SPDX-License-Identifier: Apache-2.0
// The signalling half of TaskSet: one signal, the steps it starts, and what follows for the other tasks.
#include <cstring>

#include "chimera/runtime/making.h"
#include "chimera/runtime/task_set.h"
#include "chimera/runtime/task_word.h"
#include "chimera/task/background.h"
#include "chimera/task/event_source.h"

namespace chimera {

Result<void> TaskSet::start(Nanoseconds now) {
  for (TaskId id : spec_.init_order) {
    carry_out(id, Signal::kSpawn, now);
    const Task& task = tasks_[id.index];
    if (task.state != State::kOff)
      return Error{ErrorCode::kRefused, {std::string("init: ") + task.faults.last.text}, {task.spec->name}};
  }
  const SignalReport report = signal(spec_.start, Signal::kOn, now);
  if (!report.is_accepted) return Error{ErrorCode::kRefused, {explain(report)}, {spec_.name}};
  return {};
}

void TaskSet::shut_down(Nanoseconds now) {
  for (std::size_t i = spec_.start.size(); i-- > 0;)
    if (tasks_[spec_.start[i].index].state == State::kOn) carry_out(spec_.start[i], Signal::kOff, now);
  for (Task& task : tasks_)
    if (task.state == State::kOn) carry_out(task.id, Signal::kOff, now);
  for (std::size_t i = spec_.init_order.size(); i-- > 0;)
    if (tasks_[spec_.init_order[i].index].state != State::kNotCreated)
      carry_out(spec_.init_order[i], Signal::kKill, now);
  on_set_changed();
}

SignalReport TaskSet::signal(TaskId task, Signal signal, Nanoseconds now) {
  return this->signal({&task, 1}, signal, now);
}

SignalReport TaskSet::signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now) {
  SignalReport report;
  report.signal = signal;
  for (TaskId id : tasks) {
    const Task& task = tasks_[id.index];
    report.task = id;
    report.before = report.after = task.state;
    if (next(task.state, signal, task.spec->aperiodic).kind != Next::Kind::kImpossible) continue;
    report.why = Refusal::kState;
    return report;
  }
  // With others only the manager turns tasks ON: it has judged the whole set.
  if (signal == Signal::kOn && place_.others == nullptr && !would_be_legal(tasks)) {
    report.why = Refusal::kIllegalSet;
    return report;
  }
  for (TaskId id : tasks) {
    report = carry_out(id, signal, now);
    if (signal != Signal::kOn || report.after == State::kOn) continue;
    for (TaskId done : tasks) {  // one transaction: whoever is ON already goes OFF again
      if (done == id) break;
      carry_out(done, Signal::kOff, now);
    }
    report.is_accepted = false;
    report.why = Refusal::kFault;
    break;
  }
  on_set_changed();
  return report;
}

bool TaskSet::would_be_legal(std::span<const TaskId> tasks) noexcept {
  for (const Task& task : tasks_) wanted_[task.id.index] = task.state == State::kOn;
  for (TaskId id : tasks) wanted_[id.index] = true;
  return variables_->is_legal(wanted_);
}

std::string TaskSet::explain(const SignalReport& report) const {
  if (report.is_accepted) return {};
  if (report.why == Refusal::kIllegalSet) return variables_->explain(wanted_, spec_.tasks);
  const Task& task = tasks_[report.task.index];
  const std::string what = signal_name(report.signal);
  if (report.why == Refusal::kFault) return what + ": " + std::string(task.spec->name) + ": " + task.faults.last.text;
  return what + " is not legal for " + std::string(task.spec->name) + " in state " + state_name(report.before);
}

SignalReport TaskSet::carry_out(TaskId id, Signal signal, Nanoseconds now) {
  Task& task = tasks_[id.index];
  Serving& serving = serving_[id.index];
  serving = Serving{};
  serving.report = {true, false, Refusal::kNone, signal, id, task.state, task.state};
  task.call.now_ns = now.count;
  task.call.illegal = is_illegal() ? 1u : 0u;
  if (signal == Signal::kSpawn) {
    serving.constructs = true;
    if (place_.service == nullptr) {
      serving.answer = construct(task, now);
      return served(id, now);
    }
    hand_over(task, Step::kInit);
    serving.report.is_deferred = true;
    return serving.report;
  }
  if (signal == Signal::kOn) {
    task.call.cycle = 0;
    task.call.dropped = 0;
    task.call.dt_ns = task.spec->period.count;
  }
  return advance(task, next(task.state, signal, false), now);
}

SignalReport TaskSet::served(TaskId id, Nanoseconds now) {
  Task& task = tasks_[id.index];
  Serving& serving = serving_[id.index];
  task.in_service = false;
  if (!serving.constructs) {
    advance(task, conclude(task, rule(serving.step), serving.answer, now, read(clock_, now)), now);
  } else if (serving.constructs = false; serving.answer == Answer::kOk) {
    advance(task, next(State::kNotCreated, Signal::kSpawn, false), now);
  } else {
    serving.report.is_accepted = serving.report.is_deferred = false;
    serving.report.why = Refusal::kFault;
  }
  if (place_.service != nullptr) on_set_changed();
  return serving.report;
}

SignalReport TaskSet::advance(Task& task, Next at, Nanoseconds now) {
  SignalReport& report = serving_[task.id.index].report;
  report.is_deferred = !follow(task, at, now);
  report.after = task.state;
  if (!report.is_deferred && place_.service == nullptr && task.state == State::kNotCreated)
    memories_[task.id.index].destroy(task);
  deliver(task);
  return report;
}

// Runs the steps that `at` starts until a state is reached (true), or until the service thread has the next one.
bool TaskSet::follow(Task& task, Next at, Nanoseconds now) {
  while (at.kind == Next::Kind::kStep) {
    const StepRule& step = rule(at.step);
    const Nanoseconds began = read(clock_, now);
    serving_[task.id.index].used = {};
    if (!before_step(task, step, now)) {
      at = step.next[static_cast<int>(Answer::kFault)];
      continue;
    }
    if (is_served(step.method)) {
      serving_[task.id.index].used = read(clock_, now) - began;
      hand_over(task, at.step);
      return false;
    }
    at = conclude(task, step, run_method(task, step.method, now, clock_), now, began);
  }
  task.state = at.state;
  return true;
}

// The step `began` here, or here again after the service thread had it.
Next TaskSet::conclude(Task& task, const StepRule& step, Answer answer, Nanoseconds now, Nanoseconds began) {
  Serving& serving = serving_[task.id.index];
  serving.has_new_constants = false;
  if (answer == Answer::kOk) answer = after_ok(task, step, now);
  task.profile.execution[static_cast<int>(step.method)].add(serving.used + (read(clock_, now) - began));
  if (serving.has_new_constants) reinit_users(task.id, now);
  return step.next[static_cast<int>(answer)];
}

Answer TaskSet::run_method(Task& task, Method method, Nanoseconds now, JobClock* clock) {
  if (method == Method::kKill) task.descriptor = -1;
  if (method == Method::kKill && !end_background(task, now)) return Answer::kFault;
  MethodGate* gate = clock == clock_ ? gate_ : nullptr;  // not on the service thread
  const bool is_at_edge = task.running != place_.serving;
  if (is_at_edge)
    place_.at_edge->store(TaskWord(task.id, method).word(), std::memory_order_relaxed);
  if (gate != nullptr) gate->open(task.id);
  Answer answer = call_method(task, method, now);
  if (gate != nullptr) gate->close(task.id);
  if (is_at_edge) place_.at_edge->store(0, std::memory_order_relaxed);
  if (method == Method::kInit && answer == Answer::kOk && !begin_background(task, now)) answer = Answer::kFault;
  const chimera_event_source source = event_source_of(*task.component);
  if (method == Method::kInit && answer == Answer::kOk && source != nullptr) task.descriptor = source(task.instance);
  return answer;
}

Answer TaskSet::construct(Task& task, Nanoseconds now) {
  show_making(*place_.making, task.id.index, Making::kConstructs);
  const auto constructed = memories_[task.id.index].construct(task, now);
  show_made(*place_.making);
  if (constructed) return Answer::kOk;
  record_fault(task, Method::kInit, constructed.error().message.c_str(), now);
  return Answer::kFault;
}

bool TaskSet::begin_background(Task& task, Nanoseconds now) {
  task.background = background_of(*task.component);
  const std::uint32_t tag = TaskWord(task.id, TaskWord::kInBackground).word();
  if (task.background == nullptr || writer_ == nullptr) return true;
  if (writer_->add(task.instance, task.background, tag)) return true;
  task.background = nullptr;
  record_fault(task, Method::kInit, "there is no thread for its background", now);
  return false;
}

// False: it hangs. Then the instance is not touched any more, not even by kill.
bool TaskSet::end_background(Task& task, Nanoseconds now) {
  if (task.background == nullptr) return true;
  if (writer_ == nullptr) {
    run_background(task, Method::kKill, now);
    task.background = nullptr;
    return true;
  }
  task.background = nullptr;
  chimera_fault fault{};
  const BackgroundWriter::End end = writer_->remove(task.instance, fault);
  if (end != BackgroundWriter::End::kDone) record_fault(task, Method::kKill, fault.text, now);
  if (end != BackgroundWriter::End::kStalled) return true;
  memories_[task.id.index].abandon(task);
  return false;
}

// A task that is being killed is ON no more, whatever its kill does.
void TaskSet::hand_over(Task& task, Step step) {
  serving_[task.id.index].step = step;
  if (task.state == State::kOn) task.state = State::kOff;
  task.in_service = true;
  place_.service->ask(task.id);
}

void TaskSet::serve(TaskId id, JobClock& clock) {
  Task& task = tasks_[id.index];
  Serving& serving = serving_[id.index];
  contexts_[id.index].clock = &clock;
  task.running = place_.serving;
  if (serving.constructs) {
    task.running->store(TaskWord(id, Method::kInit).word(), std::memory_order_relaxed);
    serving.answer = construct(task, clock.now());
  } else {
    const Method method = rule(serving.step).method;
    const Nanoseconds began = clock.now();
    serving.answer = run_method(task, method, began, &clock);
    serving.used += clock.now() - began;
    if (method == Method::kKill) memories_[id.index].destroy(task);
  }
  place_.serving->store(0, std::memory_order_relaxed);
  task.running = place_.running;
  contexts_[id.index].clock = nullptr;
}

bool TaskSet::before_step(Task& task, const StepRule& step, Nanoseconds now) {
  if (step.before & kReadIn) read_inputs(task);
  stage_outputs(task);
  if (step.before & kReadOut) take_over(task);
  if (step.before & kReadConst) {
    read_foreign_constants();
    FixedString<160> why;
    if (!memories_[task.id.index].read_constants(constants_, why) || !lists_fit(task, why)) {
      record_fault(task, step.method, why.c_str(), now);
      return false;
    }
  }
  return true;
}

Answer TaskSet::after_ok(Task& task, const StepRule& step, Nanoseconds now) {
  TaskMemory& memory = memories_[task.id.index];
  if (step.after_ok & kWriteConst) {
    const int changed = memory.write_constants(constants_, task.id);
    FixedString<160> why;
    if (!memory.fix_extents(constants_, why) || !lists_fit(task, why)) {
      record_fault(task, step.method, why.c_str(), now);
      return Answer::kFault;
    }
    if (place_.others != nullptr) publish_constants(task);
    serving_[task.id.index].has_new_constants = changed > 0;
  }
  if (step.after_ok & kWriteOut) {
    const bool turns_on = step.step == Step::kOn;
    const Answer answer = publish(task, step.method, turns_on ? valid_after_on(task) : task.valid, now);
    if (answer == Answer::kOk && turns_on) bindings_.take_outputs_of(task);
    return answer;
  }
  return Answer::kOk;
}

// >out-var: what a predecessor left is where this task starts from (2000 paper 5.1).
void TaskSet::take_over(Task& task) noexcept {
  taken_over_valid_ = 0;
  for (std::uint32_t i = 0; i < task.outputs.size(); ++i) {
    const VariableId variable = variables_->output(task.id, i);
    const Source& source = bindings_.source(variable);
    const chimera_slot* slot = bindings_.latest(variable);
    if (slot == nullptr || !((slot->valid >> source.bit) & 1u)) continue;
    std::memcpy(task.group.staging() + task.outputs[i].offset,
                reinterpret_cast<const std::byte*>(slot + 1) + source.offset, task.outputs[i].bytes);
    taken_over_valid_ |= std::uint64_t{1} << i;
  }
}

std::uint64_t TaskSet::valid_after_on(const Task& task) const noexcept {
  const TaskMemory& memory = memories_[task.id.index];
  std::uint64_t valid = taken_over_valid_ | memory.initial_valid();
  for (std::size_t i = 0; i < task.outputs.size(); ++i)
    if (!memory.is_unwritten(task, i)) valid |= std::uint64_t{1} << i;
  return valid;
}

}  // namespace chimera
