// SPDX-License-Identifier: Apache-2.0
// The reason why a switch goes the slow way, was refused or aborted, and the origin of its request: words of the
// format, and sentences. docs/formats/receipt.md.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/runtime/plan/switch_words.h"

namespace chimera::control {

/// "'hand'"; of kNoSet "other tasks". Context of everything: setup.
std::string set_text(std::uint32_t set, const ApplicationSpec& spec);

/// "run with spare for main": the set, and the tasks that stand in for those of it that are not ON.
/// Requires: set_in_force() of `is_on` is that set.
std::string set_with_standbys(std::uint32_t set, const ApplicationSpec& spec,
                              const std::function<bool(TaskId)>& is_on);
/// As set_with_standbys(), of the tasks that were ON at the request; "" if they were no set.
std::string from_text(const SwitchReceipt& receipt, const ApplicationSpec& spec);

/// The origin of a request, as receipts say it: "on_miss of pid".
std::string asked_by(const SwitchRequest& request, const ApplicationSpec& spec);

/// Why a switch goes the slow way: the words of the format, and a sentence; empty: it does not.
std::vector<std::string> slow_words(const SwitchWay& way);
std::string slow_text(const SwitchReceipt& receipt, const ApplicationSpec& spec);

/// Why a switch was refused or aborted: the word of the format, and a sentence.
using chimera::reason_word;
std::string reason_text(const SwitchReceipt& receipt, const ApplicationSpec& spec);

}  // namespace chimera::control
