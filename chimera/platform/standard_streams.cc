// SPDX-License-Identifier: Apache-2.0
// Opens closed standard descriptors, remembers the first failed write, and asks and sets the terminal by termios.
#include "chimera/platform/standard_streams.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

namespace chimera {
namespace {

constexpr std::array kReasons = {ENOSPC, EPIPE, EBADF, EFBIG, EDQUOT, EIO, EINVAL, EAGAIN};
constexpr int kNotKnown = 1000;  // text was lost before the first flush_and_look()

struct Loss {
  int out = 0, err = 0;
  bool is_told = false;
} loss;

int* remembered(const std::FILE* stream) noexcept {
  return stream == stdout ? &loss.out : stream == stderr ? &loss.err : nullptr;
}

std::size_t from_environment(const char* name, std::size_t otherwise) {
  const char* text = std::getenv(name);
  const long value = text == nullptr ? 0 : std::strtol(text, nullptr, 10);
  return value > 0 && value <= 1000 ? static_cast<std::size_t>(value) : otherwise;
}

}  // namespace

void hold_standard_streams() noexcept {
  // Opened for the other direction, so that use fails as on a closed descriptor. 0 first: open() returns the lowest
  // free number.
  for (const int number : {0, 1, 2})
    if (::fcntl(number, F_GETFD) < 0) (void)::open("/dev/null", number == 0 ? O_WRONLY : O_RDONLY);
  std::signal(SIGXFSZ, SIG_IGN);
}

const char* why_lost_text(int why) noexcept {
  if (why == kNobodyReads) return "no process reads it";
  const char* text = ::strerrordesc_np(why);
  return text == nullptr ? "the reason is not known" : text;
}

int flush_and_look(std::FILE* stream) noexcept {
  const int before = errno;  // set if text printed just before did not fit into the buffer
  int* known = remembered(stream);
  errno = 0;
  const bool flushed = std::fflush(stream) == 0;
  int why = flushed ? 0 : errno;
  if (flushed && std::ferror(stream) != 0) {
    const bool is_reason = std::find(kReasons.begin(), kReasons.end(), before) != kReasons.end();
    why = is_reason ? before : kNotKnown;
  }
  if (known == nullptr) return why;
  if (*known == 0) *known = why;
  return *known;
}

void loss_is_told() noexcept { loss.is_told = true; }

int report_lost_output(int code) noexcept {
  if (const int why = flush_and_look(stdout); why != 0) {
    if (!loss.is_told) std::fprintf(stderr, "chimera: standard output is lost (%s)\n", why_lost_text(why));
    code = std::max(code, 1);
  }
  return flush_and_look(stderr) == 0 ? code : std::max(code, 1);
}

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
  keys.c_cc[VSUSP] = _POSIX_VDISABLE;  // a stop by Ctrl-Z would leave the terminal like this
  ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
}

SingleKeys::~SingleKeys() {
  if (before_ != nullptr) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_->mode);
}

}  // namespace chimera
