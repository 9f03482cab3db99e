// SPDX-License-Identifier: Apache-2.0
// The condition under which a configuration may be switched to: a comparison of one number of a state variable with a
// limit. docs/formats/description.md, `safe_when`.
#pragma once

#include <cmath>
#include <cstdint>

#include "chimera/base/ids.h"

namespace chimera {

enum class Relation : std::uint8_t { kLess, kAtMost, kMore, kAtLeast, kEqual, kUnequal };

/// The sign as text: "<". Context: any.
constexpr const char* sign_of(Relation comparison) noexcept {
  constexpr const char* kSigns[] = {"<", "<=", ">", ">=", "==", "!="};
  return kSigns[static_cast<int>(comparison)];
}

/// `variable[element] comparison limit`. Without a variable there is no condition. Plain data.
struct SafeCondition {
  VariableId variable;
  std::uint32_t element = 0;
  Relation comparison = Relation::kLess;
  double limit = 0;  ///< finite, in the unit of the variable; a truth value is 0 or 1

  constexpr bool is_there() const noexcept { return variable.is_valid(); }
  constexpr bool operator==(const SafeCondition&) const noexcept = default;
};

/// NaN is never safe. Context: any.
inline bool is_safe(const SafeCondition& condition, double value) noexcept {
  if (std::isnan(value)) return false;
  switch (condition.comparison) {
    case Relation::kLess: return value < condition.limit;
    case Relation::kAtMost: return value <= condition.limit;
    case Relation::kMore: return value > condition.limit;
    case Relation::kAtLeast: return value >= condition.limit;
    case Relation::kEqual: return value == condition.limit;
    case Relation::kUnequal: return value != condition.limit;
  }
  return false;
}

}  // namespace chimera
