// SPDX-License-Identifier: Apache-2.0
// The ends of an image.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/watch/reset_record.h"

namespace chimera::firmware {

/// Sends what is left, then ends the simulation: 0 is success. On a chip without debugger it sleeps for ever, and
/// strokes the watchdog.
[[noreturn]] void end_image(int code) noexcept;
/// True until the executive runs. An assertion that fails in setup fails again at each boot, so stop() ends the image.
inline constinit bool is_in_setup = true;
/// The image cannot go on: does the safe writes of the target, notes the end in the record, sends "stop WORDS", and
/// resets the chip. `pc` is the address of the instruction; 0: unknown. Context: any.
[[noreturn]] void stop(ResetCause cause, std::uint32_t pc, std::string_view words) noexcept;
/// Stops at an exception of the processor: `number` as in ARMv7-M. Context: exception.
[[noreturn]] void stop_at_exception(std::uint32_t number, std::uint32_t pc) noexcept;

}  // namespace chimera::firmware
