// SPDX-License-Identifier: Apache-2.0
// The line to a keyboard and a screen. Each platform implements the functions in a source of its own: terminal_tty.cc
// for Linux, firmware/terminal_on_uart.cc for an image.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/base/fixed.h"

namespace chimera::library {

/// Owns what open() has opened. Not copyable.
class TerminalLine {
 public:
  using Refusal = FixedString<220>;

  TerminalLine() noexcept = default;
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;
  ~TerminalLine() { close(); }

  /// Opens the line of that name, also again after a loss; "" or the reason why it cannot be used. Context: setup; may
  /// block.
  Refusal open(std::string_view name, std::int32_t baud) noexcept;
  /// Drops bytes of the keyboard. Requires: open. Context: cycle boundary; wait-free.
  void flush() noexcept;
  /// Returns the number of bytes read into `to`; -1: the line is gone. Requires: open() was called. Context: cycle; at
  /// most one system call that does not wait.
  int read(std::span<std::uint8_t> to) noexcept;
  /// Returns the number of bytes taken from `from`; -1: the line is gone. Requires and context: as read().
  int write(std::span<const std::uint8_t> from) noexcept;
  /// Fault text and error number of a line that is gone; 0: it hung up. Context: any; wait-free.
  const char* loss() const noexcept;
  int error() const noexcept;
  /// Gives the line its old mode back. Context: setup.
  void close() noexcept;

 private:
  struct Device;
  Device* device_ = nullptr;  // null: not open
};

}  // namespace chimera::library
