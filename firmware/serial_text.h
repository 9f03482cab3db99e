// SPDX-License-Identifier: Apache-2.0
// Lines of text on the serial port of the image.
#pragma once

#include <cstdint>

#include "chimera/base/mechanisms.h"
#include "chimera/base/message.h"
#include "firmware/boards/board.h"

namespace chimera::firmware {

/// Adds the last `digits` digits of `bits` in base 16. Context: any; wait-free.
inline Message& add_hex(Message& text, std::uint64_t bits, int digits) noexcept {
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4)
    text << std::string_view(&"0123456789abcdef"[(bits >> shift) & 15], 1);
  return text;
}

/// Sends the text as one line, or counts it as lost: BareUart::send. Context: cycle; wait-free.
inline void send_line(Message& text) noexcept {
  if constexpr (mechanisms::kSerial) uart().send((text << "\n").view());
}
inline void send_line(Message&& text) noexcept { send_line(text); }

}  // namespace chimera::firmware
