// SPDX-License-Identifier: Apache-2.0
// The edges of a preemptive context: signals, posts of others, what jobs left behind. Everything in the section but
// the methods, which run at the label of their task.
#include <algorithm>

#include "chimera/platform/realtime.h"
#include "chimera/platform/thread_stack.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera {
namespace {

RunOptions with_threads(RunOptions options, JobThreads* threads) noexcept {
  options.threads = threads;
  options.can_demote = true;
  return options;
}

}  // namespace

PreemptiveExecutor::PreemptiveExecutor(TaskSet& set, const RunOptions& options, const ProcessorPlace& place)
    : set_(set), tasks_(set.tasks()), place_(place), guest_(options.guest),
      releases_(set, clock_, with_threads(options, this)),
      labels_(options.policy, set.tasks().size(), place.ceiling > 0 ? place.base : 0,
              place.ceiling > 0 ? place.ceiling : 20),
      of_task_(set.tasks().size()), bell_(place.bell != nullptr ? place.bell : &own_bell_), use_(place.window),
      use_by_less_(place.window) {
  has_levels_ = place.ceiling > 0 && may_be_realtime(place.ceiling);
  for (const Task& task : tasks_) {
    if (!set.is_mine(task.id)) continue;
    JobThread& thread = threads_.emplace_back();
    thread.task = task.id;
    if (task.spec->server) thread.served.emplace(*task.spec->server);
    else shortest_ = std::min(shortest_, task.spec->deadline);
    of_task_[task.id.index] = &thread;
  }
  find_less_important();
  for (JobThread& thread : threads_) {
    const ThreadStack stack(spec(thread).stack_bytes);
    thread.thread = std::thread([this, &thread] { follow_releases(thread); });
  }
  supervisor_ = std::thread([this] { supervise(); });
  while (n_ready_ < threads_.size() + 1) clock_.sleep(microseconds(100));
}

PreemptiveExecutor::~PreemptiveExecutor() {
  section_.enter();
  quits_ = true;
  alarm_.set({});  // nobody sets it anew after this
  leave();
  for (JobThread& thread : threads_) wake(thread);
  for (JobThread& thread : threads_) thread.thread.join();
  supervisor_.join();
}

Result<void> PreemptiveExecutor::start() {
  Result<void> started = set_.life().start(clock_.now());
  if (started) start(clock_.now());
  return started;
}

void PreemptiveExecutor::start(Nanoseconds origin) {
  enter();
  releases_.begin(origin);
  open_servers(origin);
  leave();
}

void PreemptiveExecutor::shut_down() noexcept {
  enter();
  set_.life().shut_down(clock_.now());
  leave();
}

RunEnd PreemptiveExecutor::run(Nanoseconds duration) noexcept {
  const Nanoseconds until = duration == kNever ? kNever : origin() + duration;
  edge_thread_ = this_thread();
  enter();
  is_paused_ = false;
  until_ = until;
  tell_threads(true);
  leave();
  for (;;) {
    const std::uint32_t heard = Doorbell(*bell_).read();
    RunEnd end = RunEnd::kTime;
    enter();
    const bool is_over = take_edge(end, until);
    const Nanoseconds next = std::min(releases_.next_edge(), until);
    leave();
    if (is_over) {
      stop_jobs(end);
      return end;
    }
    (void)Doorbell(*bell_).wait_until(heard, next);
  }
}

// True when the run is over.
bool PreemptiveExecutor::take_edge(RunEnd& end, Nanoseconds until) noexcept {
  const Nanoseconds now = clock_.now();
  Settlement& settlement = releases_.settlement();
  for (JobThread& job : threads_) {
    if (settlement.is_unsettled(job.task)) settlement.settle_at_once(job.task, now);
    if (settlement.is_unsettled(job.task) && claim(job.task)) settlement.settle_job(job.task, now);
  }
  for (JobThread& job : threads_) {
    if (!job.is_hanging || guest_ == nullptr) continue;
    job.is_hanging = false;
    guest_->hangs(job.task, used(job), now);
  }
  if (gave_way_.is_valid() && guest_ != nullptr) guest_->gave_way(gave_way_, use_.used(now), now);
  gave_way_ = TaskId();
  if (releases_.misses().has_lost_patience()) releases_.settlement().give_up_starved(now);
  if (releases_.edge_is_due(now)) releases_.take_edge(now);
  for (JobThread& job : threads_)  // events are counted also while no job is run
    if ((job.served || !job.is_shown) && job.phase == JobPhase::kNone) show(job, now);
  tell_threads(false);
  end = releases_.stop_requested() ? RunEnd::kStopped
        : releases_.settlement().task_stopped() ? RunEnd::kTaskStopped
        : now >= until             ? RunEnd::kTime
                                   : RunEnd::kNothingLeft;
  return end != RunEnd::kNothingLeft || (!releases_.anything_left() && is_idle());
}

// Threads follow the states of their tasks. Those for which nothing is new sleep on.
void PreemptiveExecutor::tell_threads(bool all) noexcept {
  for (JobThread& job : threads_) {
    const bool is_on = releases_.members().is_on(job.task), has_event = job.served && task(job).events > 0;
    const bool is_new = all || is_on != job.is_joined || job.is_held || has_event;
    if (is_on && !job.is_joined && !job.served) job.next = releases_.queue().first_release(job.task);
    if (!is_on) job.next = kNever;
    if (!is_on && job.served) forget_event(job);
    job.is_joined = is_on;
    job.is_held = false;
    if (is_new) wake(job);
  }
}

bool PreemptiveExecutor::is_idle() const noexcept {
  return std::all_of(threads_.begin(), threads_.end(),
                     [](const JobThread& job) { return job.phase == JobPhase::kNone; });
}

// No job is released from here on; those under way end. The reaction `stop` does not wait for one that is late: it may
// never end.
void PreemptiveExecutor::stop_jobs(RunEnd end) noexcept {
  const auto is_over = [this, end](const JobThread& job) {
    const bool is_left = end == RunEnd::kTaskStopped && releases_.misses().is_reported_late(job.task);
    return job.phase == JobPhase::kNone || is_left;
  };
  enter();
  is_paused_ = true;
  for (JobThread& job : threads_) (void)claim(job.task);
  for (;;) {
    for (JobThread& job : threads_)
      if (job.phase == JobPhase::kNone && releases_.settlement().is_unsettled(job.task))
        releases_.settlement().settle_job(job.task, clock_.now());
    const bool all_are = std::all_of(threads_.begin(), threads_.end(), is_over);
    const std::uint32_t heard = Doorbell(*bell_).read();
    leave();
    if (all_are) return;
    (void)Doorbell(*bell_).wait_until(heard, clock_.now() + milliseconds(1));
    enter();
  }
}

bool PreemptiveExecutor::claim(TaskId id) noexcept {
  JobThread* job = of_task_[id.index];
  JobPhase phase = JobPhase::kWaiting;
  if (job->phase.compare_exchange_strong(phase, JobPhase::kChanged)) {
    job->next = job->job.release;  // it comes again
    cancel(*job, clock_.now());
    return true;
  }
  const bool is_free = phase == JobPhase::kNone || phase == JobPhase::kCancelled;
  job->is_awaited = !is_free;
  return is_free;
}

Nanoseconds PreemptiveExecutor::used_by_job(TaskId id) noexcept {
  const JobThread* job = of_task_[id.index];
  return job != nullptr && job->phase == JobPhase::kBegun ? used(*job) : Nanoseconds{};
}

bool PreemptiveExecutor::is_blocked(TaskId id) noexcept {
  const JobThread* job = of_task_[id.index];
  if (job == nullptr || job->phase != JobPhase::kBegun) return false;
  leave();  // to look takes some microseconds, and the kernel may let us wait
  const bool asleep = is_asleep(job->id);
  enter();
  return asleep;
}

Answer PreemptiveExecutor::call(Task& task, Method method, Nanoseconds now) noexcept {
  open(task.id);
  const Answer answer = call_method(task, method, now);
  close(task.id);
  return answer;
}

// The method runs at the label of its task, outside of the section.
void PreemptiveExecutor::open(TaskId id) noexcept {
  JobThread* job = of_task_[id.index];
  if (job == nullptr || edge_thread_ == 0) return;  // nobody runs yet
  const Nanoseconds now = clock_.now();
  const TaskSpec& s = spec(*job);
  job->is_held = true;
  job->carrier = edge_thread_;
  job->job = {id, now, now + s.deadline};
  if (job->served) job->served->due = now + s.deadline;
  job->phase = JobPhase::kMethod;
  LabelledJob method;
  method.task = id;
  method.urgency = urgency_of(*job, s.budget);
  const int level = apply(labels_.insert(method), job);
  leave();
  lower(level);
}

void PreemptiveExecutor::close(TaskId id) noexcept {
  JobThread* job = of_task_[id.index];
  if (job == nullptr || edge_thread_ == 0) return;
  job->phase = JobPhase::kDone;
  raise();
  enter();
  (void)apply(labels_.remove(id), nullptr);
  job->carrier = job->id;
  job->phase = JobPhase::kNone;
  show_running();
}

ProcessorCounts PreemptiveExecutor::counts() const noexcept {
  ProcessorCounts counts = counts_;
  counts.section_taken = section_.times_taken() - counts_.taken_asleep;
  return counts;
}

}  // namespace chimera
