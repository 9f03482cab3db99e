// SPDX-License-Identifier: Apache-2.0
// A whole subsystem in virtual time: the real step function, simulated processes, faces, deaths and delays by seed.
#pragma once

#include <cstdint>
#include <string>

#include "tests/subsystem/world.h"

namespace chimera::simulated {

struct Outcome {
  std::string failure;  ///< "" when everything held
  std::uint64_t hash = 0;
  std::uint64_t signals = 0;
  std::uint64_t deaths = 0;
  std::size_t tasks = 0;
  Tally tally;
};

/// One run. `prints`: every event to standard output.
Outcome simulate(std::uint64_t seed, Defect defect = Defect::kNone, bool prints = false);

}  // namespace chimera::simulated
