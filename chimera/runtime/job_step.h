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
// size (docs/decisions/0018-execution-time.md).
#pragma once

#include "chimera/base/time.h"
#include "chimera/runtime/job_clock.h"
#include "chimera/task/task.h"

namespace chimera {

/// When and how a cycle runs.
struct CycleTime {
  Nanoseconds release;
  Nanoseconds deadline;       ///< absolute
  std::uint32_t dropped = 0;  ///< releases dropped since the last completed cycle
  bool illegal = false;       ///< the illegal-configuration flag, read once per job
};

/// What begin_cycle found, to be handed to end_cycle. `method` is the one that answered last.
struct BodyEnd {
  Answer answer = Answer::kOk;
  Method method = Method::kCycle;
  bool is_partial = false;  ///< it gave up with a result of use

  /// It went to its end and made a whole result.
  bool is_good() const noexcept { return answer == Answer::kOk && !is_partial; }
};

/// Runs sync (aperiodic tasks) and cycle, and checks what they wrote. Publishes nothing. Requires: task.state == kOn.
/// Context: cycle; as long as the component's methods take.
BodyEnd begin_cycle(Task& task, const CycleTime& time) noexcept;

/// Publishes what a cycle made that went well: the second half of most jobs. Context: cycle; wait-free; O(1).
void publish_cycle(Task& task, const CycleTime& time, Nanoseconds end) noexcept;

/// The second half of any job. Publishes what an ok cycle made (`may_publish` false: a late cycle that is held), or
/// handles its fault by the rules of the state machine. Returns the state the task is in afterwards. `clock` null: the
/// method error is not timed. Context: cycle.
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

/// Calls what the component does beside its cycles; a fault is recorded as one of `method`, and then it is not called
/// again. Requires: task.background. Context: virtual time, or where kill may run; may block.
void run_background(Task& task, Method method, Nanoseconds at) noexcept;

}  // namespace chimera
