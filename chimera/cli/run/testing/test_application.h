// SPDX-License-Identifier: Apache-2.0
// An application made from a description that stands in a test.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "chimera/cli/files/testing/test_place.h"
#include "chimera/cli/run/application.h"

namespace chimera::cli {

/// The application that `text` describes, its tasks in NOT-CREATED.
inline Application test_application(const std::string& text, const Library& library) {
  return *Application::load(test_configuration(text, library), library);
}

}  // namespace chimera::cli
