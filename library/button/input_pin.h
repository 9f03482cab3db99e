// SPDX-License-Identifier: Apache-2.0
// One digital input. Each platform implements the functions in a source of its own: pin_file.cc for Linux,
// firmware/pins.cc for an image.
#pragma once

#include <cstdint>
#include <string_view>

#include "chimera/base/fixed.h"

namespace chimera::library {

/// Owns what open() has opened. Not copyable.
class InputPin {
 public:
  enum class Level : std::uint8_t { kLow, kHigh, kUnreadable };
  using Refusal = FixedString<150>;

  InputPin() noexcept = default;
  InputPin(const InputPin&) = delete;
  InputPin& operator=(const InputPin&) = delete;
  ~InputPin() { close(); }

  /// Opens the pin of that name; "" or the reason why it cannot be read. Context: setup; may block.
  Refusal open(std::string_view name) noexcept;
  /// Context: cycle; at most one system call.
  Level read() const noexcept;
  /// Context: setup.
  void close() noexcept;

 private:
  int handle_ = -1;  // below 0: not open
};

}  // namespace chimera::library
