// SPDX-License-Identifier: Apache-2.0
// Pins of Linux: files that begin with 0 or 1, such as /sys/class/gpio/gpio17/value.
#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "chimera/base/hosted/ordinary_file.h"
#include "library/button/input_pin.h"

namespace chimera::library {

InputPin::Refusal InputPin::open(std::string_view name) noexcept {
  close();
  const auto file = open_ordinary(std::string(name), 4096);  // sysfs gives each of its files this size
  if (!file) return (Message(file.error().where.view()) << " " << file.error().message.view()).view();
  handle_ = *file;
  if (read() != Level::kUnreadable) return {};
  close();
  return (Message(name) << " does not begin with 0 or 1").view();
}

InputPin::Level InputPin::read() const noexcept {
  char first = 0;
  ssize_t got = 0;
  do got = ::pread(handle_, &first, 1, 0);
  while (got < 0 && errno == EINTR);
  if (got != 1 || (first != '0' && first != '1')) return Level::kUnreadable;
  return first == '1' ? Level::kHigh : Level::kLow;
}

void InputPin::close() noexcept {
  if (handle_ >= 0) ::close(std::exchange(handle_, -1));
}

}  // namespace chimera::library
