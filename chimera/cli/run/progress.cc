// SPDX-License-Identifier: Apache-2.0
// Writes how far a run is and how long it will take.
#include "chimera/cli/run/progress.h"

#include <cstdio>

namespace chimera::cli {

std::string progress_text(Nanoseconds done, Nanoseconds all, Nanoseconds wall) {
  const double part = all.count > 0 ? to_seconds(done) / to_seconds(all) : 0;
  char text[160];
  const int n = std::snprintf(text, sizeof text, "%.1f of %.1f s of virtual time (%.0f %%)", to_seconds(done),
                              to_seconds(all), 100 * part);
  std::string line(text, static_cast<std::size_t>(n));
  if (part <= 0 || part >= 1) return line;
  std::snprintf(text, sizeof text, ", about %.0f s to go", to_seconds(wall) * (1 - part) / part);
  return line + text;
}

}  // namespace chimera::cli
