// SPDX-License-Identifier: Apache-2.0
// `chimera test COMPONENT...`: runs each component alone, in virtual time, and checks it without a written test.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/catalogue/workplace.h"

namespace chimera::cli {

struct TestOptions {
  std::vector<std::string> components;  ///< names of the library, or paths of shared objects
  bool all = false;                     ///< every component of the library
  std::string setup;                    ///< description of the task; empty: NAME.test.yaml beside the component, if any
  std::string inputs;                   ///< recording; empty: NAME.test.csv beside the component, else generated
  std::vector<std::string> names;       ///< what in[0], in[1], ... of the recording are
  std::uint64_t seed = 1;
  std::size_t cycles = 1000;            ///< of generated inputs
  Nanoseconds patience = seconds(10);
  bool json = false;
};

/// A report for each component; refused (1) when one fails or cannot be tested. Call it with one thread.
/// Context: setup; may block.
CommandResult test_components(const TestOptions& options, const Workplace& workplace);

}  // namespace chimera::cli
