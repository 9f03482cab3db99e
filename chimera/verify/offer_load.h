// SPDX-License-Identifier: Apache-2.0
// Edits that may remedy a fault of time: lower rates, and another rtpu for a task.
#pragma once

#include <vector>

#include "chimera/verify/outline.h"

namespace chimera {

/// Halves the rate of the heaviest task again and again until the CPU of a `utilisation` fault has room. A task with a
/// server gets twice the period of the server. Context: setup.
std::vector<Offer> lighter(const Fault& fault, const Draft& draft, const Outline& outline);

/// The task on each other rtpu. Context: setup.
std::vector<Offer> moves(const OutlineTask& task, const Outline& outline);

}  // namespace chimera
