// SPDX-License-Identifier: Apache-2.0
// Values given beside a description: `--set kp '100 N.m/rad'`. They are judged by the rules of the description, as if
// they had stood there.
#pragma once

#include <span>
#include <string>

#include "chimera/description/node.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera {

/// One value. `name` is an operator variable or a constant of the file, or TASK.CONSTANT: a constant that one task has
/// for itself, whether the file says it or not.
struct Setting {
  std::string name;
  std::string value;  ///< with its unit: "100 N.m/rad", "[1, 2]", "[1 2] rad"
  std::string said;   ///< how its user wrote it, for messages: "--set kp '100 N.m/rad'"
};

/// A value in the words of a command line as one of a description: "[1 2] rad" is "[1 rad, 2 rad]"; what is no YAML
/// stays a text, for the rules to refuse. Context: setup.
Node written_value(const std::string& text);

/// `configuration` as if the file had these values. Refuses, all or none, with the words of the rules behind what its
/// user wrote, and the place in the file; a wrong name with the nearest right one, a name that is set twice, and a
/// variable that a task produces. Context: setup; as long as a verification.
Result<Configuration> with_settings(const Configuration& configuration, const Library& library,
                                    std::span<const Setting> settings, Overload overload = Overload::kRefused);

/// Whether these names can be set, each once; their values are not looked at. Refuses as with_settings().
/// Context: setup.
Result<void> knows(const Configuration& configuration, std::span<const Setting> settings);

/// The numbers of a value in `unit` where they are convertible to it; whatever is not stays, for the rules to refuse.
/// A variable that has its unit from its first value keeps it that way. Context: setup.
Node in_unit(Node value, const std::string& unit, const UnitSystem& units);

/// As with_settings(), for one operator variable whose value changes while tasks run: its type, unit and shape stay as
/// they are. Context: setup; as long as a verification.
Result<Configuration> with_new_value(const Configuration& configuration, const Library& library,
                                     const Setting& setting);

}  // namespace chimera
