// SPDX-License-Identifier: Apache-2.0
// The last values of a signal as one short line of blocks.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace chimera::cli {

/// The last `width` of `values`, the least as the lowest block and the greatest as the highest; a value that is not
/// finite is a blank, a constant the middle block. `unicode` false: the letters _.-=+*# instead. Context: setup.
std::string sparkline(std::span<const double> values, std::size_t width, bool unicode);

/// Whether the locale of the environment (LC_ALL, LC_CTYPE, LANG in this order) writes UTF-8.
bool writes_unicode();

}  // namespace chimera::cli
