// SPDX-License-Identifier: Apache-2.0
// Keeps classes of tasks in two heaps, by next release and by urgency, over memory that it is given.
#include "chimera/schedule/ready_queue.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

// A binary heap over `heap[0..n)`; before(a, b) orders two elements.
template <class T, class Before>
void sift_down(std::span<T> heap, std::uint32_t n, std::uint32_t at, Before&& before) noexcept {
  for (;;) {
    std::uint32_t best = 2 * at + 1;
    if (best >= n) return;
    if (best + 1 < n && before(heap[best + 1], heap[best])) ++best;
    if (!before(heap[best], heap[at])) return;
    std::swap(heap[at], heap[best]);
    at = best;
  }
}

template <class T, class Before>
void sift_up(std::span<T> heap, std::uint32_t at, Before&& before) noexcept {
  while (at > 0 && before(heap[at], heap[(at - 1) / 2])) {
    std::swap(heap[at], heap[(at - 1) / 2]);
    at = (at - 1) / 2;
  }
}

// Takes heap[at] out of n elements.
template <class T, class Before>
void erase(std::span<T> heap, std::uint32_t& n, std::uint32_t at, Before&& before) noexcept {
  --n;
  if (at == n) return;
  heap[at] = heap[n];
  sift_up(heap, at, before);
  sift_down(heap, n, at, before);
}

}  // namespace

ReadyQueue::ReadyQueue(Policy policy, std::span<const TaskSpec> tasks, const QueueStorage& storage) noexcept
    : policy_(policy), storage_(storage) {
  const std::size_t n = tasks.size();
  CHIMERA_ASSERT(storage.members.size() >= n && storage.classes.size() >= n && storage.tasks.size() >= n);
  CHIMERA_ASSERT(storage.loose.size() >= n && storage.pauses.size() >= n && storage.runs.size() >= n);
  make_classes(tasks);
}

void ReadyQueue::set_origin(Nanoseconds origin) noexcept {
  CHIMERA_ASSERT(n_pauses_ == 0);
  origin_ = origin;
}

void ReadyQueue::make_classes(std::span<const TaskSpec> tasks) noexcept {
  std::uint32_t filled = 0;
  for (std::uint32_t first = 0; first < tasks.size(); ++first) storage_.tasks[first].of_class = UINT32_MAX;
  for (std::uint32_t first = 0; first < tasks.size(); ++first) {
    if (storage_.tasks[first].of_class != UINT32_MAX) continue;
    CHIMERA_ASSERT(tasks[first].period > Nanoseconds{});
    QueueClass& c = storage_.classes[n_classes_];
    c = QueueClass{};
    c.period = tasks[first].period;
    c.offset = tasks[first].offset;
    c.begin = filled;
    for (std::uint32_t i = first; i < tasks.size(); ++i) {
      const TaskSpec& t = tasks[i];
      if (t.period != c.period || t.offset != c.offset) continue;
      storage_.tasks[i] = QueueTask{};
      storage_.tasks[i].of_class = n_classes_;
      storage_.members[filled++] = QueueMember{t.deadline, t.budget, kNever, i, t.criticality, t.user_priority};
    }
    c.size = filled - c.begin;
    ++n_classes_;
  }
}

std::uint32_t ReadyQueue::find(std::uint32_t task) const noexcept {
  const QueueClass& c = storage_.classes[storage_.tasks[task].of_class];
  std::uint32_t at = c.begin;
  while (storage_.members[at].task != task) ++at;
  return at;
}

Urgency ReadyQueue::urgency_of(const QueueClass& c, const QueueMember& m) noexcept {
  return {m.criticality, m.user_priority, c.period, c.release + m.deadline, m.budget};
}

bool ReadyQueue::goes_before(const Urgency& a, std::uint32_t a_task, const Urgency& b,
                             std::uint32_t b_task) const noexcept {
  if (is_more_urgent(policy_, a, b)) return true;
  if (is_more_urgent(policy_, b, a)) return false;
  return a_task < b_task;
}

Nanoseconds ReadyQueue::grid_at_or_after(const QueueClass& c, Nanoseconds now) const noexcept {
  const Nanoseconds first = origin_ + c.offset;
  if (now <= first) return first;
  return first + c.period * ((now - first + c.period - Nanoseconds{1}) / c.period);
}

bool ReadyQueue::is_member(TaskId task) const noexcept {
  const QueueClass& c = storage_.classes[storage_.tasks[task.index].of_class];
  return find(task.index) < c.begin + c.active;
}

void ReadyQueue::join(TaskId task, Nanoseconds now) noexcept {
  if (is_member(task)) return;
  const std::uint32_t index = storage_.tasks[task.index].of_class;
  QueueClass& c = storage_.classes[index];
  const bool had_run = c.cursor < c.active;
  const auto class_members = storage_.members.subspan(c.begin, c.size);
  const std::uint32_t from = find(task.index) - c.begin;
  QueueMember m = class_members[from];
  m.first = grid_at_or_after(c, now);
  if (c.active > 0) m.first = std::max(m.first, c.next);  // the instant's release may be under way already
  class_members[from] = class_members[c.active];
  std::uint32_t to = c.active;
  for (; to > 0; --to) {
    const QueueMember& other = class_members[to - 1];
    if (goes_before(urgency_of(c, other), other.task, urgency_of(c, m), m.task)) break;
    class_members[to] = other;
  }
  class_members[to] = m;
  ++c.active;
  if (to < c.cursor || !had_run) ++c.cursor;
  if (c.active == 1) {
    c.cursor = 1;
    c.next = m.first;
    push_pause(index);
  }
  refresh_run(index, had_run);
}

void ReadyQueue::leave(TaskId task) noexcept {
  if (!is_member(task)) return;
  const std::uint32_t index = storage_.tasks[task.index].of_class;
  QueueClass& c = storage_.classes[index];
  const bool had_run = c.cursor < c.active;
  Job forgotten;
  (void)take_deferred(task, forgotten);
  const auto class_members = storage_.members.subspan(c.begin, c.size);
  const std::uint32_t at = find(task.index) - c.begin;
  const QueueMember m = class_members[at];
  --c.active;
  for (std::uint32_t i = at; i < c.active; ++i) class_members[i] = class_members[i + 1];
  class_members[c.active] = m;
  if (at < c.cursor) --c.cursor;
  if (c.active == 0) remove_pause(index);
  refresh_run(index, had_run);
}

Urgency ReadyQueue::top_urgency() const noexcept {
  CHIMERA_ASSERT(!is_empty());
  return loose_is_top() ? storage_.loose[0].urgency : run_urgency(storage_.runs[0]);
}

// More than one run, or jobs beside them.
Job ReadyQueue::pop_among() noexcept {
  CHIMERA_ASSERT(!is_empty());
  if (n_loose_ > 0 && loose_is_top()) return pop_loose();
  const std::uint32_t index = storage_.runs[0];
  QueueClass& c = storage_.classes[index];
  const QueueMember& m = storage_.members[c.begin + c.cursor++];
  const Job job{TaskId(m.task), c.release, c.release + m.deadline};
  if (settle(c)) {
    if (n_runs_ > 1) sift_run_down(0);
  } else {
    erase(storage_.runs, n_runs_, 0, [this](auto a, auto b) { return run_before(a, b); });
  }
  return job;
}

Job ReadyQueue::pop_loose() noexcept {
  const Job job = storage_.loose[0].job;
  QueueTask& t = storage_.tasks[job.task.index];
  if (t.is_loose) --n_deferred_;
  t.is_loose = false;
  remove_loose(0);
  return job;
}

void ReadyQueue::occupy(TaskId task) noexcept {
  QueueTask& t = storage_.tasks[task.index];
  if (!t.busy) ++n_busy_;
  t.busy = true;
}

void ReadyQueue::finish(TaskId task) noexcept {
  QueueTask& t = storage_.tasks[task.index];
  if (t.busy) --n_busy_;
  t.busy = false;
  if (!t.has_pending) return;
  t.has_pending = false;
  t.is_loose = true;
  push_loose(make_loose(t.pending, nullptr));
}

void ReadyQueue::put_back(const Job& job, Nanoseconds remaining) noexcept { push_loose(make_loose(job, &remaining)); }

bool ReadyQueue::remove(TaskId task, Job& job) noexcept {
  if (take_deferred(task, job)) return true;
  for (std::uint32_t i = 0; i < n_loose_; ++i) {
    if (storage_.loose[i].job.task != task) continue;
    job = storage_.loose[i].job;
    remove_loose(i);
    return true;
  }
  return take_from_run(task, job);
}

// The member stays in its class; setting its first release beyond this run is what takes it out of the run.
bool ReadyQueue::take_from_run(TaskId task, Job& job) noexcept {
  const std::uint32_t index = storage_.tasks[task.index].of_class;
  QueueClass& c = storage_.classes[index];
  const std::uint32_t at = find(task.index) - c.begin;
  QueueMember& m = storage_.members[c.begin + at];
  if (at < c.cursor || at >= c.active || m.first > c.release) return false;
  job = Job{task, c.release, c.release + m.deadline};
  m.first = c.next;
  refresh_run(index, true);
  return true;
}

bool ReadyQueue::take_deferred(TaskId task, Job& job) noexcept {
  QueueTask& t = storage_.tasks[task.index];
  if (!t.has_pending && !t.is_loose) return false;
  --n_deferred_;
  if (t.has_pending) {
    job = t.pending;
  } else {
    std::uint32_t at = 0;
    while (storage_.loose[at].job.task != task) ++at;
    job = storage_.loose[at].job;
    remove_loose(at);
  }
  t.has_pending = t.is_loose = false;
  return true;
}

// The members of a class or their standing changed: puts its run where it belongs now.
void ReadyQueue::refresh_run(std::uint32_t index, bool had_run) noexcept {
  if (!had_run) return;
  remove_run(index);
  if (settle(storage_.classes[index])) push_run(index);
}

// Moves the cursor to the next member that may run; false when the run is over.
bool ReadyQueue::settle(QueueClass& c) noexcept {
  for (; c.cursor < c.active; ++c.cursor) {
    const QueueMember& m = storage_.members[c.begin + c.cursor];
    if (m.first > c.release) continue;
    if (n_busy_ == 0) return true;
    QueueTask& t = storage_.tasks[m.task];
    if (!t.busy) return true;
    t.pending = Job{TaskId(m.task), c.release, c.release + m.deadline};
    t.has_pending = true;
    ++n_deferred_;
  }
  return false;
}

const QueueMember& ReadyQueue::head(std::uint32_t index) const noexcept {
  const QueueClass& c = storage_.classes[index];
  return storage_.members[c.begin + c.cursor];
}

Urgency ReadyQueue::run_urgency(std::uint32_t index) const noexcept {
  return urgency_of(storage_.classes[index], head(index));
}

bool ReadyQueue::run_before(std::uint32_t a, std::uint32_t b) const noexcept {
  return goes_before(run_urgency(a), head(a).task, run_urgency(b), head(b).task);
}

LooseJob ReadyQueue::make_loose(const Job& job, const Nanoseconds* remaining) const noexcept {
  const QueueMember& m = storage_.members[find(job.task.index)];
  const QueueClass& c = storage_.classes[storage_.tasks[job.task.index].of_class];
  return {job, {m.criticality, m.user_priority, c.period, job.deadline, remaining ? *remaining : m.budget}};
}

bool ReadyQueue::loose_before(const LooseJob& a, const LooseJob& b) const noexcept {
  return goes_before(a.urgency, a.job.task.index, b.urgency, b.job.task.index);
}

bool ReadyQueue::loose_is_top() const noexcept {
  if (n_loose_ == 0 || n_runs_ == 0) return n_loose_ > 0;
  const LooseJob& loose = storage_.loose[0];
  const std::uint32_t run = storage_.runs[0];
  return goes_before(loose.urgency, loose.job.task.index, run_urgency(run), head(run).task);
}

void ReadyQueue::push_run(std::uint32_t index) noexcept {
  storage_.runs[n_runs_] = index;
  sift_up(storage_.runs, n_runs_++, [this](auto a, auto b) { return run_before(a, b); });
}

void ReadyQueue::sift_run_down(std::uint32_t at) noexcept {
  sift_down(storage_.runs, n_runs_, at, [this](auto a, auto b) { return run_before(a, b); });
}

void ReadyQueue::remove_run(std::uint32_t index) noexcept {
  std::uint32_t at = 0;
  while (at < n_runs_ && storage_.runs[at] != index) ++at;
  if (at == n_runs_) return;
  // Its key may be stale already, so order is restored around the hole from above and from below.
  --n_runs_;
  if (at == n_runs_) return;
  storage_.runs[at] = storage_.runs[n_runs_];
  sift_up(storage_.runs, at, [this](auto a, auto b) { return run_before(a, b); });
  sift_run_down(at);
}

void ReadyQueue::push_pause(std::uint32_t index) noexcept {
  storage_.pauses[n_pauses_] = index;
  sift_up(storage_.pauses, n_pauses_++,
          [this](auto a, auto b) { return storage_.classes[a].next < storage_.classes[b].next; });
}

void ReadyQueue::sift_pause_down(std::uint32_t at) noexcept {
  sift_down(storage_.pauses, n_pauses_, at,
            [this](auto a, auto b) { return storage_.classes[a].next < storage_.classes[b].next; });
}

void ReadyQueue::remove_pause(std::uint32_t index) noexcept {
  std::uint32_t at = 0;
  while (storage_.pauses[at] != index) ++at;
  erase(storage_.pauses, n_pauses_, at,
        [this](auto a, auto b) { return storage_.classes[a].next < storage_.classes[b].next; });
}

void ReadyQueue::push_loose(const LooseJob& loose) noexcept {
  storage_.loose[n_loose_] = loose;
  sift_up(storage_.loose, n_loose_++, [this](const auto& a, const auto& b) { return loose_before(a, b); });
}

void ReadyQueue::remove_loose(std::uint32_t at) noexcept {
  erase(storage_.loose, n_loose_, at, [this](const auto& a, const auto& b) { return loose_before(a, b); });
}

}  // namespace chimera
