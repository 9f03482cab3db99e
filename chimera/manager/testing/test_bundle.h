// SPDX-License-Identifier: Apache-2.0
// For tests: the components of this build tree, the units of this source tree, a description written in a test.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/manager/state/bundle.h"
#include "chimera/units/testing/unit_samples.h"

namespace chimera::manager {

inline Library test_library() {
  const std::string folders[] = {build_path("components")};
  return Library::make(folders, our_units());
}

inline Bundle test_bundle(const std::string& description) {
  return {"0.1.0", description.empty() ? "" : "test.yaml", description, {}, {}, {}, test_library()};
}

}  // namespace chimera::manager
