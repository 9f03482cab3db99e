// SPDX-License-Identifier: Apache-2.0
// A component for tests of descriptions: a name and ports, with a rate and a cycle.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "chimera/load/descriptor.h"

namespace chimera {

inline Descriptor sample_component(std::string name, std::vector<PortDescriptor> ports, double rate_hz = 100) {
  Descriptor d;
  d.name = std::move(name);
  d.default_rate_hz = rate_hz;
  d.methods[CHIMERA_CYCLE] = true;
  d.ports = std::move(ports);
  EXPECT_TRUE(complete(d));
  return d;
}

}  // namespace chimera
