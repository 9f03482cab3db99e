// SPDX-License-Identifier: Apache-2.0
// Checks the numbers of a model file before MuJoCo reads it. MuJoCo accepts NaN and infinity, fills a short list with
// zeros, and reads "1.5" as 1 where it expects a whole number.
#pragma once

#include <string>

#include "chimera/base/result.h"

namespace chimera::library {

/// Refuses, with file, line, element and attribute: `nan` and `inf` in place of a number; anything but a whole number
/// in an attribute of whole numbers; too few or too many numbers in a point, an axis, an orientation, a range or an
/// inertia; in a URDF file, anything but a number in an attribute of numbers. Follows <include>. MuJoCo reports a file
/// that is no XML. Context: setup; may block.
Result<void> check_model_numbers(const std::string& path);

}  // namespace chimera::library
