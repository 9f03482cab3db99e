// SPDX-License-Identifier: Apache-2.0
// Judges each byte of a line.
#include "firmware/shell/line_reader.h"

namespace chimera::firmware {

bool LineReader::add(std::uint8_t byte) noexcept {
  if (byte == '\r' || byte == '\n') return length_ > 0;
  if (length_ < kMost) bytes_[length_] = static_cast<char>(byte);
  ++length_;
  if (byte == kLostMark) {
    fault_ = Fault::kLost;
  } else if ((byte < 0x20 && byte != '\t') || byte > 0x7e) {
    if (fault_ == Fault::kNone || fault_ == Fault::kTooLong) fault_ = Fault::kBadByte, bad_byte_ = byte;
  } else if (length_ > kMost && fault_ == Fault::kNone) {
    fault_ = Fault::kTooLong;
  }
  return false;
}

}  // namespace chimera::firmware
