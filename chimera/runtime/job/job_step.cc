// SPDX-License-Identifier: Apache-2.0
// Reads inputs, calls a method, takes its faults, checks safety ports and publishes the outputs.
#include "chimera/runtime/job/job_step.h"

#include <atomic>
#include <cstring>

#include "chimera/runtime/job/safety.h"

namespace chimera {
namespace {

void note_fault(Task& task, Method method, Nanoseconds at) noexcept {
  ++task.faults.count;
  ++task.faults.told;
  task.has_news = true;
  task.faults.at = at;
  task.faults.method = method;
  if (task.faults.last.text[0] == '\0') std::strcpy(task.faults.last.text, "answered with a fault and gave no text");
  if (method != Method::kOff && method != Method::kKill) return;
  task.faults.keep_off();
}

// The method's report of its fault becomes the last fault of the task.
void take_fault(Task& task, Method method, Nanoseconds at) noexcept {
  task.said.text[CHIMERA_FAULT_TEXT - 1] = '\0';
  task.faults.last = task.said;
  note_fault(task, method, at);
}

Answer default_answer(Method method) noexcept { return method == Method::kError ? Answer::kFault : Answer::kOk; }

}  // namespace

void read_inputs(Task& task) noexcept {
  cycle_step::refresh_copies(task);
  for (Input& input : task.inputs) cycle_step::read_input(input);
}

void stage_outputs(Task& task) noexcept { cycle_step::stage(task); }

void record_fault(Task& task, Method method, const char* text, Nanoseconds at) noexcept {
  task.faults.last.code = 0;
  std::strncpy(task.faults.last.text, text, CHIMERA_FAULT_TEXT - 1);
  task.faults.last.text[CHIMERA_FAULT_TEXT - 1] = '\0';
  note_fault(task, method, at);
}

void record_note(Task& task, const char* text) noexcept {
  TaskFaults& record = task.faults;
  task.has_news = true;
  std::size_t size = 0;
  while (size + 1 < sizeof record.note && text[size] != '\0') ++size;
  std::memcpy(record.note, text, size);
  record.note[size] = '\0';
  ++record.notes;
  ++record.told;
}

void run_background(Task& task, Method method, Nanoseconds at) noexcept {
  chimera_fault fault{};
  if (task.background(task.instance, &fault) == CHIMERA_OK) return;
  task.background = nullptr;
  fault.text[CHIMERA_FAULT_TEXT - 1] = '\0';
  record_fault(task, method, fault.text, at);
}

Answer call_method(Task& task, Method method, Nanoseconds at) noexcept {
  const chimera_method body = task.component->methods[static_cast<int>(method)];
  if (body == nullptr) return default_answer(method);
  cycle_step::show_running(task, static_cast<std::uint32_t>(method));
  task.said.text[0] = '\0';
  task.said.code = 0;
  const Answer answer = answer_of(method, body(task.instance, &task.call));
  // An error() that does not recover adds nothing to the fault that called it.
  if (answer == Answer::kFault && method != Method::kError) take_fault(task, method, at);
  return answer;
}

// True when a safety port refused a value: then that is a fault, and the last good outputs stand.
static bool refuses_unsafe(Task& task, Method method, Nanoseconds now) noexcept {
  char text[CHIMERA_FAULT_TEXT];
  if (is_safe(task, text)) return false;
  ++task.profile.rejected;
  record_fault(task, method, text, now);
  return true;
}

Answer publish(Task& task, Method method, std::uint64_t valid, Nanoseconds now) noexcept {
  if (mechanisms::kSafety && task.has_safety && refuses_unsafe(task, method, now)) return Answer::kFault;
  task.valid = valid;
  task.group.publish(now, valid);
  return Answer::kOk;
}

namespace {

// Shows the method while it runs. Relaxed, pairs with nothing: it is only reported.
Answer call_beside_cycle(Task& task, Method method, Nanoseconds at) noexcept {
  std::atomic_ref(task.job_method).store(method, std::memory_order_relaxed);
  const Answer answer = call_method(task, method, at);
  std::atomic_ref(task.job_method).store(Method::kCycle, std::memory_order_relaxed);
  return answer;
}

}  // namespace

State follow_error(Task& task, Next at, Nanoseconds now, JobClock* clock) noexcept {
  while (at.kind == Next::Kind::kStep) {
    const StepRule& step = rule(at.step);
    const Nanoseconds began = clock == nullptr ? now : clock->now();
    if (step.before & kReadIn) read_inputs(task);
    stage_outputs(task);
    Answer answer = call_beside_cycle(task, step.method, now);
    if (answer == Answer::kOk && (step.after_ok & kWriteOut)) answer = publish(task, step.method, task.valid, now);
    const Nanoseconds ended = clock == nullptr ? now : clock->now();
    task.profile.execution[static_cast<int>(step.method)].add(ended - began);
    at = step.next[static_cast<int>(answer)];
  }
  task.state = at.state;
  return at.state;
}

BodyEnd begin_cycle(Task& task, const CycleTime& time) noexcept { return cycle_step::begin(task, time); }

Answer cycle_step::ask_sync(Task& task, Nanoseconds at) noexcept {
  return call_beside_cycle(task, Method::kSync, at);
}

BodyEnd cycle_step::judge_body(Task& task, std::int32_t value, Nanoseconds at) noexcept {
  BodyEnd body;
  body.is_partial = value == CHIMERA_PARTIAL;
  if (value != CHIMERA_OK && !body.is_partial) body.answer = answer_of(Method::kCycle, value);
  if (body.answer == Answer::kFault) take_fault(task, Method::kCycle, at);
  if (mechanisms::kSafety && body.answer == Answer::kOk && task.has_safety && refuses_unsafe(task, Method::kCycle, at))
    body.answer = Answer::kFault;
  return body;
}

void publish_cycle(Task& task, const CycleTime& time, Nanoseconds end) noexcept {
  cycle_step::publish(task, time, end);
}

State end_cycle(Task& task, BodyEnd body, const CycleTime& time, Nanoseconds end, bool may_publish,
                JobClock* clock) noexcept {
  switch (body.answer) {
    case Answer::kNoEvent:
      return State::kOn;
    case Answer::kAborted:
      add_to(task.profile.aborted, 1);
      return State::kOn;
    case Answer::kOk:
      if (!may_publish) {
        ++task.profile.held;
        return State::kOn;
      }
      if (body.is_partial) ++task.profile.partial;
      publish_cycle(task, time, end);
      return State::kOn;
    case Answer::kNotYet:  // of no cycle
    case Answer::kFault:
      break;
  }
  const Step step = body.method == Method::kSync ? Step::kSync : Step::kCycle;
  return follow_error(task, rule(step).next[static_cast<int>(Answer::kFault)], end, clock);
}

}  // namespace chimera
