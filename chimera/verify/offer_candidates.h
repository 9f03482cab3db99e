// SPDX-License-Identifier: Apache-2.0
// Edits that may remedy a fault. offers.h tries them.
#pragma once

#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/verify/outline.h"

namespace chimera {

/// The likeliest edit comes first; empty: there is none. Context: setup.
std::vector<Offer> candidates_for(const Fault& fault, const Draft& draft, const Library& library,
                                  const Outline& outline);

}  // namespace chimera
