// SPDX-License-Identifier: Apache-2.0
// Who reads what, generation by generation. A table of bindings is made whole and never changed; hand-over of a
// variable is a new table with the next generation in which the consumers point at another group. An old writer that
// wakes up late writes where nobody looks any more.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/table/segment.h"

namespace chimera {

/// Input `input` of task `consumer` comes from the group at `source`.
struct Binding {
  TaskId consumer;
  std::uint32_t input = 0;
  Link source;
};

/// The bindings of one generation. Plain value over rows that outlive it; immutable. Context: any; wait-free.
class BindingTable {
 public:
  BindingTable() noexcept = default;
  /// Requires: rows in order of (consumer, input), none twice; generation above 0. Context: setup.
  BindingTable(std::uint64_t generation, std::span<const Binding> rows) noexcept;

  std::uint64_t generation() const noexcept { return generation_; }
  /// The rows of one consumer, in order of its inputs. O(log rows).
  std::span<const Binding> of(TaskId consumer) const noexcept;
  /// Does any consumer read this group? O(rows).
  bool names(const Link& source) const noexcept;

 private:
  std::uint64_t generation_ = 0;
  std::span<const Binding> rows_;
};

}  // namespace chimera
