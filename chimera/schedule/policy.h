// SPDX-License-Identifier: Apache-2.0
// Decides which of two ready jobs is more urgent: pure functions, the same in every executor.
// Rate monotonic and earliest deadline: Liu & Layland 1973. Maximum urgency first: Stewart & Khosla 1991
// (criticality, then the dynamic part, then the user's priority; a full tie keeps the running job).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "chimera/base/time.h"

namespace chimera {

enum class Policy : std::uint8_t { kRm, kEdf, kLlf, kMuf, kMufLaxity };

/// The words of descriptions and reports, in the order of Policy.
inline constexpr std::array<std::string_view, 5> kPolicyNames = {"rm", "edf", "llf", "muf", "muf-laxity"};

/// Context: any; pure.
constexpr std::string_view policy_name(Policy policy) noexcept {
  return kPolicyNames[static_cast<std::size_t>(policy)];
}

/// True if all tasks of one criticality run before all of a lower one. Context: any; pure.
constexpr bool has_criticalities(Policy policy) noexcept {
  return policy == Policy::kMuf || policy == Policy::kMufLaxity;
}

/// The data of a job that a policy compares. `remaining` is its budget minus the execution time used.
struct Urgency {
  std::uint32_t criticality = 0;
  std::uint32_t user_priority = 0;
  Nanoseconds period;
  Nanoseconds deadline;   ///< absolute
  Nanoseconds remaining;
};

/// True if `a` must run before `b` at this instant; false on a full tie, so that the running job stays. Laxity is
/// deadline - now - remaining; `now` is common to both and cancels. Context: any; wait-free.
constexpr bool is_more_urgent(Policy policy, const Urgency& a, const Urgency& b) noexcept {
  if (has_criticalities(policy) && a.criticality != b.criticality) return a.criticality > b.criticality;
  switch (policy) {
    case Policy::kRm:
      if (a.period != b.period) return a.period < b.period;
      break;
    case Policy::kEdf:
    case Policy::kMuf:
      if (a.deadline != b.deadline) return a.deadline < b.deadline;
      break;
    case Policy::kLlf:
    case Policy::kMufLaxity: {
      const Nanoseconds la = a.deadline - a.remaining, lb = b.deadline - b.remaining;
      if (la != lb) return la < lb;
      break;
    }
  }
  return a.user_priority > b.user_priority;
}

/// The lower one of two equals that are released together runs first: by TaskSpec::place, then by the index of the
/// task. Context: any; wait-free.
constexpr std::uint64_t tie_of(std::uint32_t place, std::uint32_t index) noexcept {
  return std::uint64_t{place} << 32 | index;
}

}  // namespace chimera
