// SPDX-License-Identifier: Apache-2.0
// A time as people read it.
#include "chimera/text/time_text.h"

#include "chimera/base/hosted/wording.h"

namespace chimera {

std::string time_text(Nanoseconds time) {
  constexpr struct {
    double ns;
    const char* name;
  } kUnits[] = {{1e9, "s"}, {1e6, "ms"}, {1e3, "us"}};
  for (const auto& unit : kUnits) {
    if (static_cast<double>(time.count) < unit.ns) continue;
    return formatted("%.4g ", static_cast<double>(time.count) / unit.ns) + unit.name;
  }
  return std::to_string(time.count) + " ns";
}

}  // namespace chimera
