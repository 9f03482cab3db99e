// SPDX-License-Identifier: Apache-2.0
// The keyboard and the screen of a text terminal, for display_manager. README.md is the data sheet.
#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>

#include "chimera/task/component.h"
#include "library/terminal/terminal_line.h"

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
  Resource device{"device", safe_state, 
                  doc = "A serial line, or what `tty` prints in a window; on a target `uart`."};

  Outcome init() { return open(); }
  void on() {
    line_.flush();
    waiting_ = 0;
    is_picture_cut_ = true;
    *keys = "";
  }
  Outcome cycle() {
    std::array<std::uint8_t, kKeys> bytes{};
    const int got = line_.read(bytes);
    if (got < 0 || !write()) return fault(line_.loss(), line_.error());
    std::string_view pressed(reinterpret_cast<const char*>(bytes.data()), static_cast<std::size_t>(got));
    if (got == 0 && waiting_ == 0 && std::exchange(is_picture_cut_, false)) pressed = kWholePicture;
    *keys = Text<kKeys + 4>(pressed);
    return ok();
  }
  Outcome clear() { return open(); }
  void kill() { line_.close(); }

 private:
  Outcome open() {
    const TerminalLine::Refusal refusal = line_.open(device.text(), *baud);
    return refusal.empty() ? ok() : fault(refusal.view());
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
    const int put = waiting_ == 0 ? 0 : line_.write(std::span(out_).first(waiting_));
    if (put < 0) return false;
    waiting_ -= static_cast<std::size_t>(put);
    std::memmove(out_.data(), out_.data() + put, waiting_);
    return true;
  }

  TerminalLine line_;
  std::array<std::uint8_t, 4 * kBytes> out_{};
  std::size_t waiting_ = 0;      // bytes of out_ that were not written
  bool is_picture_cut_ = false;  // the screen lacks bytes: control L brings them
};

CHIMERA_COMPONENT(Terminal, "terminal", "Keyboard and screen of a text terminal.", rate = 20.0);

}  // namespace
