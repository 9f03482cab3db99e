// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/binding.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {

BindingTable::BindingTable(std::uint64_t generation, std::span<const Binding> rows) noexcept
    : generation_(generation), rows_(rows) {
  CHIMERA_ASSERT(generation > 0);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const Binding& a = rows[i - 1];
    const Binding& b = rows[i];
    CHIMERA_ASSERT(a.consumer < b.consumer || (a.consumer == b.consumer && a.input < b.input));
  }
}

std::span<const Binding> BindingTable::of(TaskId consumer) const noexcept {
  const auto before = [](const Binding& row, TaskId id) { return row.consumer < id; };
  const auto after = [](TaskId id, const Binding& row) { return id < row.consumer; };
  const auto first = std::lower_bound(rows_.begin(), rows_.end(), consumer, before);
  const auto last = std::upper_bound(first, rows_.end(), consumer, after);
  return {first, last};
}

bool BindingTable::names(const Link& source) const noexcept {
  return std::any_of(rows_.begin(), rows_.end(), [&](const Binding& row) { return row.source == source; });
}

}  // namespace chimera
