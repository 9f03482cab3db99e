// SPDX-License-Identifier: Apache-2.0
// The receipt of a switch or takeover as JSON: docs/formats/receipt.md.
#pragma once

#include <cstdint>
#include <string>

#include "chimera/runtime/plan/switch_receipt.h"

namespace chimera::control {

/// Facts of a switch that the manager knows and its receipt lacks. Plain value.
struct ReceiptFrame {
  std::string asked_by = {};   ///< a role and a user, "operate:ann"; "": as the receipt says
  std::int64_t wall_ns = -1;   ///< nanoseconds since 1970 of the request; -1: virtual time
};

/// One JSON object, which begins with its number and the origin; "" for a request for what was in force.
/// Context: setup.
std::string receipt_json(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin,
                         const ReceiptFrame& frame = {});

}  // namespace chimera::control
