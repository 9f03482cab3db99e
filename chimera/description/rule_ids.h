// SPDX-License-Identifier: Apache-2.0
// The names of all legality rules. Report::add accepts no other. tests/verify/coverage.py demands a faulty description
// for each, so no rule lacks an example.
#pragma once

#include <array>
#include <string_view>

namespace chimera {

inline constexpr std::array<std::string_view, 87> kRules = {
    // the text
    "file-unreadable",
    "text-size",
    "text-encoding",
    "text-tab",
    "text-entries",
    "text-nesting",
    "value-size",
    "yaml-syntax",
    "yaml-anchor",
    "yaml-alias",
    "yaml-tag",
    "yaml-documents",
    "yaml-block-scalar",
    "yaml-key",
    // keys and words
    "key-twice",
    "key-unknown",
    "key-missing",
    "value-kind",
    "name-illegal",
    "word-unknown",
    "number-bad",
    "quantity-bad",
    "version-unknown",
    "count-limit",
    // components and ports
    "component-unknown",
    "component-object",
    "port-unknown",
    "port-kind",
    "port-stream",
    "alias-list",
    "repeated-port",
    "table-limit",
    "resource-missing",
    // links
    "input-unmet",
    "two-producers",
    "operator-produced",
    "variable-and-constant",
    // agreement of the ports of one variable
    "type-clash",
    "struct-clash",
    "unit-clash",
    "shape-clash",
    "type-unsolved",
    "unit-unsolved",
    "extent-unsolved",
    "type-contradiction",
    "unit-contradiction",
    "extent-contradiction",
    // constants
    "constant-unmet",
    "constant-two-producers",
    "constant-produced",
    "constant-circle",
    "constant-order",
    // values
    "value-type",
    "value-unit",
    "value-shape",
    "value-range",
    "value-field",
    // loops and time
    "loop-without-initial",
    "rate-missing",
    "time-range",
    "utilisation",
    // processors
    "rtpu-unknown",
    "rtpu-band",
    "board-rtpu",
    "link-time",
    // spares, servers, sets
    "standby-unknown",
    "standby-outputs",
    "standby-in-configuration",
    "standby-stale",
    "standby-hot",
    "server-periodic",
    "server-key",
    "safe-after",
    "configuration-unknown",
    "task-unknown",
    "configuration-empty",
    "configuration-task-twice",
    "condition-bad",
    "condition-variable",
    // sequences
    "sequence-step",
    "sequence-wait",
    "sequence-condition",
    // warnings
    "unused",
    "standby-same-rtpu",
    "resource-twice",
    // not supported by run
    "not-built",
    // refused at the start of run
    "unschedulable",
};

constexpr bool is_rule(std::string_view name) noexcept {
  for (const std::string_view rule : kRules)
    if (rule == name) return true;
  return false;
}

}  // namespace chimera
