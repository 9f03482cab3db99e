// SPDX-License-Identifier: Apache-2.0
// Keeps classes of tasks in two heaps, by next release and by urgency. Keeps single jobs outside their runs beside
// them.
#include "chimera/schedule/ready_queue.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {

ReadyQueue::ReadyQueue(Policy policy, std::span<const TaskSpec> tasks, const QueueStorage& storage) noexcept
    : classes_(policy, tasks, storage.classes),
      tasks_(storage.tasks),
      pauses_(storage.pauses),
      runs_(storage.runs),
      loose_(storage.loose) {
  const std::size_t n = tasks.size(), n_classes = TaskClasses::count(tasks);
  CHIMERA_ASSERT(storage.pauses.size() >= n_classes && storage.runs.size() >= n_classes);
  CHIMERA_ASSERT(!mechanisms::kLooseJobs || storage.loose.size() >= n);
  if constexpr (!mechanisms::kPreemptive) return;
  CHIMERA_ASSERT(storage.tasks.size() >= n);
  for (std::size_t i = 0; i < n; ++i) tasks_[i] = QueueTask{};
}

void ReadyQueue::set_origin(Nanoseconds origin) noexcept {
  CHIMERA_ASSERT(pauses_.is_empty());
  classes_.set_origin(origin);
}

void ReadyQueue::join(TaskId task, Nanoseconds now) noexcept {
  if (classes_.is_active(task.index)) return;
  const std::uint32_t index = classes_.class_of(task.index);
  const TaskClass& c = classes_[index];
  const bool had_run = c.cursor < c.active;
  classes_.activate(task.index, now);
  if (c.active == 1) pauses_.push(index, ByRelease{classes_});
  refresh_run(index, had_run);
}

void ReadyQueue::leave(TaskId task) noexcept {
  if (!classes_.is_active(task.index)) return;
  const std::uint32_t index = classes_.class_of(task.index);
  const TaskClass& c = classes_[index];
  const bool had_run = c.cursor < c.active;
  Job forgotten;
  if constexpr (mechanisms::kPreemptive) (void)take_deferred(task, forgotten);
  classes_.deactivate(task.index);
  if (c.active == 0) {
    std::uint32_t at = 0;
    while (pauses_.items()[at] != index) ++at;
    pauses_.erase(at, ByRelease{classes_});
  }
  refresh_run(index, had_run);
}

bool ReadyQueue::has_waiting(TaskId task, Nanoseconds before) const noexcept {
  if constexpr (mechanisms::kPreemptive) {
    const QueueTask& t = tasks_[task.index];
    if (t.has_pending && t.pending.release < before) return true;
  }
  if constexpr (mechanisms::kLooseJobs) {
    for (const LooseJob& one : loose_.items())
      if (one.job.task == task && one.job.release < before) return true;
  }
  const TaskClass& c = classes_[classes_.class_of(task.index)];
  const std::uint32_t at = classes_.place(task.index);
  return at >= c.cursor && at < c.active && classes_.member(c, at).first <= c.release && c.release < before;
}

Nanoseconds ReadyQueue::latest_release() const noexcept {
  Nanoseconds latest{INT64_MIN};
  for (const std::uint32_t index : pauses_.items())
    latest = std::max(latest, classes_[index].next - classes_[index].period);
  return latest;
}

Urgency ReadyQueue::top_urgency() const noexcept {
  CHIMERA_ASSERT(!is_empty());
  return loose_is_top() ? loose_.top().urgency : classes_.urgency(runs_.top());
}

// Pops if several runs are ready, or if loose jobs wait beside them.
Job ReadyQueue::pop_among() noexcept {
  CHIMERA_ASSERT(!is_empty());
  if (mechanisms::kLooseJobs && !loose_.is_empty() && loose_is_top()) return pop_loose();
  TaskClass& c = classes_[runs_.top()];
  const Job job = TaskClasses::job(c, classes_.member(c, c.cursor++));
  if (!settle(c)) runs_.erase(0, ByUrgency{classes_});
  else if (runs_.size() > 1) runs_.sift_top(ByUrgency{classes_});
  return job;
}

Job ReadyQueue::pop_loose() noexcept {
  const Job job = loose_.top().job;
  if constexpr (mechanisms::kPreemptive) {
    QueueTask& t = tasks_[job.task.index];
    if (t.is_loose) --n_deferred_;
    t.is_loose = false;
  }
  loose_.erase(0, ByUrgency{classes_});
  --n_beside_;
  return job;
}

bool ReadyQueue::loose_is_top() const noexcept {
  if (loose_.is_empty() || runs_.is_empty()) return !loose_.is_empty();
  const LooseJob& first = loose_.top();
  const std::uint32_t run = runs_.top();
  return classes_.goes_before(first.urgency, first.job.task.index, classes_.urgency(run),
                              classes_.task_at_cursor(run));
}

void ReadyQueue::occupy(TaskId task) noexcept {
  QueueTask& t = tasks_[task.index];
  if (!t.busy) ++n_beside_;
  t.busy = true;
}

void ReadyQueue::finish(TaskId task) noexcept {
  QueueTask& t = tasks_[task.index];
  if (t.busy) --n_beside_;
  t.busy = false;
  if (!t.has_pending) return;
  t.has_pending = false;
  t.is_loose = true;
  push_loose(t.pending, nullptr);
}

void ReadyQueue::put_back(const Job& job, Nanoseconds remaining) noexcept { push_loose(job, &remaining); }

// Without `remaining`, the job needs its whole budget.
void ReadyQueue::push_loose(const Job& job, const Nanoseconds* remaining) noexcept {
  const ClassMember& m = classes_.member_of(job.task.index);
  const Nanoseconds period = classes_[classes_.class_of(job.task.index)].period;
  const Nanoseconds budget = m.budget;
  const Urgency urgency{m.criticality, m.user_priority, period, job.deadline, remaining ? *remaining : budget};
  loose_.push({job, urgency}, ByUrgency{classes_});
  ++n_beside_;
}

bool ReadyQueue::remove(TaskId task, Job& job) noexcept {
  return (mechanisms::kPreemptive && take_deferred(task, job)) || (mechanisms::kLooseJobs && take_loose(task, job)) ||
         take_from_run(task, job);
}

bool ReadyQueue::take_loose(TaskId task, Job& job) noexcept {
  for (std::uint32_t at = 0; at < loose_.size(); ++at) {
    if (loose_.items()[at].job.task != task) continue;
    job = loose_.items()[at].job;
    loose_.erase(at, ByUrgency{classes_});
    --n_beside_;
    return true;
  }
  return false;
}

// The member stays in its class. A first release beyond this run takes it out of the run.
bool ReadyQueue::take_from_run(TaskId task, Job& job) noexcept {
  const std::uint32_t index = classes_.class_of(task.index), at = classes_.place(task.index);
  TaskClass& c = classes_[index];
  ClassMember& m = classes_.member(c, at);
  if (at < c.cursor || at >= c.active || m.first > c.release) return false;
  job = TaskClasses::job(c, m);
  m.first = c.next;
  refresh_run(index, true);
  return true;
}

bool ReadyQueue::take_deferred(TaskId task, Job& job) noexcept {
  QueueTask& t = tasks_[task.index];
  if (!t.has_pending && !t.is_loose) return false;
  --n_deferred_;
  if (t.has_pending) job = t.pending;
  else (void)take_loose(task, job);
  t.has_pending = t.is_loose = false;
  return true;
}

// Moves the cursor to the next member that may run; false if the run is over.
bool ReadyQueue::settle(TaskClass& c) noexcept {
  for (; c.cursor < c.active; ++c.cursor) {
    const ClassMember& m = classes_.member(c, c.cursor);
    if (m.first > c.release) continue;
    if (!mechanisms::kPreemptive || n_beside_ == 0) return true;
    QueueTask& t = tasks_[m.task];
    if (!t.busy) return true;
    t.pending = TaskClasses::job(c, m);
    t.has_pending = true;
    ++n_deferred_;
  }
  return false;
}

void ReadyQueue::remove_run(std::uint32_t index) noexcept {
  for (std::uint32_t at = 0; at < runs_.size(); ++at)
    if (runs_.items()[at] == index) return runs_.erase(at, ByUrgency{classes_});
}

// Restores the place of a run in the heap after its members or their order changed.
void ReadyQueue::refresh_run(std::uint32_t index, bool had_run) noexcept {
  if (!had_run) return;
  remove_run(index);
  if (settle(classes_[index])) runs_.push(index, ByUrgency{classes_});
}

}  // namespace chimera
