// SPDX-License-Identifier: Apache-2.0
// For tests: the unit system of this source tree.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/units/unit_system.h"

namespace chimera {

inline const UnitSystem& our_units() {
  static const UnitSystem kUnits = [] {
    const std::string files[] = {source_path("share/chimera/units.xml")};
    auto loaded = UnitSystem::load(files);
    EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().message.c_str());
    return *std::move(loaded);
  }();
  return kUnits;
}

inline Unit unit(std::string_view text) {
  const auto parsed = our_units().parse(text);
  EXPECT_TRUE(parsed) << text << ": " << (parsed ? "" : parsed.error().message.c_str());
  return parsed ? parsed.value() : Unit{};
}

}  // namespace chimera
