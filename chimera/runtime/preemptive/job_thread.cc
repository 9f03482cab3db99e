// SPDX-License-Identifier: Apache-2.0
// The moves of a job from phase to phase, and the thread that runs it.
#include "chimera/runtime/preemptive/job_thread.h"

#include "chimera/base/assert.h"

namespace chimera {

JobThread::JobThread(Task& owner) noexcept : task(owner), spec(*owner.spec), id(owner.id) {
  if (spec.server) sporadic.emplace(*spec.server);
}

void JobThread::move(JobPhase from, JobPhase to) noexcept {
  CHIMERA_ASSERT(phase() == from);
  phase_.store(to, std::memory_order_release);
}

void JobThread::begin_method() noexcept {
  CHIMERA_ASSERT(is_free());
  phase_.store(JobPhase::kMethod, std::memory_order_release);
}

void JobThread::attach() noexcept {
  thread_id_ = carrier = this_thread();
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
