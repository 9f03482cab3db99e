// SPDX-License-Identifier: Apache-2.0
// The receipt of a switch as text and as JSON: docs/formats/receipt.md.
#pragma once

#include <string>
#include <vector>

#include "chimera/runtime/switch_receipt.h"

namespace chimera::control {

/// A line, and one more for each variable that moved beyond its limit in a first cycle. Times count from `origin`.
/// Context: setup.
std::string receipt_text(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin);

/// The lines of such a text that are about a step beyond a limit: "bump: ...". Context: setup.
std::vector<std::string> bump_lines(const SwitchReceipt& receipt, const ApplicationSpec& spec);

/// What a manager knows of a switch beside its receipt. Plain value.
struct ReceiptFrame {
  std::string asked_by = {};   ///< a role and a user, "operate:ann"; "": as the receipt says
  std::int64_t wall_ns = -1;   ///< nanoseconds since 1970 of the request; -1: virtual time
  std::uint32_t tries = 1;     ///< plans that were announced for it
};

/// One JSON object, which begins with its number and the origin; "" for a request for what was in force.
/// Context: setup.
std::string receipt_json(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin,
                         const ReceiptFrame& frame = {});

/// "'hand'"; of kNoSet "other tasks". Context: setup.
std::string set_text(std::uint32_t set, const ApplicationSpec& spec);

/// Who asks, as receipts say it: "on_miss of pid". Context: setup.
std::string asked_by(const SwitchRequest& request, const ApplicationSpec& spec);

/// Why a switch goes the slow way: the words of the format, and a sentence; empty: it does not. Context: setup.
std::vector<std::string> slow_words(const SwitchWay& way);
std::string slow_text(const SwitchReceipt& receipt, const ApplicationSpec& spec);

/// Why a switch was refused or aborted: the word of the format, and a sentence. Context: setup.
const char* reason_word(NoSwitch why) noexcept;
std::string reason_text(const SwitchReceipt& receipt, const ApplicationSpec& spec);

}  // namespace chimera::control
