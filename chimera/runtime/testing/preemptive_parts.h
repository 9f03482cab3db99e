// SPDX-License-Identifier: Apache-2.0
// For tests: the parts of a preemptive executor without its threads and without real-time levels. The test says what
// time it is and makes the moves of the threads itself; execution time is that of the thread of the test.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "chimera/platform/clock.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/preemptive/edge_access.h"
#include "chimera/runtime/preemptive/supervisor.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::testing {

struct Idle {
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) {
    if (during_cycle) during_cycle();
  }
  void off(Cycle) {
    if (during_off) during_off();
  }
  static inline std::function<void()> during_cycle, during_off;
};

/// Counts what is reported.
class CountingGuest final : public BoundaryListener {
 public:
  explicit CountingGuest(const std::atomic<std::uint32_t>& bell) : BoundaryListener(bell) {}
  void take(BoundarySignals&, Nanoseconds) noexcept override {}
  void publish() noexcept override {}
  void told(const SignalReport&, Nanoseconds) noexcept override {}
  void missed(TaskId, const MissCause::Verdict& verdict, Nanoseconds) noexcept override { verdicts.push_back(verdict); }
  void hangs(TaskWord, Nanoseconds, Nanoseconds, Nanoseconds) noexcept override {}
  void gave_way(TaskId, Nanoseconds, Nanoseconds) noexcept override {}
  void show(const Task&) noexcept override { ++shown; }

  std::vector<MissCause::Verdict> verdicts;
  int shown = 0;
};

/// Tasks are added first; then make().
class PreemptiveParts {
 public:
  TaskSpec& add(const char* name, Nanoseconds period) {
    TaskSpec& spec = app.add(name, component<Idle>("idle"), period);
    app.link(app.tasks.size() - 1, 0, name);
    return spec;
  }
  /// All tasks are ON and released on a grid that begins at `origin`.
  void make(Policy policy = Policy::kEdf, ProcessorPlace where = {}) {
    place = where;
    ContextPlace context;
    context.preemptive = true;
    auto made = HeapTaskSet::create(app.make(), app.components, context);
    set = *std::move(made);
    parts = std::make_unique<Parts>(*this, policy);
    (void)set->life().start(origin);
    releases().begin(origin);
    processor().go_on();
    for (JobThread& job : ready().threads()) {
      job.attach();
      job.begin_use();
      job.is_on = true;
      job.next_release = origin;
      if (job.sporadic) job.sporadic->start(job.thread(), origin);
    }
  }

  /// Task 0 is behind a server of 1 ms in `server_period` and has one event to answer, that came at `event`; task 1 is
  /// periodic.
  void make_served(Nanoseconds server_period, Nanoseconds period, Nanoseconds event) {
    TaskSpec& spec = add("events", server_period);
    spec.aperiodic = true;
    spec.server = ServerSpec{ServerKind::kDeferrable, milliseconds(1), server_period};
    add("periodic", period);
    make();
    std::uint32_t waiting = 1;
    (void)job(0).sporadic->job().accept(waiting, event);
  }

  Releases& releases() { return parts->releases; }
  ReadyJobs& ready() { return parts->ready; }
  JobChecks& checks() { return parts->checks; }
  Processor& processor() { return parts->processor; }
  Supervisor& supervisor() { return parts->supervisor; }
  EdgeAccess& access() { return parts->access; }
  JobThread& job(std::uint32_t task) { return *ready().of(TaskId(task)); }

  /// As the thread of the task would: a job of it is ready.
  JobThread& release(std::uint32_t task, Nanoseconds now) {
    JobThread& one = job(task);
    one.job = {one.id, now, one.sporadic ? kNever : now + one.spec.deadline};
    if (one.sporadic) (void)one.sporadic->job().grant(now);
    one.next_release = now + one.spec.period;
    one.is_demoted = false;
    releases().misses().forget_reports(one.id);
    one.phase.release();
    one.task.is_busy = true;
    (void)ready().insert(one, ReadyJobs::deadline_of(one), one.spec.budget, &one);
    processor().dispatch(now);
    supervisor().watch_released(one, now);
    return one;
  }
  /// Releases a job that has begun.
  JobThread& begin(std::uint32_t task, Nanoseconds now) {
    JobThread& one = release(task, now);
    one.begin_use();
    one.begin_slice(now);
    (void)one.phase.try_begin();
    return one;
  }
  /// Execution time of the thread of the test.
  static void use(Nanoseconds time) {
    const Nanoseconds end = used_by_this_thread() + time;
    while (used_by_this_thread() < end) {
    }
  }

  struct Clock final : JobClock {
    Nanoseconds now() noexcept override { return time; }
    void spend(Nanoseconds) noexcept override {}
    Nanoseconds time;
  };
  struct Parts {
    Parts(PreemptiveParts& of, Policy policy)
        : guest(bell), access(releases, ready, processor, of.clock, of.set->tasks().size()),
          releases(*of.set, of.clock, options(policy)), ready(*of.set, of.place, policy),
          share(of.set->tasks(), std::vector<bool>(of.set->tasks().size(), true), policy,
                {of.place.share, of.place.window}),
          checks(of.set->tasks().size(), milliseconds(5)), processor(*of.set, releases, ready, share, checks, of.place),
          supervisor(releases, ready, share, checks, processor, of.clock) {}
    RunOptions options(Policy policy) {
      RunOptions made;
      made.policy = policy;
      made.guest = &guest;
      made.threads = &access;
      made.preemptive = true;
      return made;
    }

    std::atomic<std::uint32_t> bell{0};  // pairs with nothing: one thread
    CountingGuest guest;
    EdgeAccess access;
    Releases releases;
    ReadyJobs ready;
    ProcessorShare share;
    JobChecks checks;
    Processor processor;
    Supervisor supervisor;
  };

  /// In an hour, so that no alarm rings while a test runs; on a whole second, as laxities are rounded to the quantum.
  const Nanoseconds origin = seconds(LinuxClock().now().count / 1'000'000'000 + 3600);
  TestApplication app;
  ProcessorPlace place;
  Clock clock;
  std::unique_ptr<HeapTaskSet> set;
  std::unique_ptr<Parts> parts;
};

}  // namespace chimera::testing
