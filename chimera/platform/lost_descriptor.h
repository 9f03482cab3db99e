// SPDX-License-Identifier: Apache-2.0
// The end of a process whose descriptors were closed behind its back, by a component that closes what is not its own:
// whoever waits on one would be woken at once for ever, and hear nothing.
#pragma once

namespace chimera {

inline constexpr int kDescriptorLost = 4;  ///< exit status

/// Says so on stderr and ends the process. Context: any; never returns.
[[noreturn]] void end_without_descriptor() noexcept;

}  // namespace chimera
