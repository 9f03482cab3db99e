// SPDX-License-Identifier: Apache-2.0
// The line of a terminal on Linux: a serial device, or a window.
#include <exception>
#include <new>
#include <string>

#include "library/serial_frame/serial_port.h"
#include "library/terminal/terminal_line.h"

namespace chimera::library {

struct TerminalLine::Device {
  SerialPort port;
  LostSentence gone;
  termios before{};  // the mode of a window that it had before the first open()
  bool has_mode = false;
};

TerminalLine::Refusal TerminalLine::open(std::string_view name, std::int32_t baud) noexcept {
  if (device_ == nullptr) device_ = new Device;
  device_->gone.set(name, "is gone");
  const std::string path(name);
  const int file = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (file >= 0) {
    if (!device_->has_mode) device_->has_mode = ::tcgetattr(file, &device_->before) == 0;
    ::close(file);
  }
  try {
    device_->port.open(path, baud);
  } catch (const std::exception& refusal) {
    return std::string_view(refusal.what());
  }
  return {};
}

void TerminalLine::flush() noexcept { device_->port.flush(); }
int TerminalLine::read(std::span<std::uint8_t> to) noexcept { return device_->port.read(to); }
int TerminalLine::write(std::span<const std::uint8_t> from) noexcept { return device_->port.write(from); }
const char* TerminalLine::loss() const noexcept { return device_->gone.text(); }
int TerminalLine::error() const noexcept { return device_->port.error(); }

void TerminalLine::close() noexcept {
  if (device_ == nullptr) return;
  const int file = device_->port.descriptor();
  if (file >= 0 && device_->has_mode) ::tcsetattr(file, TCSANOW, &device_->before);
  delete device_;
  device_ = nullptr;
}

}  // namespace chimera::library
