// SPDX-License-Identifier: Apache-2.0
// Ports of other components to which a port can be joined, as far as the descriptors show it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chimera/catalogue/library.h"

namespace chimera::web {

/// A port of a component.
struct FittingPort {
  std::string component, port;

  bool operator==(const FittingPort&) const = default;
};

/// The first ones, and how many there are beyond them.
struct FittingPorts {
  std::vector<FittingPort> with;
  std::size_t n_more = 0;
};

/// Outputs of the library for an input, inputs for an output: of the same type, and of one unit and shape as far as no
/// variable is in them. Ports without variables come first, then by name; at most `most`. Context: setup.
FittingPorts fitting_ports(const Library& library, const PortDescriptor& port, std::size_t most);

}  // namespace chimera::web
