// SPDX-License-Identifier: Apache-2.0
// For tests: a car of either kind on a level road, with released pedals.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string_view>

#include "chimera/task/rig.h"

namespace chimera::library {

struct CarRig : Rig {
  explicit CarRig(const char* component) : Rig(component) {
    resource("road", "0:0");
    if (std::string_view(component) == "electric_car") {
      set("fm", 0.0);
    } else {
      set("gas", 0.0);
      set("fb", 0.0);
    }
  }
  /// Returns false after the first cycle that fails.
  bool drive(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 100 + 0.5); ++i)
      if (!cycle(milliseconds(10))) return false;
    return true;
  }
  /// m/s.
  double speed() { return get<double>("speed") / 3.6; }
};

/// A value of a constant that a car refuses, and the text of the refusal.
struct WrongConstant {
  const char* name;
  double value;
  const char* text;
};

inline void expect_refused(const char* component, std::initializer_list<WrongConstant> constants) {
  for (const WrongConstant& wrong : constants) {
    CarRig rig(component);
    rig.set(wrong.name, wrong.value);
    EXPECT_EQ(rig.init().text, wrong.text) << wrong.value;
  }
}

}  // namespace chimera::library
