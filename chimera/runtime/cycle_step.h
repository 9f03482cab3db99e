// SPDX-License-Identifier: Apache-2.0
// The part of the job step that every cycle of every task runs, put in place where it is used: as calls its three
// functions would cost about 40 of a job's 250 instructions (docs/decisions/0026-instructions-of-a-job.md).
// What a job needs only sometimes is called, in job_step.cc.
#pragma once

#include "chimera/runtime/job_step.h"
#include "chimera/runtime/task_word.h"

namespace chimera::cycle_step {

/// The halves of read_inputs(). Groups produced elsewhere: once each, however many inputs look at them.
[[gnu::always_inline]] inline void refresh_copies(Task& task) noexcept {
  for (LocalGroup* copy : task.copies)
    if (!copy->refresh()) ++task.profile.stale;
}
[[gnu::always_inline]] inline void read_input(Input& input) noexcept {
  (void)input.group.latch();
  chimera_port& port = *input.port;
  port.slot = input.group.slot();
  port.bit = input.bit;
  port.value = const_cast<std::byte*>(input.group.values()) + input.offset;
}

/// stage_outputs()
[[gnu::always_inline]] inline void stage(Task& task) noexcept {
  task.group.prefill();
  std::byte* staging = task.group.staging();
  for (Output& output : task.outputs) output.port->value = staging + output.offset;
}

/// Says which method runs, for whoever finds the process dead.
[[gnu::always_inline]] inline void show_running(Task& task, std::uint32_t method) noexcept {
  task.running->store(TaskWord(task.id, method).word(), std::memory_order_relaxed);
}

/// sync() of an aperiodic task: kOk when there is an event.
Answer ask_sync(Task& task, Nanoseconds at) noexcept;
/// What a cycle that did not simply answer kOk, or that wrote to safety ports, comes to. Puts down its faults.
BodyEnd judge_body(Task& task, std::int32_t answer, Nanoseconds at) noexcept;

/// begin_cycle()
[[gnu::always_inline]] inline BodyEnd begin(Task& task, const CycleTime& time) noexcept {
  chimera_call& call = task.call;
  call.now_ns = time.release.count;
  call.dt_ns = (time.release - task.last_release).count;
  call.deadline_ns = time.deadline.count;
  call.dropped = time.dropped;
  call.illegal = time.illegal ? 1u : 0u;
  stage(task);
  if (task.asks_sync) [[unlikely]]
    if (const Answer answer = ask_sync(task, time.release); answer != Answer::kOk) return {answer, Method::kSync};
  refresh_copies(task);
  for (Input& input : task.inputs) {
    read_input(input);
    input.port->seen = input.sequence;
    input.sequence = input.group.slot()->sequence;
  }
  if (task.cycle == nullptr) [[unlikely]] return {};
  show_running(task, CHIMERA_CYCLE);
  task.said.text[0] = '\0';
  task.said.code = 0;
  const std::int32_t answer = task.cycle(task.instance, &call);
  if (answer == CHIMERA_OK && !task.has_safety) [[likely]] return {};
  return judge_body(task, answer, time.release);
}

/// publish_cycle()
[[gnu::always_inline]] inline void publish(Task& task, const CycleTime& time, Nanoseconds end) noexcept {
  task.valid = task.all_outputs;
  task.group.publish(end, task.valid);
  ++task.profile.cycles;
  ++task.call.cycle;
  task.last_release = time.release;
}

}  // namespace chimera::cycle_step
