// SPDX-License-Identifier: Apache-2.0
// Writes times, rates and counts with three digits and a unit.
#include "chimera/cli/print/figures.h"

#include <cmath>
#include <iterator>

#include "chimera/base/hosted/wording.h"

namespace chimera::cli {
namespace {

/// Three significant digits: "1.20", "12.3", "123".
std::string three_digits(double value) {
  const double size = std::fabs(value);
  return formatted(size < 9.995 ? "%.2f" : size < 99.95 ? "%.1f" : "%.0f", value);
}

}  // namespace

std::string duration_text(std::optional<std::int64_t> ns) {
  if (!ns) return "-";
  const auto value = static_cast<double>(*ns);
  const double size = std::fabs(value);
  if (size < 1e3) return std::to_string(*ns) + " ns";
  struct Step {
    double below, unit;
    const char* name;
  };
  constexpr Step kSteps[] = {
      {999.5e3, 1e3, " us"}, {999.5e6, 1e6, " ms"}, {599.5e9, 1e9, " s"}, {599.5 * 60e9, 60e9, " min"}};
  for (const Step& step : kSteps)
    if (size < step.below) return three_digits(value / step.unit) + step.name;
  return three_digits(value / 3600e9) + " h";
}

std::string rate_text(double hz) {
  if (!(hz > 0)) return "-";
  if (hz < 999.5) return formatted("%.3g Hz", hz);
  return hz < 999.5e3 ? formatted("%.3g kHz", hz * 1e-3) : formatted("%.3g MHz", hz * 1e-6);
}

std::string count_text(std::int64_t count) {
  if (count < 100'000) return std::to_string(count);
  constexpr const char* kUnits[] = {"k", "M", "G", "T", "P", "E"};
  auto value = static_cast<double>(count);
  std::size_t unit = 0;
  for (value /= 1e3; value >= 999.5 && unit + 1 < std::size(kUnits); ++unit) value /= 1e3;
  return three_digits(value) + kUnits[unit];
}

}  // namespace chimera::cli
