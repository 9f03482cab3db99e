// SPDX-License-Identifier: Apache-2.0
// Events of a task behind a server, and the capacity for the job that answers them.
#include "chimera/runtime/job/sporadic_job.h"

#include <algorithm>

namespace chimera {

SporadicJob::SporadicJob(const ServerSpec& spec, Nanoseconds granularity) noexcept
    : spec_(spec), smallest_(std::min(granularity, Nanoseconds{spec.capacity.count / 4})), server_(spec, {}) {}

bool SporadicJob::accept(std::uint32_t& waiting, Nanoseconds now) noexcept {
  if (has_event_) return true;
  if (waiting == 0) return is_active_ = false;
  --waiting;
  if (!is_active_) server_.activate(now);
  is_active_ = has_event_ = true;
  release_ = now;
  return true;
}

bool SporadicJob::forget() noexcept {
  const bool is_lost = has_event_;
  is_active_ = has_event_ = false;
  return is_lost;
}

// A rest that is too small is charged, so that the server returns it later together with the rest of the capacity.
SporadicJob::Grant SporadicJob::grant(Nanoseconds now) noexcept {
  server_.follow(now);
  Nanoseconds left = server_.allowance(now);
  for (std::size_t i = 0; i < ServerState::kPieces && left > Nanoseconds{} && left < smallest_; ++i) {
    server_.charge(left);
    left = server_.allowance(now);
  }
  const bool has_another_deadline = deadline_ != server_.deadline();
  deadline_ = server_.deadline();
  return {left > Nanoseconds{}, has_another_deadline};
}

}  // namespace chimera
