// SPDX-License-Identifier: Apache-2.0
// The plans of all switches between two configurations, made as the runtime makes them.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "chimera/analysis/recorded_profile.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/switch_plan.h"

namespace chimera::bake {

/// Context: setup.
class BakedPlans {
 public:
  /// Judges deadlines over each switch by the times of the profile, which was recorded on the target; null: by none.
  BakedPlans(const ApplicationSpec& spec, const RecordedProfile* profile);
  BakedPlans(const BakedPlans&) = delete;
  BakedPlans& operator=(const BakedPlans&) = delete;

  /// By `before * sets.size() + after`; empty if there is one configuration at most. A plan from a set to itself, or to
  /// one of the same tasks, is empty.
  std::span<const SwitchPlan> all() const noexcept { return plans_; }

 private:
  template <class T>
  std::span<const T> kept(std::deque<std::vector<T>>& all, std::span<const T> list) {
    return all.emplace_back(list.begin(), list.end());
  }

  std::vector<SwitchPlan> plans_;
  std::deque<std::vector<TaskId>> tasks_;
  std::deque<std::vector<Handover>> handovers_;
  std::deque<PlanAnswer> deadlines_;
};

}  // namespace chimera::bake
