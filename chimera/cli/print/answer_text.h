// SPDX-License-Identifier: Apache-2.0
// Every other answer of docs/formats/control.md as text for people.
#pragma once

#include <cstddef>
#include <string>

#include "chimera/text/json.h"

namespace chimera::cli {

/// The one line of `--json`, its end included. File names and arguments may be no UTF-8: what is not becomes the
/// replacement character. Context of all: setup.
std::string json_line(const Json& answer);
/// `get` and `set`: one line a variable, "kp = [100 90] N.m/rad  (operator, 1.20 s ago)".
std::string readings_text(const Json& answer);
/// `signal`: "pid: ON -> OFF", one line a task.
std::string signal_text(const Json& answer);
/// `save`: lines for the section `operator:` of a description.
std::string save_text(const Json& answer);
/// `ring`: "lamp: rung" for each.
std::string ring_text(const Json& answer);
std::string switch_text(const Json& answer);
/// `drill`: a line for each hardware task, one about the flag.
std::string drill_text(const Json& answer);
/// `plan`: the effect of a switch, or why it would be refused.
std::string plan_text(const Json& answer);
/// `flag`: "flag up" or "flag down".
std::string flag_text(const Json& answer);
/// `why` on one screen of `height` lines: producer, age and inputs of the variable; then its ancestors, those in
/// trouble before those that are well; the last line is the verdict.
std::string why_text(const Json& answer, std::size_t height);
/// A refusal: "pid: the words; the remedy (did you mean 'pid'?)" from the members of an error.
std::string refusal_text(const std::string& message, const Json& data);

}  // namespace chimera::cli
