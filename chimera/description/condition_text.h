// SPDX-License-Identifier: Apache-2.0
// The text of a condition, `speed < 0.1 rad/s` or `q[2] >= -1`: a number of a variable, a comparison and a value.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "chimera/description/node.h"
#include "chimera/description/report.h"
#include "chimera/runtime/safe_condition.h"

namespace chimera {

/// A condition as written; its variable is not checked yet.
struct DraftCondition {
  Word variable;
  std::optional<std::uint32_t> element;  ///< of `[i]`
  Relation comparison = Relation::kLess;
  Node value;  ///< a scalar
};

/// Returns nullopt after adding one fault to `report`. `what` names the value in messages. Context: setup.
std::optional<DraftCondition> read_condition(const Node& node, const std::string& what, Report& report);

}  // namespace chimera
