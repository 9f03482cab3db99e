// SPDX-License-Identifier: Apache-2.0
// Finds the mistake in a text that is no YAML. The parser only reports where it stopped, which is behind the mistake.
#pragma once

#include <string_view>

#include "chimera/description/report.h"

namespace chimera {

/// The fault of `text`, if the parser stopped at `at` with `reason`. Its place is the mistake, if it can be found (an
/// open bracket, a ':' without a space); otherwise `at`. It has a remedy. Context: setup.
Fault yaml_fault(std::string_view text, Place at, std::string_view reason);

}  // namespace chimera
