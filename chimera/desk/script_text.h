// SPDX-License-Identifier: Apache-2.0
// Timed acts as written on the command line: "2 s: off pid", "2.5 s: flag up".
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/script.h"
#include "chimera/runtime/application_spec.h"

namespace chimera::desk {

/// The acts in order of time. Each text is `DURATION: SIGNAL TASK` with spawn, on, off, kill, clear, reinit or ring, or
/// `DURATION: flag up|down`. Refuses with the text and what would be right. Context: setup.
Result<std::vector<ScriptAct>> parse_script(std::span<const std::string> texts, const ApplicationSpec& spec);

}  // namespace chimera::desk
