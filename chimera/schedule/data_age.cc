// SPDX-License-Identifier: Apache-2.0
// Adds up the worst age along a chain of periodic tasks.
#include "chimera/schedule/data_age.h"

#include "chimera/base/assert.h"

namespace chimera {

bool goes_always_before(const Work& a, std::uint32_t a_index, const Work& b, std::uint32_t b_index,
                        const ProcessorUse& use) noexcept {
  if (a.rtpu != b.rtpu || a.server || b.server) return false;
  if (use.policy == Policy::kLlf) return false;
  if (has_criticalities(use.policy) && a.criticality != b.criticality) return a.criticality > b.criticality;
  if (use.policy == Policy::kMufLaxity) return false;
  const Nanoseconds ka = use.policy == Policy::kRm ? a.period : a.deadline;
  const Nanoseconds kb = use.policy == Policy::kRm ? b.period : b.deadline;
  if (ka != kb) return ka < kb;
  if (a.user_priority != b.user_priority) return a.user_priority > b.user_priority;
  // On a tie, jobs released together run in the order of their ties; otherwise the running job stays.
  return a.period == b.period && a.offset == b.offset && tie_of(a.place, a_index) < tie_of(b.place, b_index);
}

Nanoseconds worst_data_age(std::span<const ChainLink> chain) noexcept {
  CHIMERA_ASSERT(!chain.empty());
  Nanoseconds age;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const ChainLink& link = chain[i];
    if (link.response == kNever) return kNever;
    const bool is_last = i + 1 == chain.size();
    if (is_last || !link.goes_before_next) {
      age += link.work.period + link.response;
      continue;
    }
    const Work& next = chain[i + 1].work;
    const bool is_on_grid = next.period.count % link.work.period.count == 0 &&
                            (next.offset - link.work.offset).count % link.work.period.count == 0;
    if (!is_on_grid) age += link.work.period;
  }
  return age;
}

}  // namespace chimera
