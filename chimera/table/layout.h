// SPDX-License-Identifier: Apache-2.0
// Plans the place of each group and variable in the table, once. Extents count with their maxima, values lie at
// multiples of 8 within the payload, groups at multiples of 64 within the region. docs/formats/table.md.
#pragma once

#include <cstdint>
#include <span>

#include "chimera/base/ids.h"
#include "chimera/base/result.h"
#include "chimera/table/variable.h"

namespace chimera {

inline constexpr std::uint32_t kMaxGroupVariables = 64;      // bits of chimera_slot::valid
inline constexpr std::uint64_t kMaxPayloadBytes = 1u << 24;  // larger values belong behind a resource port

/// A group in the region: group_bytes(payload_bytes) bytes from `offset`.
struct GroupPlace {
  std::uint64_t offset = 0;          ///< from the start of the region; multiple of 64
  std::uint32_t payload_bytes = 0;   ///< multiple of 8; 0 for a group without variables
  std::uint32_t first_variable = 0;  ///< its variables are first_variable .. first_variable + variables - 1
  std::uint32_t variables = 0;
};

/// A variable in the payload of its group.
struct VariablePlace {
  GroupId group;
  std::uint32_t offset = 0;  ///< from the start of the payload; multiple of 8
  std::uint32_t bytes = 0;   ///< at its largest
  std::uint32_t bit = 0;     ///< in chimera_slot::valid
};

/// The plan. It owns no memory: plan() writes the places into spans that the caller keeps alive. Immutable after
/// plan(). Context of reading: any; wait-free.
class TableLayout {
 public:
  TableLayout() noexcept = default;

  /// The number of variables in all groups: the length that plan() needs for `variables`. Context: setup.
  static std::uint32_t count_variables(std::span<const GroupSpec> specs) noexcept;
  /// Places the groups one after another in the given order. Refuses a variable of zero bytes, more than 64 variables
  /// or 16 MiB of values in a group, and a region below region_bytes(), with the missing bytes. Requires: groups.size()
  /// >= specs.size(), variables.size() >= count_variables(specs). Context: setup.
  static Result<TableLayout> plan(std::span<const GroupSpec> specs, std::uint64_t available_bytes,
                                  std::span<GroupPlace> groups, std::span<VariablePlace> variables) noexcept;

  std::span<const GroupPlace> groups() const noexcept { return groups_; }
  std::span<const VariablePlace> variables() const noexcept { return variables_; }
  const GroupPlace& group(GroupId id) const noexcept;
  /// Variable `index` of the group, counted as in its GroupSpec.
  const VariablePlace& variable(GroupId id, std::uint32_t index) const noexcept;
  /// Bytes of the region in use, from its start.
  std::uint64_t region_bytes() const noexcept { return region_bytes_; }
  /// Equal in two processes only if their owners, names, sizes and places are equal (64-bit FNV-1a).
  std::uint64_t hash() const noexcept { return hash_; }

 private:
  std::span<const GroupPlace> groups_;
  std::span<const VariablePlace> variables_;
  std::uint64_t region_bytes_ = 0;
  std::uint64_t hash_ = 0;
};

}  // namespace chimera
