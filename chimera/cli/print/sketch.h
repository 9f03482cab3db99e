// SPDX-License-Identifier: Apache-2.0
// A plot as a few lines for a terminal.
#pragma once

#include <cstddef>
#include <string>

#include "chimera/draw/plot.h"

namespace chimera::cli {

/// A line for each curve: its name, its course as a sparkline over the time of all curves, its least and greatest
/// value with the unit. A value that is held stands until the next. Context: setup.
std::string sketch(const draw::Plot& plot, std::size_t width, bool unicode);

}  // namespace chimera::cli
