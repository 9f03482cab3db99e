// SPDX-License-Identifier: Apache-2.0
// The numbers of a model file, looked at before MuJoCo reads it: it takes NaN and infinity without a word, fills up a
// short list with zeros, and of "1.5" where a whole number belongs takes the 1.
#pragma once

#include <string>

#include "chimera/base/result.h"

namespace chimera::library {

/// Refuses, with file, line, element and attribute: `nan` and `inf` where a number belongs; in an attribute of whole
/// numbers anything else; too few or too many numbers in a point, an axis, an orientation, a range or an inertia; in a
/// URDF file, in an attribute of numbers, whatever is none. Follows <include>. What is no XML is left to MuJoCo, which
/// says why. Context: setup; may block.
Result<void> check_model_numbers(const std::string& path);

}  // namespace chimera::library
