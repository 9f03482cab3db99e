// SPDX-License-Identifier: Apache-2.0
// Asks for the set and keeps a refusal.
#include "chimera/runtime/hosted/asked_sets.h"

#include "chimera/runtime/hosted/asked_set.h"

namespace chimera {

bool AskedSets::find(const SwitchRequest& request, const TaskBits& on, Nanoseconds now, TaskBits& target) {
  const AskedSet asked = asked_set(spec_, on, request.lists, on_one_cpu_);
  target = asked.tasks;
  if (!asked && refused_.size() < kKept) refused_.push_back({now, request, asked.text()});
  return static_cast<bool>(asked);
}

}  // namespace chimera
