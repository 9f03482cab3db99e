// SPDX-License-Identifier: Apache-2.0
// The check for our own mistakes: always armed, names the place, ends the program.
// Bad input is answered by Result (base/result.h); a late or broken world by counted state.
#pragma once

namespace chimera {

/// Ends the program after naming the broken condition and its place. Hosted: standard error and abort().
/// Context: any; never returns.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line) noexcept;

}  // namespace chimera

#define CHIMERA_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::chimera::assertion_failed(#condition, __FILE__, __LINE__))
