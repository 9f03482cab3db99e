// SPDX-License-Identifier: Apache-2.0
// Draws a few values as a line of block characters.
#include "chimera/cli/print/sparkline.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace chimera::cli {
namespace {

constexpr const char* kBlocks[] = {"\u2581", "\u2582", "\u2583", "\u2584", "\u2585", "\u2586", "\u2587", "\u2588"};
constexpr const char* kLetters[] = {"_", ".", "-", "=", "+", "*", "#"};

}  // namespace

std::string sparkline(std::span<const double> values, std::size_t width, bool unicode) {
  if (values.size() > width) values = values.last(width);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values)
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  const std::span<const char* const> marks = unicode ? std::span<const char* const>(kBlocks) : kLetters;
  const auto levels = static_cast<double>(marks.size());
  std::string line;
  for (const double value : values) {
    // Halves, so that the range of two large values of opposite sign is finite.
    const double share = high > low ? (value / 2 - low / 2) / (high / 2 - low / 2) : 0.5;
    line += std::isfinite(value) ? marks[static_cast<std::size_t>(std::clamp(share * levels, 0.0, levels - 1))] : " ";
  }
  return line;
}

bool writes_unicode() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string locale(value);
    return locale.find("UTF-8") != std::string::npos || locale.find("utf8") != std::string::npos ||
           locale.find("UTF8") != std::string::npos || locale.find("utf-8") != std::string::npos;
  }
  return false;
}

}  // namespace chimera::cli
