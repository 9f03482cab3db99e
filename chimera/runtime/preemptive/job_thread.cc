// SPDX-License-Identifier: Apache-2.0
// The thread that runs the jobs of one task: how it is woken, and the execution time of its present job.
#include "chimera/runtime/preemptive/job_thread.h"

namespace chimera {

JobThread::JobThread(Task& owner) noexcept : task(owner), spec(*owner.spec), id(owner.id) {
  if (spec.server) sporadic.emplace(*spec.server);
}

void JobThread::attach() noexcept {
  thread_id_ = carrier = this_thread();
  use_decimal_point();
  if (sporadic) sporadic->attach();
}

void JobThread::wake() noexcept {
  bell_.ring();
  if (sporadic) sporadic->bell().ring();
}

Nanoseconds JobThread::used() const noexcept {
  const Nanoseconds all = used_by(thread_id_);
  return all == kNever ? Nanoseconds{} : all - used_before();
}

}  // namespace chimera
