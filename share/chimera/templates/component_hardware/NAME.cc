// SPDX-License-Identifier: Apache-2.0
// @NAME@: a driver of a device on a serial line, in lines of text. "S 1.500" goes out, "P 0.250" comes in. Change it
// into what your device speaks.
#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include "chimera/task/component.h"

using namespace chimera;

struct @TYPE@Component {
  In<double>      speed{"speed", "m/s", doc = "what the device is told"};
  Out<double>     position{"position", "m", initial = 0.0, doc = "what it said last"};
  Out<bool>       connected{"connected", initial = false, doc = "it said something within the timeout"};
  Out<bool>       idled{"idled", initial = false, safe_state, doc = "the flag is up and it was told to stop since"};
  InConst<double> limit{"limit", "m/s", initial = 1.0, range(0, 100), doc = "speeds are held within +- limit"};
  InConst<double> timeout{"timeout", "s", initial = 0.1, range(0.001, 60), doc = "silence after which it is lost"};
  Resource        device{"device", doc = "serial device, such as /dev/ttyUSB0"};

  // Opens the device, so that a wrong one is known before anything moves. May wait.
  void init() {
    kill();
    file_ = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file_ < 0) throw std::runtime_error(device.c_str() + std::string(": ") + std::strerror(errno) + remedy());
    termios mode{};
    if (::tcgetattr(file_, &mode) != 0) throw std::runtime_error(device.c_str() + std::string(": no serial device"));
    ::cfmakeraw(&mode);
    ::cfsetspeed(&mode, B115200);
    mode.c_cflag |= CLOCAL | CREAD;
    mode.c_cc[VMIN] = 1;  // so that a read without bytes says so, and 0 is the end
    ::tcsetattr(file_, TCSANOW, &mode);
  }
  void on(Cycle c) {
    ::tcflush(file_, TCIFLUSH);  // what came while nobody listened
    held_ = 0;
    heard_ = c.now();
    is_lost_ = false;
    *connected = *idled = false;
  }
  // Two system calls, none of which waits. A device that is lost is told in `connected` first, then as a fault.
  Outcome cycle(Cycle c) {
    if (is_lost_) return fault("the device is gone or silent: bring it back, then `clear` and `on`", errno_);
    const bool is_there = receive(c.now());
    is_lost_ = !is_there || c.now() - heard_ > Nanoseconds{static_cast<std::int64_t>(*timeout * 1e9)};
    if (is_lost_) *connected = false;
    const bool is_told = is_there && send(is_lost_ || c.illegal() ? 0 : *speed);
    *idled = c.illegal() && (*idled || is_told);
    return ok();
  }
  void off() {
    send(0);
    *connected = false;
  }
  bool clear() {
    init();
    return true;
  }
  void kill() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  ~@TYPE@Component() { kill(); }

 private:
  static const char* remedy() {
    return errno == EACCES ? ": add the user to the device's group (dialout) and log in again"
                           : ": plug the device in, or name another under `resources`";
  }
  // NaN never reaches a device; what is too fast is held at the limit.
  bool send(double value) {
    if (std::isnan(value)) return false;
    char line[40];
    const int size = std::snprintf(line, sizeof line, "S %.3f\n", std::fmin(std::fmax(value, -*limit), *limit));
    const ssize_t put = ::write(file_, line, static_cast<std::size_t>(size));
    if (put < 0 && errno != EAGAIN) errno_ = errno;
    return put == size;
  }
  // False: the device is gone. A line that is cut is kept for the next cycle, one that is wrong is passed over.
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
    if (held_ == sizeof text_ - 1) held_ = 0;  // no device of ours says such a line
    return true;
  }
  void take(const char* line, Nanoseconds now) {
    if (line[0] != 'P' || line[1] != ' ') return;
    char* end = nullptr;
    const double value = std::strtod(line + 2, &end);
    if (end == line + 2 || *end != '\0' || !std::isfinite(value)) return;
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
