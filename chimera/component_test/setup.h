// SPDX-License-Identifier: Apache-2.0
// What a component under trial is given: the description with this one task, from NAME.test.yaml and, where that says
// nothing, made up (docs/formats/component-test.md).
#pragma once

#include <string>

#include "chimera/catalogue/library.h"
#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera::component_test {

struct Setup {
  std::string file;          ///< of the description; empty: none, everything is made up
  std::string folder;        ///< that relative paths of resources start from; empty: the present one
  std::string partner_text;  ///< stands for {partner} in resources
};

/// The description of a task of `component` alone, judged by every rule of legality with `units`. Refuses in the
/// report: what the rules refuse, and a description with other tasks. Context: setup; may block.
Verdict arrange(const Setup& setup, const LibraryEntry& component, const UnitSystem& units);

/// The component with everything settled that is open in its out-vars: unit 1, one element, float64. For one whose
/// outputs nobody reads, so that nothing settles them. Context: setup.
Descriptor settled(const Descriptor& component);

/// The description that is made up for a component of which nothing is known but its descriptor. Context: setup.
std::string default_setup(const Descriptor& component);

}  // namespace chimera::component_test
