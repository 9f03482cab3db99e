// SPDX-License-Identifier: Apache-2.0
// The control of a real-time unit: what comes from other processes is taken in at its edges, and what its edges changed
// is shown to them. docs/formats/processes.md.
//
//   inputs, in this order           each is looked at by one function of take()
//     other processes               new segments, who lives, states and flags elsewhere; wishes of the manager
//     methods that are over         init and kill, run by the service thread
//     the end of the unit           from then on no signal is begun
//     signals                       from tasks elsewhere and from the manager
//   step                            one signal, or one transaction of several: BoundarySignals::signal()
//   list of changes                 TaskSet::changes(): nothing below this class publishes anything
//   publication                     publish(), in one place: after every step, because the next method may hang or end
//                                   the process, and at the end of the edge
//
// A change at one instant (a switch) is one more input: a plan that take() looks at before the signals, whose steps are
// carried out by BoundarySignals and published once, after the last of them.
#pragma once

#include <atomic>
#include <vector>

#include "chimera/base/fixed.h"
#include "chimera/rtpu/peer_links.h"
#include "chimera/runtime/boundary_listener.h"
#include "chimera/runtime/service.h"

namespace chimera {

/// Used by the thread that cycles, but for what is marked.
class RtpuControl final : public BoundaryListener {
 public:
  /// Signals that wait for a task to be served; more stay in the rings.
  static constexpr std::size_t kWaiting = 512;

  RtpuControl(const ApplicationSpec& spec, TaskSet& tasks, PeerLinks& others, Service& service, DecisionPage& decision,
              std::uint32_t me, Nanoseconds method_limit);

  void take(BoundarySignals& signals, Nanoseconds now) noexcept override;
  void told(const SignalReport& report, Nanoseconds now) noexcept override;
  void publish() noexcept override { others_.publish(tasks_); }
  void show(const Task& task) noexcept override { others_.block().profile(task.id) = task.profile; }
  void missed(TaskId task, const MissCause::Verdict& verdict, Nanoseconds now) noexcept override;
  void gave_way(TaskId task, Nanoseconds used, Nanoseconds now) noexcept override;
  void hangs(TaskWord job, Nanoseconds age, Nanoseconds now) noexcept override;
  /// Shows the others how the unit is before its first edge. Setup.
  void begin() noexcept;
  /// An event descriptor that is written to when a job hangs and when all is over. Setup.
  void set_supervisor(int descriptor) noexcept { supervisor_ = descriptor; }
  /// A job of some task does not end. Any thread.
  bool has_hanging() const noexcept { return hanging_; }
  /// The reaction `stop` of a task: turns all tasks of the unit OFF.
  void stop_all(BoundarySignals& signals, TaskId stopped_by, Nanoseconds now) noexcept;
  /// Before a wait: shows what the tasks cost, a few of them at a time.
  void show_profiles() noexcept;

  /// From now on all tasks of the unit end. `is_alone`: the others go on, and a successor brings back what is ON now;
  /// may be said again. Any thread; ring the bell afterwards.
  void end(bool is_alone) noexcept {
    ends_alone_ = is_alone;
    ending_ = true;
  }
  /// Grows at the begin and the end of each method that a cycle boundary calls: for the supervisor. Any thread.
  std::uint32_t progress() const noexcept { return progress_; }
  /// The method that an edge has called, as BlockHead::running; 0: none. Any thread.
  std::uint32_t acting() const noexcept { return acting_; }
  /// The job that does not end, likewise, and the time since its release (zero: its thread is gone). After
  /// has_hanging(). Any thread.
  std::uint32_t hanging() const noexcept { return hanging_job_; }
  Nanoseconds hanging_age() const noexcept { return {hanging_age_}; }
  /// Set when all tasks are killed: the loop's RunOptions::stop.
  const std::atomic<bool>& is_over() const noexcept { return over_; }

 private:
  void check_peers() noexcept;
  void read_posts() noexcept;
  void take_slow(BoundarySignals& signals, Nanoseconds now) noexcept;
  void act_on_waiting(BoundarySignals& signals, Nanoseconds now) noexcept;
  std::size_t step_length(std::size_t first) const noexcept;
  bool may_act(std::span<const Post> step, BoundarySignals& signals) noexcept;
  void act(std::span<const Post> step, BoundarySignals& signals, Nanoseconds now) noexcept;
  void turn_on(std::span<const Post> step, BoundarySignals& signals, Nanoseconds now) noexcept;
  bool refuse_illegal(std::span<const Post> step, Nanoseconds now) noexcept;
  void report(const Post& signal, const SignalReport& report, Nanoseconds now) noexcept;
  void report(const Post& signal, State before, State after, Refusal why, bool accepted, Nanoseconds now) noexcept;
  void go_on_ending(BoundarySignals& signals, Nanoseconds now) noexcept;
  SignalReport carry_out(BoundarySignals& signals, std::span<const TaskId> tasks, Signal signal,
                         Nanoseconds now) noexcept;
  bool turn_off_next(BoundarySignals& signals, Nanoseconds now) noexcept;
  bool kill_next(BoundarySignals& signals, Nanoseconds now) noexcept;
  void post(const Post& post) noexcept;
  void post_event(EventKind happening, TaskId task, std::uint64_t detail, Nanoseconds at) noexcept;
  void wake_supervisor() noexcept;

  const ApplicationSpec& spec_;
  TaskSet& tasks_;
  PeerLinks& others_;
  Service& service_;
  const Nanoseconds method_limit_;
  std::uint32_t seen_changes_;
  FixedVector<Post, kWaiting> waiting_;
  std::vector<bool> blocked_;   // by task: an earlier signal for it waits
  std::vector<Post> commands_;  // by task: the signal that is being served
  std::vector<bool> hangs_;     // by task: nobody waits for its job
  int supervisor_ = -1;
  std::size_t shown_ = 0;  // the task whose profile is shown next
  bool has_begun_ending_ = false;
  std::size_t next_off_ = 0;  // in spec_.end_order
  Nanoseconds patience_;      // with the tasks of others, while ending
  // end() by the main thread, read at edges: sequentially consistent, so that ends_alone_ is seen with ending_.
  std::atomic<bool> ending_{false};
  std::atomic<bool> ends_alone_{false};
  // hangs() at an edge, read by the main thread: hanging_ is stored last and loaded first, so that the others are seen.
  std::atomic<bool> hanging_{false};
  std::atomic<std::uint32_t> hanging_job_{0};
  std::atomic<std::int64_t> hanging_age_{0};
  // Stored at an edge, loaded by the loop (RunOptions::stop) and by the main thread; pairs with nothing.
  std::atomic<bool> over_{false};
  // Counted and told at edges, watched by the main thread (HangWatch); pair with nothing.
  std::atomic<std::uint32_t> progress_{0}, acting_{0};
};

}  // namespace chimera
