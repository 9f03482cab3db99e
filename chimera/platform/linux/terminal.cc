// SPDX-License-Identifier: Apache-2.0
// Asks and sets the terminal of this process by termios and ioctl.
#include "chimera/platform/terminal.h"

#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace chimera {
namespace {

std::size_t from_environment(const char* name, std::size_t otherwise) {
  const char* text = std::getenv(name);
  const long value = text == nullptr ? 0 : std::strtol(text, nullptr, 10);
  return value > 0 && value <= 1000 ? static_cast<std::size_t>(value) : otherwise;
}

}  // namespace

struct SingleKeys::Before {
  termios mode{};
};

bool is_terminal(int descriptor) noexcept { return ::isatty(descriptor) == 1; }

ScreenSize screen_size(int descriptor) {
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0)
    return {std::min<std::size_t>(size.ws_col, 1000), std::min<std::size_t>(size.ws_row, 1000)};
  return {from_environment("COLUMNS", 80), from_environment("LINES", 24)};
}

void write_out(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t n = ::write(STDOUT_FILENO, text.data(), text.size());
    if (n <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

bool read_keys(std::string& to) {
  char bytes[64];
  const ssize_t n = ::read(STDIN_FILENO, bytes, sizeof bytes);
  if (n <= 0) return false;
  to.append(bytes, static_cast<std::size_t>(n));
  return true;
}

SingleKeys::SingleKeys() {
  Before found;
  if (::tcgetattr(STDIN_FILENO, &found.mode) != 0) return;
  before_ = std::make_unique<Before>(found);
  termios keys = found.mode;
  keys.c_lflag &= static_cast<tcflag_t>(~(ICANON | ECHO));
  keys.c_cc[VMIN] = 1;
  keys.c_cc[VTIME] = 0;
  keys.c_cc[VSUSP] = _POSIX_VDISABLE;  // stopped, the terminal would be left as it is now
  ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
}

SingleKeys::~SingleKeys() {
  if (before_ != nullptr) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_->mode);
}

}  // namespace chimera
