// SPDX-License-Identifier: Apache-2.0
// The receipt of a switch or takeover as text: docs/formats/receipt.md.
#pragma once

#include <string>
#include <vector>

#include "chimera/runtime/plan/switch_receipt.h"

namespace chimera::control {

/// A line, and one more for each variable that moved beyond its limit in a first cycle. Times count from `origin`.
/// Context: setup.
std::string receipt_text(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin);

/// The lines of moved variables alone, without their line ends: "bump: ...". Context: setup.
std::vector<std::string> bump_lines(const SwitchReceipt& receipt, const ApplicationSpec& spec);

}  // namespace chimera::control
