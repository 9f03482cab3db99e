// SPDX-License-Identifier: Apache-2.0
// The warning to the user about a task whose `off` or `kill` failed.
#pragma once

#include <string>
#include <string_view>

#include "chimera/task/signal.h"

namespace chimera {

/// Is it one of the methods that turn a task's hardware off?
constexpr bool turns_off(Method method) noexcept { return method == Method::kOff || method == Method::kKill; }

/// "off failed: no answer: its hardware may not be off": of a method that answered a fault. Context: setup.
std::string not_off_text(Method method, std::string_view fault);

/// "second ended by signal 11 (SIGSEGV) in pid.off: its hardware may not be off": of one that did not come to its end.
/// Context: setup.
std::string not_off_text(std::string_view cause);

}  // namespace chimera
