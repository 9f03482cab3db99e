// SPDX-License-Identifier: Apache-2.0
// Runs a preemptive context, one cycle boundary after the other: signals, posts of others, results of jobs. All of it
// runs in the section except the methods, which run at the label of their task.
#include "chimera/runtime/preemptive/preemptive_executor.h"

#include <algorithm>

#include "chimera/platform/thread.h"
#include "chimera/runtime/job/hang_rule.h"
#include "chimera/runtime/hosted/refusal_text.h"

namespace chimera {
namespace {

RunOptions with_threads(RunOptions options, JobThreads* threads) noexcept {
  options.threads = threads;
  options.preemptive = true;
  return options;
}

ProcessorShare share_of(const TaskSet& set, Policy policy, const ProcessorPlace& place) {
  std::vector<bool> is_mine;
  for (const Task& task : set.tasks()) is_mine.push_back(set.is_mine(task.id));
  return {set.tasks(), is_mine, policy, {place.share, place.window}};
}

// From its release on no periodic job is late sooner; 1 s at most.
Nanoseconds shortest_deadline(const ReadyJobs& ready) noexcept {
  Nanoseconds shortest = seconds(1);
  for (const JobThread& job : ready.threads())
    if (!job.sporadic) shortest = std::min(shortest, job.spec.deadline);
  return shortest;
}

}  // namespace

PreemptiveExecutor::PreemptiveExecutor(TaskSet& set, const RunOptions& options, const ProcessorPlace& place)
    : set_(set), guest_(options.guest), access_(releases_, ready_, processor_, clock_, set.tasks().size()),
      releases_(set, clock_, with_threads(options, &access_)), ready_(set, place, options.policy),
      share_(share_of(set, options.policy, place)), checks_(set.tasks().size(), shortest_deadline(ready_)),
      processor_(set, releases_, ready_, share_, checks_, place),
      supervisor_(releases_, ready_, share_, checks_, processor_, clock_),
      jobs_(set, releases_, ready_, checks_, processor_, supervisor_, clock_, options.guest) {
  for (JobThread& job : ready_.threads()) {
    const ThreadStack stack(job.spec.stack_bytes);
    job.start([this, &job] { jobs_.run(job, n_attached_); });
  }
  supervisor_.start(n_attached_);
  const std::size_t n_threads = ready_.threads().size() + 1;
  while (n_attached_.load(std::memory_order_acquire) < n_threads) clock_.sleep(microseconds(100));
}

PreemptiveExecutor::~PreemptiveExecutor() {
  at_edge([this] {
    jobs_.quit();
    supervisor_.quit();
  });
  for (JobThread& job : ready_.threads()) job.wake();
  for (JobThread& job : ready_.threads()) job.join();
  supervisor_.join();
}

Result<void> PreemptiveExecutor::start() {
  const auto wait = [this](Nanoseconds at) {
    clock_.sleep(at - clock_.now());
    return clock_.now();
  };
  Result<void> started = start_result(set_, set_.life().start(clock_.now(), wait));
  if (started) start(clock_.now());
  return started;
}

// The periods of servers count from the origin of the grid.
void PreemptiveExecutor::start(Nanoseconds origin) {
  at_edge([&] {
    releases_.begin(origin);
    for (JobThread& job : ready_.threads())
      if (job.sporadic) job.sporadic->start(job.thread(), origin);
  });
}

void PreemptiveExecutor::shut_down() noexcept {
  at_edge([this] {
    releases_.end(clock_.now());
    set_.life().shut_down(clock_.now());
  });
}

RunEnd PreemptiveExecutor::run(Nanoseconds duration) noexcept {
  const Nanoseconds until = duration == kNever ? kNever : origin() + duration;
  access_.attach();
  at_edge([&] {
    processor_.go_on();
    access_.open(until);
  });
  for (;;) {
    const std::uint32_t heard = processor_.edge_bell().read();  // before the look at everything: no ring is lost
    const Nanoseconds now = enter_with_look_ups();
    run_edge(now);
    RunEnd end = RunEnd::kTime;
    const bool has_ended = is_over(end, until, now);
    const Nanoseconds next = std::min(releases_.next_edge(), until);
    processor_.leave();
    if (has_ended) {
      stop_jobs(end);
      return end;
    }
    (void)processor_.edge_bell().wait_until(heard, next);
  }
}

// Returns the instant of the cycle boundary, in the section. Every begun job that is late then has been looked up once.
// To look one up takes some microseconds outside the section, in which more jobs may be late.
Nanoseconds PreemptiveExecutor::enter_with_look_ups() noexcept {
  processor_.enter();
  Nanoseconds now = clock_.now();
  while (access_.collect_late(now)) {
    processor_.leave();
    access_.look_up_blocked();
    processor_.enter();
    now = clock_.now();
  }
  return now;
}

void PreemptiveExecutor::run_edge(Nanoseconds now) noexcept {
  Settlement& settlement = releases_.settlement();
  for (JobThread& job : ready_.threads()) {
    if (settlement.is_unsettled(job.id)) settlement.settle_at_once(job.id, now);
    if (settlement.is_unsettled(job.id) && access_.claim(job.id)) settlement.settle_job(job.id, now);
  }
  access_.forget_blocked();
  if (guest_ != nullptr) report_hanging(now);
  if (releases_.misses().has_lost_patience()) settlement.give_up_starved(now);
  if (releases_.edge_is_due(now)) releases_.take_edge(now);
  for (JobThread& job : ready_.threads())  // events are counted also while no job is run
    if ((job.sporadic || !job.is_shown) && job.phase.is_idle()) jobs_.show(job, now);
  access_.follow_all();
}

// Jobs that do not end by themselves, and one that was demoted for the share of the processor.
void PreemptiveExecutor::report_hanging(Nanoseconds now) noexcept {
  for (const JobThread& job : ready_.threads()) {
    if (!supervisor_.pop_hanging(job)) continue;
    const Nanoseconds used = job.used();
    const bool is_gone = used == Nanoseconds{}, uses_too_much = used > most_use(job.spec);
    guest_->hangs(TaskWord(job.id, job.method()), is_gone ? Nanoseconds{} : now - job.job.release,
                  uses_too_much ? used : Nanoseconds{}, now);
  }
  if (const TaskId task = share_.pop_demoted(); task.is_valid()) guest_->gave_way(task, share_.used(now), now);
}

bool PreemptiveExecutor::is_over(RunEnd& end, Nanoseconds until, Nanoseconds now) noexcept {
  end = releases_.stop_requested() ? RunEnd::kStopped
        : releases_.settlement().task_stopped() ? RunEnd::kTaskStopped
        : now >= until             ? RunEnd::kTime
                                   : RunEnd::kNothingLeft;
  return end != RunEnd::kNothingLeft || (!releases_.anything_left() && is_idle());
}

bool PreemptiveExecutor::is_idle() const noexcept {
  return std::all_of(ready_.threads().begin(), ready_.threads().end(),
                     [](const JobThread& job) { return job.phase.is_idle(); });
}

// No job is released from here on; those under way end. The reaction `stop` does not wait for one that is late: it may
// never end.
void PreemptiveExecutor::stop_jobs(RunEnd end) noexcept {
  const auto is_over = [this, end](const JobThread& job) {
    return job.phase.is_idle() || (end == RunEnd::kTaskStopped && releases_.misses().is_reported_late(job.id));
  };
  Settlement& settlement = releases_.settlement();
  processor_.enter();
  processor_.pause();
  for (JobThread& job : ready_.threads()) (void)access_.claim(job.id);
  for (;;) {
    for (JobThread& job : ready_.threads())
      if (job.phase.is_idle() && settlement.is_unsettled(job.id)) settlement.settle_job(job.id, clock_.now());
    const bool all_are = std::all_of(ready_.threads().begin(), ready_.threads().end(), is_over);
    const std::uint32_t heard = processor_.edge_bell().read();
    processor_.leave();
    if (all_are) return;
    (void)processor_.edge_bell().wait_until(heard, clock_.now() + milliseconds(1));
    processor_.enter();
  }
}

}  // namespace chimera
