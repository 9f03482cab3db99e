// SPDX-License-Identifier: Apache-2.0
// The one job step: transfer, method, check, publication. Every executor runs a cycle through these and adds
// only when it is released and how it waits.
//
//   begin_cycle   [sync] >in-var cycle             (virtual time: at first dispatch)
//   end_cycle     out-var> | error ...             (virtual time: at modelled completion)
//
// All copying and all checking of values is done by begin_cycle: it stages the last outputs before the method and looks
// at the safety ports after it. A clock read between the two halves therefore ends the execution time of the job with
// both transfers in it; what end_cycle adds is the store of the counter that makes the outputs visible, whatever their
// size (docs/decisions/0026-instructions-of-a-job.md).
#pragma once

#include "chimera/base/mechanisms.h"
#include "chimera/base/time.h"
#include "chimera/runtime/job/job_clock.h"
#include "chimera/runtime/task_word.h"
#include "chimera/task/task.h"

namespace chimera {

/// When and how a cycle runs.
struct CycleTime {
  Nanoseconds release;
  Nanoseconds deadline;       ///< absolute
  std::uint32_t dropped = 0;  ///< releases dropped since the last completed cycle
  bool illegal = false;       ///< the illegal-configuration flag, read once per job
};

/// Result of begin_cycle(), the input of end_cycle(). `method` is the one that answered last.
struct BodyEnd {
  Answer answer = Answer::kOk;
  Method method = Method::kCycle;
  bool is_partial = false;  ///< it gave up with a usable result

  /// It went to its end and made a whole result.
  bool is_good() const noexcept { return answer == Answer::kOk && !is_partial; }
};

/// Runs sync (aperiodic tasks) and cycle, and checks what they wrote. Publishes nothing. Requires: task.state == kOn.
/// Context: cycle; as long as the component's methods take.
BodyEnd begin_cycle(Task& task, const CycleTime& time) noexcept;

/// Publishes what a cycle made that went well: the second half of most jobs. Context: cycle; wait-free; O(1).
void publish_cycle(Task& task, const CycleTime& time, Nanoseconds end) noexcept;

/// The second half of any job. Publishes the outputs of an ok cycle, or handles its fault by the rules of the state
/// machine. `may_publish` false: a late cycle whose outputs are held. Returns the new state of the task. `clock` null:
/// the method error is not timed. Context: cycle.
State end_cycle(Task& task, BodyEnd body, const CycleTime& time, Nanoseconds end, bool may_publish,
                JobClock* clock) noexcept;

/// Points every in-var at its producer's latest publication. Context: cycle; wait-free; O(in-vars).
void read_inputs(Task& task) noexcept;

/// Stages the last published outputs and points the out-vars at them; before every method, so that what it does not
/// write stands. Context: cycle; wait-free; O(output bytes).
void stage_outputs(Task& task) noexcept;

/// Calls a method; one that the component does not have answers as docs/formats/component-abi.md says
/// (ok; error: not recovered). A fault is recorded with `at`. Context: that of the method.
Answer call_method(Task& task, Method method, Nanoseconds at) noexcept;

/// Checks safety ports and publishes the staged outputs. A refused value is recorded as a fault of `method`;
/// then nothing is published, the last good outputs stand, and the answer is kFault.
/// Context: cycle; wait-free; O(safety values).
Answer publish(Task& task, Method method, std::uint64_t valid, Nanoseconds now) noexcept;

/// Follows the steps that `first` starts until a state is reached, without any transfer of constants; for the
/// error handling of cycle, sync, on and off. `clock` as for end_cycle. Context: cycle.
State follow_error(Task& task, Next first, Nanoseconds now, JobClock* clock) noexcept;

/// Records a fault that the framework itself found. `text` is cut at CHIMERA_FAULT_TEXT - 1. Context: cycle; wait-free.
void record_fault(Task& task, Method method, const char* text, Nanoseconds at) noexcept;

/// Leaves a note of the task for the user; the next cycle boundary finds it as it finds a fault. `text` is cut at
/// CHIMERA_FAULT_TEXT - 1. Context: cycle; wait-free.
void record_note(Task& task, const char* text) noexcept;

/// Calls the background of the component. A fault is recorded as one of `method`, and then it is not called again.
/// Requires: task.background. Context: virtual time, or where kill may run; may block.
void run_background(Task& task, Method method, Nanoseconds at) noexcept;

// The part that every cycle of every task runs, put in place where it is used: as calls its three functions would cost
// about 40 of a job's 250 instructions (docs/decisions/0026-instructions-of-a-job.md). What a job needs only sometimes
// is called, in job_step.cc.
namespace cycle_step {

/// The halves of read_inputs(). Groups produced elsewhere: once each, however many inputs look at them.
[[gnu::always_inline]] inline void refresh_copies(Task& task) noexcept {
  if constexpr (mechanisms::kCopies)
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

/// Shows which method runs, for the process that finds this one dead.
[[gnu::always_inline]] inline void show_running(Task& task, std::uint32_t method) noexcept {
  task.running->store(TaskWord(task.id, method).word(), std::memory_order_relaxed);
}

/// sync() of an aperiodic task: kOk if there is an event.
Answer ask_sync(Task& task, Nanoseconds at) noexcept;
/// Judges a cycle that did not simply answer kOk, or that wrote to safety ports. Records its faults.
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
  if (mechanisms::kEvents && task.asks_sync) [[unlikely]]
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
  if (answer == CHIMERA_OK && !(mechanisms::kSafety && task.has_safety)) [[likely]] return {};
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

}  // namespace cycle_step

}  // namespace chimera
