// SPDX-License-Identifier: Apache-2.0
// The keyboard and the screen of a text terminal, for display_manager. README.md is the data sheet.
#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>

#include "chimera/task/component.h"
#include "library/serial_frame/serial_port.h"

using namespace chimera;
using namespace chimera::library;

namespace {

constexpr std::size_t kKeys = 16, kBytes = 64;  // of display_manager
constexpr std::string_view kWholePicture = "\f";  // control L

struct Terminal {
  In<Text<kBytes + 4>> output{"output", "1", initial = "", doc = "Bytes for the screen, new in each cycle."};
  Out<Text<kKeys + 4>> keys{"keys", "1", initial = "", doc = "Bytes of the keyboard, at most 16 a cycle."};
  Out<std::int64_t> lost{"lost", "1", initial = std::int64_t{0}, doc = "Bytes that did not fit on the line."};
  InConst<std::int32_t> baud{"baud", "1", initial = 115200, range(9600, 2000000), doc = "Bits a second, 8N1."};
  Resource device{"device", safe_state, doc = "A serial line, or what `tty` prints in a window."};

  void init() { open(); }
  void on() {
    port_.flush();
    waiting_ = 0;
    is_picture_cut_ = true;
    *keys = "";
  }
  Outcome cycle() {
    std::array<std::uint8_t, kKeys> bytes{};
    const int got = port_.read(bytes);
    if (got < 0 || !write()) return fault(gone_.text(), port_.error());
    std::string_view pressed(reinterpret_cast<const char*>(bytes.data()), static_cast<std::size_t>(got));
    if (got == 0 && waiting_ == 0 && std::exchange(is_picture_cut_, false)) pressed = kWholePicture;
    *keys = Text<kKeys + 4>(pressed);
    return ok();
  }
  bool clear() {
    open();
    return true;
  }
  void kill() {
    if (port_.descriptor() >= 0) ::tcsetattr(port_.descriptor(), TCSANOW, &before_);
    port_.close();
  }

 private:
  // The mode of a window is that from before, when the task ends.
  void open() {
    gone_.set(device.text(), "is gone");
    const int file = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file >= 0) {
      if (!has_mode_) has_mode_ = ::tcgetattr(file, &before_) == 0;
      ::close(file);
    }
    port_.open(device.c_str(), *baud);
  }
  // False: the device is gone.
  bool write() {
    const std::size_t n = output.fresh() ? std::min(output->view().size(), out_.size() - waiting_) : 0;
    std::memcpy(out_.data() + waiting_, output->view().data(), n);
    if (output.fresh() && n < output->view().size()) {
      *lost += static_cast<std::int64_t>(output->view().size() - n);
      is_picture_cut_ = true;
    }
    waiting_ += n;
    const int put = waiting_ == 0 ? 0 : port_.write(std::span(out_).first(waiting_));
    if (put < 0) return false;
    waiting_ -= static_cast<std::size_t>(put);
    std::memmove(out_.data(), out_.data() + put, waiting_);
    return true;
  }

  SerialPort port_;
  LostSentence gone_;
  termios before_{};
  bool has_mode_ = false;
  std::array<std::uint8_t, 4 * kBytes> out_{};
  std::size_t waiting_ = 0;      // bytes of out_ that were not written
  bool is_picture_cut_ = false;  // the screen lacks bytes: control L brings them
};

CHIMERA_COMPONENT(Terminal, "terminal", "Keyboard and screen of a text terminal.", rate = 20.0);

}  // namespace
