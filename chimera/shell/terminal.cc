// SPDX-License-Identifier: Apache-2.0
// Switches the terminal to single keys and the alternate screen, and waits for keys, signals and notifications.
#include "chimera/shell/terminal.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "chimera/platform/linux_clock.h"

namespace chimera::shell {
namespace {

void write_all(std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(STDOUT_FILENO, text.data(), text.size());
    if (n <= 0) return;  // nobody looks any more
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

std::size_t from_environment(const char* name, std::size_t otherwise) {
  const char* text = std::getenv(name);
  const long value = text == nullptr ? 0 : std::strtol(text, nullptr, 10);
  return value > 0 && value <= 1000 ? static_cast<std::size_t>(value) : otherwise;
}

}  // namespace

bool is_terminal(int descriptor) { return ::isatty(descriptor) == 1; }

ScreenSize screen_size(int descriptor) {
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0)
    return {std::min<std::size_t>(size.ws_col, 1000), std::min<std::size_t>(size.ws_row, 1000)};
  return {from_environment("COLUMNS", 80), from_environment("LINES", 24)};
}

FullScreen::FullScreen() {
  has_before_ = ::tcgetattr(STDIN_FILENO, &before_) == 0;
  if (has_before_) {
    termios keys = before_;
    keys.c_lflag &= static_cast<tcflag_t>(~(ICANON | ECHO));
    keys.c_cc[VMIN] = 1;
    keys.c_cc[VTIME] = 0;
    keys.c_cc[VSUSP] = _POSIX_VDISABLE;  // stopped, the terminal would be left as it is now
    ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  }
  write_all("\x1b[?1049h\x1b[?25l\x1b[2J");
}

FullScreen::~FullScreen() {
  write_all("\x1b[0m\x1b[?25h\x1b[?1049l");
  if (has_before_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void FullScreen::show(const std::string& text) { write_all("\x1b[H" + text + "\x1b[0m\x1b[J"); }

Attention::Attention(bool keys) : keys_(keys) {
  sigset_t taken;
  ::sigemptyset(&taken);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGWINCH}) ::sigaddset(&taken, signal);
  ::pthread_sigmask(SIG_BLOCK, &taken, &before_);
  signals_ = OwnedDescriptor(::signalfd(-1, &taken, SFD_NONBLOCK | SFD_CLOEXEC));
}

Attention::~Attention() {
  // What has come but was not read would act as soon as it may: it has been obeyed by ending.
  while (take_signal()) {}
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

std::optional<Woken> Attention::take_signal() {
  signalfd_siginfo signal{};
  if (::read(signals_.fd, &signal, sizeof signal) != static_cast<ssize_t>(sizeof signal)) return std::nullopt;
  Woken woken;
  woken.by = signal.ssi_signo == SIGWINCH ? Woken::By::kResize : Woken::By::kStop;
  return woken;
}

void Attention::read_keys() {
  char bytes[64];
  const ssize_t n = ::read(STDIN_FILENO, bytes, sizeof bytes);
  if (n > 0) typed_.append(bytes, static_cast<std::size_t>(n));
  else keys_ = false;
}

Woken Attention::take_key() {
  constexpr std::pair<std::string_view, int> kArrows[] = {{"\x1b[A", kKeyUp},      {"\x1bOA", kKeyUp},
                                                          {"\x1b[B", kKeyDown},    {"\x1bOB", kKeyDown},
                                                          {"\x1b[5~", kKeyPageUp}, {"\x1b[6~", kKeyPageDown}};
  Woken woken;
  woken.by = Woken::By::kKey;
  woken.key = typed_.empty() ? kKeyEnd : static_cast<unsigned char>(typed_[0]);
  std::size_t length = std::min<std::size_t>(typed_.size(), 1);
  for (const auto& [sequence, key] : kArrows)
    if (typed_.starts_with(sequence)) woken.key = key, length = sequence.size();
  typed_.erase(0, length);
  return woken;
}

Woken Attention::wait(control::Client* client, Nanoseconds limit) {
  LinuxClock clock;
  const Nanoseconds until = clock.now() + limit;
  for (;;) {
    if (auto woken = take_signal()) return std::move(*woken);
    if (!typed_.empty()) return take_key();
    Woken woken;
    if (client != nullptr) {
      auto note = client->next(Nanoseconds{0});
      if (!note) return woken.by = Woken::By::kLost, woken.error = note.error(), woken;
      if (note.value()) return woken.by = Woken::By::kNote, woken.note = std::move(*note.value()), woken;
    }
    pollfd all[] = {{signals_.fd, POLLIN, 0}, {client == nullptr ? -1 : client->descriptor(), POLLIN, 0},
                    {keys_ ? STDIN_FILENO : -1, POLLIN, 0}};
    const std::int64_t left_ms = ((until - clock.now()).count + 999'999) / 1'000'000;
    const int n = ::poll(all, 3, static_cast<int>(std::clamp<std::int64_t>(left_ms, 0, 60'000)));
    if (n > 0 && all[2].revents != 0) {
      read_keys();
      return take_key();
    }
    if (n == 0 && clock.now() >= until) return woken;
  }
}

}  // namespace chimera::shell
