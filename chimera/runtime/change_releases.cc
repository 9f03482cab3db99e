// SPDX-License-Identifier: Apache-2.0
// Ends the time before a change for the jobs that are released or wait.
#include "chimera/runtime/change_releases.h"

namespace chimera {

void release_before(ReadyQueue& queue, JobThreads& threads, MissPolicy& misses, Nanoseconds instant) noexcept {
  if (threads.take_releases()) return;
  queue.release_due(instant - Nanoseconds{1}, [&misses](const DroppedRelease& dropped) { misses.drop(dropped); });
}

// A job that waits is replaced by the next release of its task, which has come in a context that is late by more than a
// period.
void change_releases(TaskSet& set, ReadyQueue& queue, JobThreads& threads, MissPolicy& misses, Nanoseconds at,
                     Nanoseconds now) noexcept {
  if (threads.take_releases()) return;
  release_before(queue, threads, misses, at);
  const TaskClasses& classes = queue.classes();
  for (const Task& each : set.tasks()) {
    if (each.is_busy || !classes.is_active(each.id.index) || !queue.has_waiting(each.id, at)) continue;
    Job job;
    const bool is_replaced = classes[classes.class_of(each.id.index)].next <= now;
    if (is_replaced && queue.remove(each.id, job)) misses.drop({each.id, job.release, 1});
  }
}

}  // namespace chimera
