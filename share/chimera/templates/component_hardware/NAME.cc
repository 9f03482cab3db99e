// SPDX-License-Identifier: Apache-2.0
// @NAME@: drives a device on a serial line by lines of text. It sends "S 1.500" and receives "P 0.250". Replace these
// lines by those of your device. A device that has not answered since `on` is only told to stand still.
#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@Component {
  In<double>      speed{"speed", "m/s", doc = "speed to send"};
  Out<double>     position{"position", "m", initial = 0.0, doc = "last position of the device"};
  Out<bool>       connected{"connected", initial = false, doc = "the device sent a line within the timeout"};
  Out<bool>       idled{"idled", initial = false, safe_state, doc = "the flag is up and the device was stopped since"};
  InConst<double> limit{"limit", "m/s", initial = 1.0, range(0, 100), doc = "speeds are cut at +- limit"};
  InConst<double> timeout{"timeout", "s", initial = 0.1, range(0.001, 60), doc = "silence that counts as a loss"};
  Resource        device{"device", doc = "serial device, such as /dev/ttyUSB0"};

  // Opens the device, so that a wrong path is refused before any motion. May wait.
  void init(Cycle c) {
    close(c);
    file_ = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file_ < 0) throw std::runtime_error(device.c_str() + std::string(": ") + std::strerror(errno) + remedy());
    termios mode{};
    if (::tcgetattr(file_, &mode) != 0) throw std::runtime_error(device.c_str() + std::string(": no serial device"));
    ::cfmakeraw(&mode);
    ::cfsetspeed(&mode, B115200);
    mode.c_cflag |= CLOCAL | CREAD;
    mode.c_cc[VMIN] = 1;  // a read without bytes then fails with EAGAIN, and 0 means the end
    ::tcsetattr(file_, TCSANOW, &mode);
    c.safe_frame(0, file_);
  }
  void on(Cycle c) {
    ::tcflush(file_, TCIFLUSH);  // drops bytes from before `on`
    held_ = 0;
    heard_ = c.now();
    is_lost_ = false;
    *connected = *idled = false;
    // The guard sends this if the process dies. The first end of line closes a line that the death cut.
    c.safe_bytes(0, "\nS 0.000\n", 9);
  }
  // Makes two system calls, and none waits. After a loss `connected` falls in this cycle; the next one is a fault.
  Outcome cycle(Cycle c) {
    if (is_lost_) return fault("the device is gone or silent: bring it back, then `clear` and `on`", errno_);
    const bool is_there = receive(c.now());
    is_lost_ = !is_there || c.now() - heard_ > Nanoseconds{static_cast<std::int64_t>(*timeout * 1e9)};
    if (is_lost_) *connected = false;
    const bool is_told = is_there && send(!*connected || c.illegal() ? 0 : *speed);
    *idled = c.illegal() && (*idled || is_told);
    return ok();
  }
  void off() {
    send(0);
    *connected = false;
  }
  bool clear(Cycle c) {
    init(c);
    return true;
  }
  void kill(Cycle c) { close(c); }
  ~@TYPE@Component() {
    if (file_ >= 0) ::close(file_);
  }

 private:
  void close(Cycle c) {
    c.safe_frame(0, -1);
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  static const char* remedy() {
    return errno == EACCES ? ": add the user to the device's group (dialout) and log in again"
                           : ": plug the device in, or name another under `resources`";
  }
  // Sends no NaN, and cuts the speed at the limit. to_chars and from_chars use a decimal point in every locale.
  bool send(double value) {
    if (std::isnan(value)) return false;
    char line[40] = "S ";
    const double held = std::fmin(std::fmax(value, -*limit), *limit);
    char* end = std::to_chars(line + 2, line + sizeof line - 1, held, std::chars_format::fixed, 3).ptr;
    *end++ = '\n';
    const ssize_t put = ::write(file_, line, static_cast<std::size_t>(end - line));
    if (put < 0 && errno != EAGAIN) errno_ = errno;
    return put == end - line;
  }
  // Returns false if the device is gone. A cut line waits for the next cycle; a wrong line is skipped.
  bool receive(Nanoseconds now) {
    const ssize_t got = ::read(file_, text_ + held_, sizeof text_ - 1 - held_);
    if (got <= 0) {
      errno_ = got < 0 ? errno : 0;
      return got < 0 && (errno == EAGAIN || errno == EINTR);
    }
    held_ += static_cast<std::size_t>(got);
    std::size_t begin = 0;
    for (std::size_t i = 0; i < held_; ++i) {
      if (text_[i] != '\n') continue;
      text_[i] = '\0';
      take(text_ + begin, now);
      begin = i + 1;
    }
    held_ -= begin;
    std::memmove(text_, text_ + begin, held_);
    if (held_ == sizeof text_ - 1) held_ = 0;  // the device sends no line of this length
    return true;
  }
  void take(const char* line, Nanoseconds now) {
    if (line[0] != 'P' || line[1] != ' ') return;
    double value = 0;
    const auto [end, error] = std::from_chars(line + 2, line + std::strlen(line), value);
    if (error != std::errc() || *end != '\0' || !std::isfinite(value)) return;
    *position = value;
    *connected = true;
    heard_ = now;
  }

  int file_ = -1;
  int errno_ = 0;
  char text_[256];
  std::size_t held_ = 0;
  Nanoseconds heard_;
  bool is_lost_ = false;
};
CHIMERA_COMPONENT(@TYPE@Component, "@NAME@", "Drives a device on a serial line.", rate = 100.0);
