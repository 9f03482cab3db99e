// SPDX-License-Identifier: Apache-2.0
// `chimera list` and `chimera describe`: what components are there, and what one of them is.
#pragma once

#include <string>

#include "chimera/cli/files/file_refusal.h"
#include "chimera/catalogue/workplace.h"

namespace chimera::cli {

/// One line for each installed component. Descriptors that cannot be read are named on standard error.
/// Context: setup; may block.
CommandResult list(const Workplace& workplace, bool json);

/// The data sheet of one component: purpose, rate, methods, ports. Context: setup; may block.
CommandResult describe_component(const std::string& name, const Workplace& workplace, bool json);

}  // namespace chimera::cli
