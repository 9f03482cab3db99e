// SPDX-License-Identifier: Apache-2.0
// For tests: the components of this build tree, the units of this source tree, a description written in a test.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "chimera/manager/bundle.h"

namespace chimera::manager {

inline UnitSystem test_units() {
  const std::string files[] = {std::string(std::getenv("CHIMERA_SOURCE")) + "/share/chimera/units.xml"};
  auto loaded = UnitSystem::load(files);
  EXPECT_TRUE(loaded) << loaded.error().message.c_str();
  return *std::move(loaded);
}

inline Library test_library() {
  const std::string folders[] = {std::string(std::getenv("CHIMERA_BUILD")) + "/components"};
  return Library::make(folders, test_units());
}

inline Bundle test_bundle(const std::string& description) {
  return {"0.1.0", description.empty() ? "" : "test.yaml", description, {}, {}, {}, test_library()};
}

}  // namespace chimera::manager
