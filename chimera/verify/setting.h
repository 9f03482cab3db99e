// SPDX-License-Identifier: Apache-2.0
// Values given beside a description: `--set kp '100 N.m/rad'`. The rules of the description judge them like values of
// the file.
#pragma once

#include <span>
#include <string>

#include "chimera/description/node.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera {

/// A value. `name` is an operator variable or a constant of the file, or TASK.CONSTANT: an own constant of one task, in
/// the file or not.
struct Setting {
  std::string name;
  std::string value;  ///< with its unit: "100 N.m/rad", "[1, 2]", "[1 2] rad"
  std::string said;   ///< the text of the user, for messages: "--set kp '100 N.m/rad'"
};

/// Turns a value of a command line into one of a description: "[1 2] rad" is "[1 rad, 2 rad]". A value that is no YAML
/// stays a text, and the rules refuse it. Context: setup.
Node written_value(const std::string& text);

/// Returns `configuration` with these values in place of those of the file. Refuses all or none, with the messages of
/// the rules, the text of the user and the place in the file. Refuses a wrong name, with the nearest right one; a name
/// that is set twice; and a variable that a task produces. Context: setup; takes the time of a verification.
Result<Configuration> with_settings(const Configuration& configuration, const Library& library,
                                    std::span<const Setting> settings, Overload overload = Overload::kRefused);

/// "'axis.kd' is the default of an input: write 'kd' under operator: to set it". Context: setup.
std::string default_of_an_input(const std::string& variable);

/// "'ki' is a constant of task 'control' (2 V/rad) ...": why that name is no state variable, and what to do; "": it is
/// no constant. `name`: a constant, or TASK.CONSTANT. Context: setup.
std::string about_constant(const Configuration& configuration, const std::string& name);

/// Checks that these names can be set, each once; ignores their values. Refuses like with_settings(). Context: setup.
Result<void> knows(const Configuration& configuration, std::span<const Setting> settings);

/// Converts the numbers of a value to `unit`, the one that its variable has had since the start. Refuses a unit of
/// another dimension; what is no quantity stays, and the rules refuse it. Context: setup.
Result<Node> in_unit(Node value, const std::string& unit, const UnitSystem& units);

/// The value `now`, a text of a description, with each number in the unit of the number at its place in `written`.
/// Context: setup.
std::string in_words_of(const Node& written, const std::string& now, const UnitSystem& units);

/// Like with_settings(), for one operator variable whose value changes while tasks run. Its type, unit and shape stay.
/// Context: setup; takes the time of a verification.
Result<Configuration> with_new_value(const Configuration& configuration, const Library& library,
                                     const Setting& setting);

}  // namespace chimera
