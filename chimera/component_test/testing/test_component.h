// SPDX-License-Identifier: Apache-2.0
// For the tests of this folder: components that have only a descriptor.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "chimera/component_test/inputs.h"
#include "chimera/component_test/setup.h"
#include "chimera/units/testing/unit_samples.h"

namespace chimera::component_test {

inline PortDescriptor port(const char* name, std::uint32_t kind, const char* unit, const char* shape = "") {
  PortDescriptor made;
  made.name = name;
  made.kind = kind;
  made.unit = unit;
  made.shape = shape;
  return made;
}

inline PortDescriptor ranged(PortDescriptor made, double low, double high) {
  made.has_range = true;
  made.min = low;
  made.max = high;
  return made;
}

/// Asserts that the descriptor is legal and returns its library entry.
inline LibraryEntry component(std::vector<PortDescriptor> ports) {
  LibraryEntry entry;
  entry.descriptor.name = "thing";
  entry.descriptor.default_rate_hz = 100;
  entry.descriptor.methods[CHIMERA_CYCLE] = true;
  entry.descriptor.ports = std::move(ports);
  const auto completed = complete(entry.descriptor);
  EXPECT_TRUE(completed) << completed.error().message.c_str();
  return entry;
}

/// The form of its inputs with a generated setup.
inline InputForm form_of(const LibraryEntry& entry) {
  const Verdict verdict = arrange({}, entry, our_units());
  EXPECT_TRUE(verdict.configuration.has_value()) << verdict.report.text();
  return InputForm::of(*verdict.configuration, entry.descriptor);
}

}  // namespace chimera::component_test
