// SPDX-License-Identifier: Apache-2.0
// What is wrong with a text that is no YAML: the parser says where it gave up, which is behind the mistake.
#pragma once

#include <string_view>

#include "chimera/description/report.h"

namespace chimera {

/// The fault of `text`, at which the parser gave up at `at` saying `reason`: the place of the mistake where it can be
/// found (a bracket that nobody closes, a ':' without a space), else `at`, and what to do. Context: setup.
Fault yaml_fault(std::string_view text, Place at, std::string_view reason);

}  // namespace chimera
