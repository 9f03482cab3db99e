// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/job_step.h"

#include <cstring>

#include "chimera/runtime/safety.h"

namespace chimera {
namespace {

std::uint64_t all_valid(const Task& task) noexcept {
  const std::size_t n = task.outputs.size();
  return n >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
}

void note_fault(Task& task, Method method, Nanoseconds at) noexcept {
  ++task.faults.count;
  task.faults.at = at;
  task.faults.method = method;
  if (task.faults.last.text[0] == '\0') std::strcpy(task.faults.last.text, "answered with a fault and gave no text");
}

// What the method said of its fault becomes the task's last one.
void take_fault(Task& task, Method method, Nanoseconds at) noexcept {
  task.said.text[CHIMERA_FAULT_TEXT - 1] = '\0';
  task.faults.last = task.said;
  note_fault(task, method, at);
}

Answer default_answer(Method method) noexcept { return method == Method::kError ? Answer::kFault : Answer::kOk; }

}  // namespace

// The halves below are put in place by force: at the length of a short cycle the calls themselves would show.
[[gnu::always_inline]] static inline void read_input(Input& input) noexcept {
  (void)input.group.latch();
  chimera_port& port = *input.port;
  port.slot = input.group.slot();
  port.bit = input.bit;
  port.value = const_cast<std::byte*>(input.group.values()) + input.offset;
}

// Groups produced elsewhere: once each, however many inputs look at them.
[[gnu::always_inline]] static inline void refresh_copies(Task& task) noexcept {
  for (LocalGroup* copy : task.copies)
    if (!copy->refresh()) ++task.profile.stale;
}

[[gnu::always_inline]] static inline void tell_running(Task& task, std::uint32_t method) noexcept {
  task.running->store((task.id.index + 1) << 8 | method, std::memory_order_relaxed);
}

void read_inputs(Task& task) noexcept {
  refresh_copies(task);
  for (Input& input : task.inputs) read_input(input);
}

void aim_outputs(Task& task) noexcept {
  std::byte* staging = task.group.staging();
  for (Output& output : task.outputs) output.port->value = staging + output.offset;
}

void record_fault(Task& task, Method method, const char* text, Nanoseconds at) noexcept {
  task.faults.last.code = 0;
  std::strncpy(task.faults.last.text, text, CHIMERA_FAULT_TEXT - 1);
  task.faults.last.text[CHIMERA_FAULT_TEXT - 1] = '\0';
  note_fault(task, method, at);
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
  tell_running(task, static_cast<std::uint32_t>(method));
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
  task.group.prefill();
  return true;
}

[[gnu::always_inline]] static inline Answer publish_in_place(Task& task, Method method, std::uint64_t valid,
                                                             Nanoseconds now) noexcept {
  if (task.has_safety && refuses_unsafe(task, method, now)) return Answer::kFault;
  task.valid = valid;
  task.group.publish(now, valid);
  task.group.prefill();
  std::byte* staging = task.group.staging();
  for (Output& output : task.outputs) output.port->value = staging + output.offset;
  return Answer::kOk;
}

Answer publish(Task& task, Method method, std::uint64_t valid, Nanoseconds now) noexcept {
  return publish_in_place(task, method, valid, now);
}

State follow_error(Task& task, Next at, Nanoseconds now) noexcept {
  while (at.kind == Next::Kind::kStep) {
    const StepRule& step = rule(at.step);
    if (step.before & kReadIn) read_inputs(task);
    Answer answer = call_method(task, step.method, now);
    if (answer == Answer::kOk && (step.after_ok & kWriteOut)) answer = publish(task, step.method, task.valid, now);
    if (answer != Answer::kOk) task.group.prefill();
    at = step.next[static_cast<int>(answer)];
  }
  task.state = at.state;
  return at.state;
}

// call_method for the one method that every component has and that runs all the time.
[[gnu::always_inline]] static inline BodyEnd call_cycle(Task& task, Nanoseconds at) noexcept {
  const chimera_method body = task.component->methods[CHIMERA_CYCLE];
  if (body == nullptr) return {};
  tell_running(task, CHIMERA_CYCLE);
  task.said.text[0] = '\0';
  task.said.code = 0;
  const std::int32_t value = body(task.instance, &task.call);
  if (value == CHIMERA_OK) [[likely]] return {};
  if (value == CHIMERA_PARTIAL) return {Answer::kOk, Method::kCycle, true};
  const Answer answer = answer_of(Method::kCycle, value);
  if (answer == Answer::kFault) take_fault(task, Method::kCycle, at);
  return {answer, Method::kCycle};
}

BodyEnd begin_cycle(Task& task, const CycleTime& time) noexcept {
  chimera_call& call = task.call;
  call.now_ns = time.release.count;
  call.dt_ns = (time.release - task.last_release).count;
  call.deadline_ns = time.deadline.count;
  call.dropped = time.dropped;
  call.illegal = time.illegal ? 1u : 0u;
  if (task.spec->aperiodic) {
    const Answer answer = call_method(task, Method::kSync, time.release);
    if (answer != Answer::kOk) return {answer, Method::kSync};
  }
  refresh_copies(task);
  for (Input& input : task.inputs) {
    read_input(input);
    input.port->seen = input.sequence;
    input.sequence = input.group.slot()->sequence;
  }
  return call_cycle(task, time.release);
}

State end_cycle(Task& task, BodyEnd body, const CycleTime& time, Nanoseconds end, bool may_publish) noexcept {
  const Step step = body.method == Method::kSync ? Step::kSync : Step::kCycle;
  Answer answer = body.answer;
  if (answer == Answer::kOk && may_publish) answer = publish_in_place(task, Method::kCycle, all_valid(task), end);
  else if (answer != Answer::kNoEvent) task.group.prefill();
  if (answer == Answer::kOk || answer == Answer::kAborted) {
    if (answer == Answer::kAborted) ++task.profile.aborted;
    else if (!may_publish) ++task.profile.held;
    if (answer == Answer::kOk && may_publish) {
      if (body.is_partial) ++task.profile.partial;
      ++task.profile.cycles;
      ++task.call.cycle;
      task.last_release = time.release;
    }
    return State::kOn;
  }
  if (answer == Answer::kNoEvent) return State::kOn;
  return follow_error(task, rule(step).next[static_cast<int>(answer)], end);
}

}  // namespace chimera
