// SPDX-License-Identifier: Apache-2.0
// The control of an rtpu. At each cycle boundary it reads the input of other processes and publishes the changes of the
// boundary. Its clock ends a wait when input arrives. docs/formats/processes.md.
//
//   inputs, in this order           one function of take() reads each
//     other processes               new segments, live peers, states and flags of peers, requests of the manager
//     finished methods              init and kill, run by the service thread
//     the end of the rtpu           from then on no signal begins
//     signals                       from tasks of other rtpus and from the manager
//   step                            one signal, or one transaction of several: BoundarySignals::signal()
//   list of changes                 TaskSet::changes(): nothing below this class publishes anything
//   publication                     publish(), in one place: after every step, because the next method may hang or end
//                                   the process, and at the end of the boundary
//
// A change at one instant (a switch) is one more input: a plan that take() reads before the signals. BoundarySignals
// carries out its steps; they are published once, after the last step.
#pragma once

#include <atomic>
#include <vector>

#include "chimera/base/fixed.h"
#include "chimera/platform/wake.h"
#include "chimera/rtpu/hanging_jobs.h"
#include "chimera/rtpu/peer_links.h"
#include "chimera/rtpu/rtpu_end.h"
#include "chimera/rtpu/supervised_signals.h"
#include "chimera/rtpu/waiting_signals.h"
#include "chimera/runtime/executive/counter_clock.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/service.h"

namespace chimera {

/// Only the cycling thread uses it, except for marked functions.
class RtpuControl final : public BoundaryListener {
 public:
  RtpuControl(const ApplicationSpec& spec, TaskSet& tasks, PeerLinks& others, Service& service, DecisionPage& decision,
              std::uint32_t me, Nanoseconds method_limit);

  void take(BoundarySignals& signals, Nanoseconds now) noexcept override;
  void told(const SignalReport& report, Nanoseconds now) noexcept override;
  void publish() noexcept override { others_.publish(tasks_); }
  void show(const Task& task) noexcept override { others_.block().profile(task.id) = task.profile; }
  void missed(TaskId task, const MissCause::Verdict& verdict, Nanoseconds now) noexcept override;
  void gave_way(TaskId task, Nanoseconds used, Nanoseconds now) noexcept override;
  void took_over(TaskId task, TaskId from, Nanoseconds after, Nanoseconds now) noexcept override;
  void hangs(TaskWord job, Nanoseconds age, Nanoseconds used, Nanoseconds now) noexcept override;
  /// Publishes the state of the rtpu before its first cycle boundary. Context: setup.
  void begin() noexcept;
  /// The reaction `stop` of a task: turns all tasks of the rtpu OFF.
  void stop_all(BoundarySignals& signals, TaskId stopped_by, Nanoseconds now) noexcept;
  /// Called before a wait: publishes the profiles of a few tasks at a time.
  void show_profiles() noexcept;

  // For the main thread.
  RtpuEnd& rtpu_end() noexcept { return end_; }
  const SupervisedSignals& supervised() const noexcept { return supervised_; }
  HangingJobs& hanging() noexcept { return hanging_; }

 private:
  void check_peers(Nanoseconds now) noexcept;
  void read_posts() noexcept;
  void take_slow(BoundarySignals& signals, Nanoseconds now) noexcept;
  void act(std::span<const Post> step, BoundarySignals& signals, Nanoseconds now) noexcept;
  void turn_on(std::span<const Post> step, BoundarySignals& signals, Nanoseconds now) noexcept;
  bool refuse_illegal(std::span<const Post> step, Nanoseconds now) noexcept;
  void report(const Post& signal, const SignalReport& report, Nanoseconds now) noexcept;
  void report(const Post& signal, State before, State after, Refusal why, bool accepted, Nanoseconds now) noexcept;
  void go_on_ending(BoundarySignals& signals, Nanoseconds now) noexcept;
  void post(const Post& post) noexcept;
  void post_event(EventKind happening, TaskId task, std::uint64_t detail, Nanoseconds at) noexcept;

  const ApplicationSpec& spec_;
  TaskSet& tasks_;
  PeerLinks& others_;
  Service& service_;
  SupervisedSignals supervised_;
  HangingJobs hanging_;
  RtpuEnd end_;
  std::uint32_t seen_changes_;
  WaitingSignals waiting_;
  std::vector<Post> commands_;  // by task: the signal whose init or kill runs
  std::size_t shown_ = 0;       // the next task whose profile is published
};

/// The clock of an rtpu: reads the cycle counter, and waits on the bell of the rtpu. A ring of the bell ends the wait.
/// Only the cycling thread uses it.
class BellClock final : public Clock {
 public:
  /// Context: setup; blocks about 10 ms.
  BellClock(Doorbell bell, std::atomic<std::uint32_t>& running, RtpuControl& edge) noexcept
      : bell_(bell), running_(running), edge_(edge) {}

  Nanoseconds now() noexcept override { return counter_.now(); }
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    running_.store(0, std::memory_order_relaxed);
    edge_.show_profiles();
    const WaitEnd end = bell_.wait_until(edge_.heard(), instant);
    counter_.compare();
    return end;
  }

 private:
  Doorbell bell_;
  std::atomic<std::uint32_t>& running_;  // BlockHead::running; relaxed, pairs with nothing
  RtpuControl& edge_;
  CounterClock counter_;
};

}  // namespace chimera
