// SPDX-License-Identifier: Apache-2.0
// The tasks of one context: makes them, takes their signals at an edge, binds their ports, keeps the
// illegal-configuration flag. The executors add time.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/background_writer.h"
#include "chimera/runtime/constant_store.h"
#include "chimera/runtime/job_clock.h"
#include "chimera/runtime/job_step.h"
#include "chimera/runtime/neighbours.h"
#include "chimera/runtime/peer_layout.h"
#include "chimera/runtime/refusal.h"
#include "chimera/runtime/service.h"
#include "chimera/runtime/sources.h"
#include "chimera/runtime/task_memory.h"
#include "chimera/runtime/variables.h"
#include "chimera/task/task.h"

namespace chimera {

/// What became of a signal. Plain data: no text is made on the cycle path; explain() makes it.
struct SignalReport {
  bool is_accepted = false;
  bool is_deferred = false;  ///< the service thread has it: the rest comes from TaskSet::served()
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

/// Told around every method that runs at an edge, where other tasks may preempt it.
class MethodGate {
 public:
  /// From here to close() the task's method runs, and what the edge may touch may change. Context: edge.
  virtual void open(TaskId task) noexcept = 0;
  /// It has ended. Context: edge.
  virtual void close(TaskId task) noexcept = 0;

 protected:
  ~MethodGate() = default;
};

/// Where a context stands in the application. By default it is alone: all tasks and operator variables are its own.
struct ContextPlace {
  RtpuId rtpu;                     ///< whose tasks are its own; invalid: all
  std::span<std::byte> table;      ///< zeroed bytes for PeerLayout::of(spec, rtpu); empty: memory of its own
  Neighbours* others = nullptr;
  Service* service = nullptr;  ///< null: init and kill run where the signal is taken
  /// Told which task and method runs, as BlockHead::running says: by the context, and by the service thread.
  std::atomic<std::uint32_t>* running = &running_untold;
  std::atomic<std::uint32_t>* serving = &running_untold;
  bool preemptive = false;  ///< tasks preempt each other: each reads through copies of its own
  /// Told which method is called where a signal is taken; `running` goes on telling of jobs meanwhile.
  std::atomic<std::uint32_t>* at_edge = &running_untold;
  /// Told for which task a state is constructed, by show_making().
  std::atomic<std::uint32_t>* making = &running_untold;
};

/// Everything about the tasks of one context but time. One thread at a time, but for serve().
class TaskSet {
 public:
  /// Plans memory for every task and binds what can be bound. `components[i]` runs task i (not looked at for tasks of
  /// other contexts); `spec`, the components and what `place` names outlive the set. Refuses tasks that do not fit
  /// their component. Context: setup.
  static Result<std::unique_ptr<TaskSet>> create(const ApplicationSpec& spec,
                                                 std::span<const chimera_component* const> components,
                                                 const ContextPlace& place = {});
  TaskSet(const TaskSet&) = delete;
  TaskSet& operator=(const TaskSet&) = delete;
  ~TaskSet();

  /// The clock that methods see; by the executor, before anything is signalled. Context: setup.
  void attach(JobClock& clock) noexcept { clock_ = &clock; }
  /// That clock; null before.
  JobClock* clock() const noexcept { return clock_; }
  /// Whose threads run what components do beside their cycles; by the owner of the executor, before anything is
  /// signalled. Without one that is done before kill alone (and by executors of virtual time). It outlives the set.
  /// Context: setup.
  void attach(BackgroundWriter& writer) noexcept { writer_ = &writer; }
  /// By executors of preemptive contexts, before anything is signalled. It outlives the set. Context: setup.
  void attach(MethodGate& gate) noexcept { gate_ = &gate; }

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

  /// Runs what the service thread was asked for with this task. Context: the service thread; may block.
  void serve(TaskId task, JobClock& clock);
  /// Goes on with the signal that the service thread has served; deferred again while there is more. Context: edge.
  SignalReport served(TaskId task, Nanoseconds now);
  /// Reads constants of other contexts; true when one that the task was initialised with has changed. Context: edge.
  bool uses_changed_constants(TaskId task) noexcept;
  /// Something changed in another context: inputs follow, the flag is judged anew. Context: edge.
  void follow_others() noexcept;
  /// Its memory may go: see Sources::let_go. Context: edge.
  void let_go(TaskId producer) noexcept { bindings_.let_go(producer); }
  /// A task with a job under way may still read what was let go. Context: edge.
  bool is_any_behind() const noexcept { return bindings_.is_any_behind(); }
  /// Between two jobs of the task; true when it had something to follow. Context: edge; wait-free.
  bool adopt(TaskId task) noexcept {
    if (!bindings_.is_behind(task)) return false;
    bindings_.adopt(task);
    return true;
  }
  /// The flag words of the other contexts, to be read with every job. Context: edge.
  void watch_flags(std::span<const std::atomic<std::uint32_t>* const> flags) noexcept { foreign_flags_ = flags; }
  std::uint32_t incarnation(TaskId task) const noexcept { return memories_[task.index].incarnation(); }
  const PeerLayout& layout() const noexcept { return *layout_; }
  bool is_mine(TaskId task) const noexcept { return memories_[task.index].is_planned(); }

  /// A refused report in words, with the smallest legal set where that helps; "" when it was accepted. For a report of
  /// the last call of signal(). Context: setup; may block.
  std::string explain(const SignalReport& report) const;

  /// Rings the doorbell of a task behind a server: one job for each ring, none is lost. False, with nothing done, when
  /// it is not ON or has no server. Context: edge; wait-free.
  bool ring(TaskId task) noexcept;
  /// Publishes a value of operator variable `index`. Requires: the context is alone; as many bytes as the description
  /// gives. Context: edge.
  void set_operator(std::size_t index, std::span<const std::byte> value, Nanoseconds now) noexcept;
  /// Hands the signals that `task` sent during its last method to their targets. Context: edge.
  void deliver(Task& task) noexcept;
  /// The signal waits for the present method of the task to end. Context: edge.
  void defer(Task& task, Signal signal) noexcept;
  /// True when some task has signals waiting. Context: cycle; wait-free.
  bool has_pending() const noexcept { return n_pending_ != 0; }
  /// Takes the oldest waiting signal of `task`; false when there is none. Context: edge.
  bool take_pending(Task& task, Signal& signal) noexcept;

  /// The illegal-configuration flag: raised by somebody, or because the ON set is not legal. Context: cycle.
  bool is_illegal() const noexcept {
    if (is_illegal_here_) return true;
    for (const std::atomic<std::uint32_t>* flag : foreign_flags_)
      if (flag->load(std::memory_order_relaxed) != 0) return true;
    return false;
  }
  /// The ON set over all contexts obeys the two set equations, as far as this context has looked. Context: cycle.
  bool is_on_set_legal() const noexcept { return on_set_legal_; }
  bool is_flag_raised() const noexcept { return flag_raised_ || raised_by_.is_valid(); }
  /// Raises or lowers the part of the flag that does not follow from the ON set. Context: edge.
  /// Lowered, it is also for the tasks that hold it up.
  void raise_flag(bool up) noexcept {
    flag_raised_ = up;
    if (!up) lower_flags(true);
    judge_flag();
  }
  /// The reaction of a task of this context raises it until that task is no longer ON. Context: edge.
  void raise_flag_for(TaskId task) noexcept {
    raised_by_ = task;
    raises_[task.index] = true;
    on_set_changed();  // the set has not, but other contexts are to see the flag at once
  }
  bool raises_flag(TaskId task) const noexcept { return raises_[task.index]; }
  /// The task whose reaction raised it last; invalid: no task does.
  TaskId raised_by() const noexcept { return raised_by_; }
  /// To be told by the executor when a cycle left the ON state by itself. Context: edge.
  void on_set_changed() noexcept;
  /// To be told by the executor when it saw a new fault of the task. Context: edge.
  void told(const Task& task) noexcept {
    if (place_.others != nullptr) place_.others->told(task);
  }

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
  struct HostContext {
    TaskSet* set = nullptr;
    Task* task = nullptr;
    JobClock* clock = nullptr;  ///< null: that of the set
  };
  /// A signal that waits for the service thread. Touched by one thread at a time.
  struct Serving {
    SignalReport report;
    Step step = Step::kInit;
    bool constructs = false;
    Answer answer = Answer::kOk;
    Nanoseconds used;  // by the present step so far, transfers included
    bool has_new_constants = false;
  };
  /// A constant of another context.
  struct ForeignConstant {
    TaskId producer;
    std::string_view name;
    std::uint32_t offset = 0, bytes = 0;
  };

  TaskSet(const ApplicationSpec& spec, const ContextPlace& place) : spec_(spec), place_(place) {}
  Result<void> build(std::span<const chimera_component* const> components);
  void prepare_task(std::size_t t);
  Result<void> lay_out();
  std::span<std::byte> group_memory(GroupId group) const noexcept;
  void place_operators();
  void set_constants();
  void plan_foreign_constants();
  void read_foreign_constants() noexcept;
  void publish_constants(const Task& task) noexcept;
  const GivenSpec* given(std::string_view variable) const noexcept;
  bool lists_fit(const Task& task, FixedString<160>& why) const noexcept;
  bool follow(Task& task, Next at, Nanoseconds now);
  bool is_served(Method method) const noexcept {
    return place_.service != nullptr && (method == Method::kInit || method == Method::kKill);
  }
  SignalReport advance(Task& task, Next at, Nanoseconds now);
  void hand_over(Task& task, Step step);
  Answer construct(Task& task, Nanoseconds now);
  bool begin_background(Task& task, Nanoseconds now);
  bool end_background(Task& task, Nanoseconds now);
  Answer run_method(Task& task, Method method, Nanoseconds now, JobClock* clock);
  Next conclude(Task& task, const StepRule& step, Answer answer, Nanoseconds now, Nanoseconds began);
  static Nanoseconds read(JobClock* clock, Nanoseconds otherwise) noexcept {
    return clock == nullptr ? otherwise : clock->now();
  }
  bool before_step(Task& task, const StepRule& step, Nanoseconds now);
  Answer after_ok(Task& task, const StepRule& step, Nanoseconds now);
  void take_over(Task& task) noexcept;
  std::uint64_t valid_after_on(const Task& task) const noexcept;
  void reinit_users(TaskId of, Nanoseconds now);
  bool uses_constant_of(TaskId user, TaskId producer) const noexcept;
  bool would_be_legal(std::span<const TaskId> tasks) noexcept;
  SignalReport carry_out(TaskId task, Signal signal, Nanoseconds now);

  void lower_flags(bool of_all) noexcept;
  void judge_flag() noexcept { is_illegal_here_ = is_flag_raised() || !on_set_legal_; }
  static std::int32_t host_expired(void* context);
  static std::int32_t host_signal(void* context, std::uint32_t signal, const char* task);
  static void host_spend(void* context, std::int64_t ns);
  static void host_note(void* context, const char* text);
  static const PortSpec* joined(void* context, const chimera_port* port) noexcept;
  static chimera_text host_variable(void* context, const chimera_port* port);
  static chimera_text host_unit(void* context, const chimera_port* port);
  static const chimera_host kHost;

  const ApplicationSpec& spec_;
  ContextPlace place_;
  std::vector<TaskMemory> memories_;
  std::vector<Task> tasks_;
  std::vector<HostContext> contexts_;
  std::vector<Serving> serving_;
  std::unique_ptr<Variables> variables_;
  std::unique_ptr<PeerLayout> everything_;  // of all groups of the application
  std::unique_ptr<PeerLayout> layout_;      // of the groups of this context
  AlignedBytes own_table_;                  // behind table_, unless the place gives it
  std::span<std::byte> table_;
  std::vector<GroupReader> operators_;
  Sources bindings_;
  ConstantStore constants_;
  std::vector<ForeignConstant> foreign_constants_;
  AlignedBytes constant_scratch_;
  JobClock* clock_ = nullptr;
  BackgroundWriter* writer_ = nullptr;
  MethodGate* gate_ = nullptr;
  std::span<const std::atomic<std::uint32_t>* const> foreign_flags_;
  std::vector<bool> on_;
  std::vector<bool> wanted_;  // the ON set that was asked for last
  std::uint32_t n_pending_ = 0;
  std::uint64_t taken_over_valid_ = 0;
  bool flag_raised_ = false;
  std::vector<bool> raises_;  // whose reaction holds the flag up
  TaskId raised_by_;          // one of them
  bool on_set_legal_ = true;
  bool is_illegal_here_ = false;  // what these come to, for every job
};

}  // namespace chimera
