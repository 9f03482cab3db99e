// SPDX-License-Identifier: Apache-2.0
// CHIMERA_ASSERT checks for mistakes of the framework. It is always armed, names the place and ends the program.
// A Result (base/result.h) answers bad input. Counters record late jobs and broken devices.
#pragma once

#include "chimera/base/mechanisms.h"

namespace chimera {

/// Ends the program after naming the broken condition (images: "") and its place. Hosted: standard error and abort().
/// Context: any; never returns.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line) noexcept;

}  // namespace chimera

#define CHIMERA_ASSERT(condition)                                                            \
  ((condition) ? static_cast<void>(0)                                                        \
               : ::chimera::assertion_failed(::chimera::mechanisms::kVerified ? "" : #condition, __FILE__, __LINE__))
