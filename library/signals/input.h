// SPDX-License-Identifier: Apache-2.0
// What every signal component does about its input before it uses it.
#pragma once

#include <cstddef>
#include <cstdio>

#include "chimera/base/math.h"
#include "chimera/task/component.h"

namespace chimera::library {

/// Elements of a signal at most: every signal component declares [n...<=64], any shape, and
/// sees a list of its elements.
inline constexpr std::size_t kMostElements = 64;

/// The upper end of a range that has none.
inline constexpr double kNoLimit = __builtin_inf();

/// Whether every element is finite. Context: cycle; wait-free.
template <class P>
bool all_finite(const P& port) noexcept {
  for (const double value : port)
    if (!math::is_finite(value)) return false;
  return true;
}

/// ok(): every element may be used. aborted(): nobody has written the input yet, so nothing is to be published.
/// A fault that names the first element that is NaN or infinite: nothing is published either, so a state that the
/// caller has not touched yet stays as clean as the output that stands. Context: cycle; wait-free.
template <class P>
Outcome judge(const P& port, const char* name) noexcept {
  for (std::size_t i = 0; i < port.size(); ++i) {
    if (math::is_finite(port.begin()[i])) continue;
    if (!port.valid()) return aborted();
    char text[80];
    std::snprintf(text, sizeof text, port.size() == 1 ? "%s is not a finite number" : "%s[%zu] is not a finite number",
                  name, i);
    return fault(text);
  }
  return ok();
}

inline bool is_ok(const Outcome& outcome) noexcept { return outcome.status() == CHIMERA_OK; }

}  // namespace chimera::library
