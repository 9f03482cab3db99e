// SPDX-License-Identifier: Apache-2.0
// The methods that may take long and may block, init and kill, and the construction of a task before init: run by the
// service thread (runtime/service.h), where there is one.
#pragma once

#include <atomic>
#include <span>

#include "chimera/base/mechanisms.h"
#include "chimera/runtime/life/task_host.h"
#include "chimera/runtime/life/task_methods.h"
#include "chimera/runtime/service.h"

namespace chimera {

/// One request at a time for each task. A cycle boundary asks, the service thread runs, a cycle boundary finishes. The
/// queues of the service thread order the data that both threads touch.
class SlowMethods {
 public:
  /// Result of a construction or a method.
  struct Outcome {
    bool is_construction = false;  ///< else a method
    Answer answer = Answer::kOk;
    Nanoseconds used;              ///< by the method
  };

  /// `service` null: there is no such thread. `serving` shows which task and method it runs, as BlockHead::serving.
  /// `hosts[t]` is the interface of task t to the framework. All arguments outlive this. Context: setup.
  void prepare(std::span<Task> tasks, std::span<TaskHost> hosts, TaskMethods& methods, Service* service,
               std::atomic<std::uint32_t>& serving, SetupMemory& memory);

  /// True when there is a service thread.
  bool is_there() const noexcept { return mechanisms::kService && service_ != nullptr; }
  /// True if the service thread runs the method.
  bool takes(Method method) const noexcept {
    return is_there() && (method == Method::kInit || method == Method::kKill);
  }
  /// Hands the task over; no other thread touches it before finish(). A task that is being killed is no longer ON,
  /// whatever its kill does. Context: cycle boundary; wait-free.
  void ask_construction(Task& task) noexcept { ask(task, {true, Method::kInit, {}}); }
  void ask(Task& task, Method method) noexcept { ask(task, {false, method, {}}); }
  /// Runs the request for the task. Context: the service thread; may block.
  void run(TaskId task, JobClock& clock);
  /// The task is back. Requires: run() is over. Context: cycle boundary; wait-free.
  Outcome finish(Task& task) noexcept;

 private:
  struct Asked {
    bool is_construction = false;
    Method method = Method::kInit;
    Outcome outcome;
  };
  void ask(Task& task, const Asked& asked) noexcept;

  std::span<Task> tasks_;
  std::span<TaskHost> hosts_;
  TaskMethods* methods_ = nullptr;
  Service* service_ = nullptr;
  std::atomic<std::uint32_t>* serving_ = nullptr;  // relaxed, pairs with nothing: as TaskMethods::Words
  std::span<Asked> asked_;                         // by task
};

}  // namespace chimera
