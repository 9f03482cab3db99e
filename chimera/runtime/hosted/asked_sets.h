// SPDX-License-Identifier: Apache-2.0
// Finds the target sets of lists of tasks, for a script and for tasks that ask, and keeps refused lists.
#pragma once

#include <string>
#include <vector>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/switch_request.h"

namespace chimera {

/// Lists that led to no legal set.
struct RefusedLists {
  Nanoseconds at;  ///< on the executor's clock
  SwitchRequest request;
  std::string why;
};

/// Gives the same results as the manager (hosted/asked_set.h).
class AskedSets final : public AskedTasks {
 public:
  /// The spec outlives this. `on_one_cpu`: as in asked_set(). Context: setup.
  explicit AskedSets(const ApplicationSpec& spec, bool on_one_cpu = false) : spec_(spec), on_one_cpu_(on_one_cpu) {
    refused_.reserve(kKept);
  }

  bool find(const SwitchRequest& request, const TaskBits& on, Nanoseconds now, TaskBits& target) override;
  /// The first kKept, in order of time. Context: setup, between runs.
  const std::vector<RefusedLists>& refused() const noexcept { return refused_; }

  static constexpr std::size_t kKept = 64;

 private:
  const ApplicationSpec& spec_;
  const bool on_one_cpu_;
  std::vector<RefusedLists> refused_;
};

}  // namespace chimera
