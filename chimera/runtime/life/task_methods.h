// SPDX-License-Identifier: Apache-2.0
// Calls the methods of tasks except their cycles. Also constructs states, and begins and ends background methods and
// event sources.
#pragma once

#include <atomic>
#include <span>

#include "chimera/runtime/background_threads.h"
#include "chimera/runtime/job/job_clock.h"
#include "chimera/runtime/job/job_step.h"
#include "chimera/runtime/job/job_threads.h"
#include "chimera/runtime/safe_frame.h"
#include "chimera/runtime/state/task_memory.h"

namespace chimera {

/// Clock and threads for the methods of a context. All pointers of it outlive the tasks.
struct MethodRunner {
  JobClock* clock = nullptr;    ///< as methods see it; null: methods are not timed
  JobThreads* threads = nullptr;  ///< calls methods at cycle boundaries; null: the caller does
  /// Runs the background of components in its threads. Null: it runs once, before kill (and executors of virtual
  /// time run it).
  BackgroundThreads* writer = nullptr;
};

/// Context of everything not marked: cycle boundary, or the service thread; as long as the methods of components take.
class TaskMethods {
 public:
  /// Words that show other processes the present method (TaskWord, making.h). Written here, relaxed; pair with nothing,
  /// because a process reads them when it has found this one dead or hanging.
  struct Words {
    std::atomic<std::uint32_t>* at_edge = nullptr;
    std::atomic<std::uint32_t>* making = nullptr;
  };
  /// `safe_frames`: those of a task are taken back when its `off` or `kill` has ended well; null: there are none.
  /// Everything given outlives this. Context: setup.
  void prepare(std::span<TaskMemory> memories, const Words& words, SafeFrames* safe_frames = nullptr) noexcept {
    memories_ = memories;
    words_ = words;
    safe_frames_ = safe_frames;
  }
  /// Called by the executor, before anything is signalled. Context: setup.
  void run_by(const MethodRunner& runner) noexcept { runner_ = runner; }
  /// Null before run_by().
  JobClock* clock() const noexcept { return runner_.clock; }

  /// Makes the state of the component anew. A refusal is recorded as a fault of init.
  Answer construct(Task& task, Nanoseconds now);
  /// Destroys the state.
  void destroy(Task& task) noexcept { memories_[task.id.index].destroy(task); }
  /// Calls the method at a cycle boundary: in sight of other processes, and by JobThreads::call().
  Answer call_at_edge(Task& task, Method method, Nanoseconds now);
  /// Calls the method in the present thread.
  Answer call(Task& task, Method method, Nanoseconds now);
  /// Ends all activity beside the task. False: it hangs; then the instance must not be touched again, not even by kill.
  /// May block.
  bool end_background(Task& task, Nanoseconds now);

 private:
  Answer run(Task& task, Method method, Nanoseconds now, JobThreads* threads);
  bool begin_background(Task& task, Nanoseconds now);

  std::span<TaskMemory> memories_;
  Words words_;
  SafeFrames* safe_frames_ = nullptr;
  MethodRunner runner_;
};

}  // namespace chimera
