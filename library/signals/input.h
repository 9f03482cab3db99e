// SPDX-License-Identifier: Apache-2.0
// Checks of the inputs of signal components.
#pragma once

#include <cstddef>

#include "chimera/base/math.h"
#include "chimera/base/message.h"
#include "chimera/task/component.h"

namespace chimera::library {

/// Greatest number of elements of a signal. Every signal component declares [n...<=64], any shape, and sees a list of
/// its elements.
inline constexpr std::size_t kMostElements = 64;

/// The end of a range without an end.
inline constexpr double kNoLimit = __builtin_inf();

/// Returns true if every element is finite. Context: cycle; wait-free.
template <class P>
bool all_finite(const P& port) noexcept {
  for (const double value : port)
    if (!math::is_finite(value)) return false;
  return true;
}

/// A fault that names element `i` of `size`. Apart from the loops that cycles run.
[[gnu::cold, gnu::noinline]] inline Outcome not_finite(const char* name, std::size_t i, std::size_t size) noexcept {
  Message text(name);
  if (size != 1) text << "[" << i << "]";
  return fault((text << " is not a finite number").view());
}

/// Returns ok() if every element is finite, aborted() if the input was never written, otherwise a fault that names the
/// first element that is NaN or infinite. Unless ok() is returned, nothing is published, so the caller must not have
/// changed its state. Context: cycle; wait-free.
template <class P>
Outcome judge(const P& port, const char* name) noexcept {
  for (std::size_t i = 0; i < port.size(); ++i) {
    if (math::is_finite(port.begin()[i])) continue;
    return port.valid() ? not_finite(name, i, port.size()) : aborted();
  }
  return ok();
}

/// The outcome of a cycle with an input that it cannot use: aborted() if one of `ports` was never written, otherwise a
/// fault. Unless ok() is returned, nothing is published. Context: cycle; wait-free.
template <class... P>
Outcome unfit(const char* text, const P&... ports) noexcept {
  return (ports.valid() && ...) ? fault(text) : aborted();
}

/// The outcome of `on` from that of a first cycle. awaited(): an input that was never written may come later.
/// required(): that is a fault with `text`, because the outputs have no initial value. Context: cycle boundary;
/// wait-free.
inline Outcome awaited(const Outcome& first) noexcept {
  return first.status() == CHIMERA_ABORTED ? ok() : first;
}
inline Outcome required(const Outcome& first, const char* text) noexcept {
  return first.status() == CHIMERA_ABORTED ? fault(text) : first;
}

inline bool is_ok(const Outcome& outcome) noexcept { return outcome.status() == CHIMERA_OK; }

}  // namespace chimera::library
