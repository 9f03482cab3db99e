// SPDX-License-Identifier: Apache-2.0
// The tasks of one context: makes them, takes their signals at an edge, binds their ports, keeps the
// illegal-configuration flag. The executors add time.
#pragma once

#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/constant_store.h"
#include "chimera/runtime/task_memory.h"
#include "chimera/runtime/job_clock.h"
#include "chimera/runtime/job_step.h"
#include "chimera/runtime/refusal.h"
#include "chimera/runtime/variables.h"
#include "chimera/task/task.h"

namespace chimera {

/// What became of a signal. Plain data: no text is made on the cycle path; explain() makes it.
struct SignalReport {
  bool is_accepted = false;
  Refusal why = Refusal::kNone;
  Signal signal = Signal::kOn;
  TaskId task;  ///< the one it failed at, else the last
  State before = State::kNotCreated;
  State after = State::kNotCreated;
};

/// Present value of a state variable.
struct VariableView {
  const std::byte* value = nullptr;  ///< of the latest publication; nullptr: never bound
  const chimera_slot* slot = nullptr;
  const PortSpec* spec = nullptr;    ///< of the producing port; nullptr for operator variables
  std::uint32_t count = 0;
  bool is_valid = false;
};

/// A group in which a variable's value may stand.
struct VariableReader {
  GroupReader reader;
  std::uint32_t offset = 0;  ///< of the value in the payload
  std::uint32_t bit = 0;     ///< of the value in the valid bits
};

class TaskSet {
 public:
  /// Plans memory for every task and binds what can be bound. `components[i]` runs task i; `spec` and the components
  /// outlive the set. Refuses tasks that do not fit their component. Context: setup.
  static Result<std::unique_ptr<TaskSet>> create(const ApplicationSpec& spec,
                                                 std::span<const chimera_component* const> components);
  TaskSet(const TaskSet&) = delete;
  TaskSet& operator=(const TaskSet&) = delete;
  ~TaskSet();

  /// The clock that methods see; by the executor, before anything is signalled. Context: setup.
  void attach(JobClock& clock) noexcept { clock_ = &clock; }

  /// Spawns all tasks in the order of their constants and turns the start set ON as one transaction.
  /// Refuses with the first task that said no; whatever was spawned stays as it is. Context: edge.
  Result<void> start(Nanoseconds now);
  /// off (reverse of the start order), then kill, for every task that is there. Context: edge.
  void shut_down(Nanoseconds now);
  /// Carries out one signal and all that follows from it (re-initialisation of users of a changed constant, the
  /// illegal-configuration flag). Nothing changes when it is refused. Context: edge.
  SignalReport signal(TaskId task, Signal signal, Nanoseconds now);
  /// Turns tasks ON (or OFF) as one transaction: refused as a whole when the set would be illegal. Context: edge.
  SignalReport signal(std::span<const TaskId> tasks, Signal signal, Nanoseconds now);

  /// A refused report in words, with the smallest legal set where that helps; "" when it was accepted. For a report of
  /// the last call of signal(). Context: setup; may block.
  std::string explain(const SignalReport& report) const;

  /// Hands the signals that `task` sent during its last method to their targets. Context: edge.
  void deliver(Task& task) noexcept;
  /// True when some task has signals waiting. Context: cycle; wait-free.
  bool has_pending() const noexcept { return n_pending_ != 0; }
  /// Takes the oldest waiting signal of `task`; false when there is none. Context: edge.
  bool take_pending(Task& task, Signal& signal) noexcept;

  /// The illegal-configuration flag: raised by somebody, or because the ON set is not legal. Context: cycle.
  bool is_illegal() const noexcept { return flag_raised_ || !on_set_legal_; }
  void raise_flag(bool up) noexcept { flag_raised_ = up; }
  /// To be told by the executor when a cycle left the ON state by itself. Context: edge.
  void on_set_changed() noexcept;

  std::span<Task> tasks() noexcept { return tasks_; }
  std::span<const Task> tasks() const noexcept { return tasks_; }
  const ApplicationSpec& spec() const noexcept { return spec_; }
  const Variables& variables() const noexcept { return *variables_; }
  TaskId find(std::string_view name) const noexcept;
  /// Every group in which a value of variable `index` may stand (each producer has two, used in turn):
  /// for readers in other threads, who take the latest publication. Context: setup.
  std::vector<VariableReader> readers_of(std::size_t index) const;
  /// Latest value of variable `index` (Variables::all()). Context: edge.
  VariableView view(std::size_t index) const noexcept;

 private:
  /// Where a variable's value comes from at present.
  struct Source {
    GroupReader reader;
    std::uint32_t offset = 0;
    std::uint32_t bit = 0;
    TaskId task;  ///< invalid: the operator
  };
  struct HostContext {
    TaskSet* set = nullptr;
    Task* task = nullptr;
  };

  explicit TaskSet(const ApplicationSpec& spec) : spec_(spec) {}
  Result<void> build(std::span<const chimera_component* const> components);
  void bind_all();
  Result<void> lay_out();
  std::span<std::byte> group_memory(std::size_t group) const noexcept;
  void place_operators();
  GroupInput input_from(const Source& source);
  void set_constants();
  const GivenSpec* given(std::string_view variable) const noexcept;
  bool lists_fit(const Task& task, FixedString<160>& why) const noexcept;
  void bind(VariableId variable, const Source& source);
  void bind_outputs_of(Task& task);
  State follow(Task& task, Next at, Nanoseconds now);
  Answer run_step(Task& task, const StepRule& step, Nanoseconds now);
  bool before_step(Task& task, const StepRule& step, Nanoseconds now);
  Answer after_ok(Task& task, const StepRule& step, Nanoseconds now);
  void take_over(Task& task) noexcept;
  std::uint64_t valid_after_on(const Task& task) const noexcept;
  void reinit_users(TaskId of, Nanoseconds now);
  bool would_be_legal(std::span<const TaskId> tasks) noexcept;
  SignalReport carry_out(TaskId task, Signal signal, Nanoseconds now);

  static std::int32_t host_expired(void* context);
  static std::int32_t host_signal(void* context, std::uint32_t signal, const char* task);
  static void host_spend(void* context, std::int64_t ns);
  static const chimera_host kHost;

  const ApplicationSpec& spec_;
  std::vector<TaskMemory> memories_;
  std::vector<Task> tasks_;
  std::vector<HostContext> contexts_;
  std::unique_ptr<Variables> variables_;
  std::vector<Source> sources_;  // one per variable
  AlignedBytes table_;                          // of groups: two for each task, then one for each operator variable
  std::vector<GroupPlace> groups_;
  std::vector<VariablePlace> places_;
  std::vector<AlignedBytes> local_memory_;      // behind locals_
  std::deque<LocalGroup> locals_;               // copies of operator variables, one for each in-var that reads one
  ConstantStore constants_;
  JobClock* clock_ = nullptr;
  std::vector<bool> on_;
  std::vector<bool> wanted_;  // the ON set that was asked for last
  std::uint32_t n_pending_ = 0;
  std::uint64_t taken_over_valid_ = 0;
  bool flag_raised_ = false;
  bool on_set_legal_ = true;
};

}  // namespace chimera
