// SPDX-License-Identifier: Apache-2.0
// The ends of an image.
#pragma once

#include <cstdint>
#include <string_view>

namespace chimera::firmware {

/// Sends what is left, then ends the simulation: 0 is success. On a chip without debugger it sleeps for ever.
[[noreturn]] void end_image(int code) noexcept;
/// Sends "stop WORDS" and ends with code 1. Context: any.
[[noreturn]] void stop(std::string_view words) noexcept;
/// Stops at an exception of the processor: `number` as in ARMv7-M, program address `pc`. Context: exception.
[[noreturn]] void stop_at_exception(std::uint32_t number, std::uint32_t pc) noexcept;

}  // namespace chimera::firmware
