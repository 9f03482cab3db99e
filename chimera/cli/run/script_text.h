// SPDX-License-Identifier: Apache-2.0
// Timed acts as written on the command line: "2 s: off pid", "2.5 s: flag up", "3 s: set kp 100 N.m/rad".
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/cycle/script.h"

namespace chimera::cli {

/// One act. Of `set`, `act` has the time only: what a value means is not known here; of `switch` with lists it names no
/// set.
struct TimedAct {
  ScriptAct act;
  std::string text;             ///< as its user wrote it
  std::string variable, value;  ///< of `set`
  TaskLists lists;              ///< of `switch` that names no configuration

  bool has_lists() const noexcept { return lists.are_there(); }
};

/// The acts in order of time. Each text is `DURATION: SIGNAL TASK` with spawn, on, off, kill, clear, reinit or ring,
/// `DURATION: flag up|down`, `DURATION: set VARIABLE VALUE`, `DURATION: switch CONFIGURATION`, `DURATION: switch --on
/// TASK... --off TASK...` or `DURATION: die RTPU`; at one instant deaths come first. Refuses with the text and what
/// would be right. Context: setup.
Result<std::vector<TimedAct>> parse_script(std::span<const std::string> texts, const ApplicationSpec& spec);

}  // namespace chimera::cli
