// SPDX-License-Identifier: Apache-2.0
// The setup of a component under trial: a description with this one task, from NAME.test.yaml. The missing parts are
// generated (docs/formats/component-test.md).
#pragma once

#include <string>

#include "chimera/catalogue/library.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera::component_test {

struct Setup {
  std::string file;          ///< of the description; empty: none, all parts are generated
  std::string folder;        ///< base of relative paths of resources; empty: the present folder
  std::string partner_text;  ///< replaces {partner} in resources
};

/// Verifies the description of a task of `component` alone with `units`. Refuses, in the report, breaches of the rules
/// and a description with other tasks. Context: setup; may block.
Verdict arrange(const Setup& setup, const LibraryEntry& component, const UnitSystem& units);

/// The component with all open properties of its out-vars settled: unit 1, one element, float64. For a component whose
/// outputs no task reads, so that no reader settles them. Context: setup.
Descriptor settled(const Descriptor& component);

/// The generated description for a component, from its descriptor alone. Context: setup.
std::string default_setup(const Descriptor& component);

}  // namespace chimera::component_test
