// SPDX-License-Identifier: Apache-2.0
// The receipt of a switch as text and as JSON: docs/formats/receipt.md.
#pragma once

#include <string>

#include "chimera/runtime/switch_receipt.h"

namespace chimera::control {

/// A line, and one more for each variable that moved beyond its limit in a first cycle. Times count from `origin`.
/// Context: setup.
std::string receipt_text(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin);

/// One JSON object; "" for a request for what was in force. `asked_by`: a role; "": as the receipt says.
/// Context: setup.
std::string receipt_json(const SwitchReceipt& receipt, const ApplicationSpec& spec, Nanoseconds origin,
                         std::string_view asked_by = {});

/// "'hand'"; of kNoSet "other tasks". Context: setup.
std::string set_text(std::uint32_t set, const ApplicationSpec& spec);

/// Who asks, as receipts say it: "on_miss of pid". Context: setup.
std::string asked_by(const SwitchRequest& request, const ApplicationSpec& spec);

/// Why a switch was refused or aborted: the word of the format, and a sentence. Context: setup.
const char* reason_word(NoSwitch why) noexcept;
std::string reason_text(const SwitchReceipt& receipt, const ApplicationSpec& spec);

}  // namespace chimera::control
