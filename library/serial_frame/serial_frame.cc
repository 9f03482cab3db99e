// SPDX-License-Identifier: Apache-2.0
// Exchanges frames with a device on a serial line. README.md is the data sheet.
#include "library/frame/frame_device.h"
#include "library/serial_frame/serial_port.h"

using namespace chimera;
using namespace chimera::library;

namespace {

struct SerialFrame : FrameDevice {
  InConst<std::int32_t> baud{"baud", "1", initial = 115200, range(9600, 2000000), doc = "Bits a second, 8N1."};
  Out<std::int64_t> noise{"noise", "1", initial = 0, doc = "Bytes outside frames."};
  Resource device{"device", doc = "Serial device, such as /dev/ttyUSB0."};

  void init(Cycle c) {
    prepare(device.text(), 0);
    open(c);
  }
  void on(Cycle c) {
    begin(c);
    port_.flush();
    reader_.reset(payload());
    sent_ = filled_ = 0;
    is_idle_frame_ = false;
    put_safe_frame(c);
  }
  Outcome cycle(Cycle c) {
    if (lost() != nullptr) return fault(lost(), port_.error());
    const bool is_open = receive(c.now());
    const bool is_idle = must_idle(c, is_open);
    if (is_open && !send(is_idle)) is_lost(c, false);
    tell_idled(c, is_open && is_idle_frame_ && sent_ == filled_);
    return ok();
  }
  // Sends the rest of a cut frame first, so that the device understands the idle frame.
  void off() {
    std::memmove(out_.data(), out_.data() + sent_, filled_ - sent_);
    filled_ -= std::exchange(sent_, 0);
    filled_ += close_frame(out_.data() + filled_, put_command(out_.data() + filled_, true));
    if (lost() == nullptr) port_.write(std::span(out_).first(filled_));
    *connected = false;
  }
  bool clear(Cycle c) {
    open(c);
    return true;
  }
  void kill(Cycle c) {
    c.safe_frame(0, -1);
    port_.close();
  }

 private:
  void open(Cycle c) {
    c.safe_frame(0, -1);
    port_.open(device.c_str(), *baud);
    c.safe_frame(0, port_.descriptor());
  }
  // Bytes that begin no frame complete a frame that the death of the process cuts, so that the device understands the
  // idle frame after them.
  void put_safe_frame(Cycle c) {
    std::uint8_t bytes[2 * kLongestFrame] = {};
    std::uint8_t* const frame = bytes + kLongestFrame;
    c.safe_bytes(0, bytes, kLongestFrame + close_frame(frame, put_command(frame, true)));
  }
  bool receive(Nanoseconds now) {
    const int got = port_.read(reader_.room());
    if (got < 0) return false;
    reader_.taken(static_cast<std::size_t>(got));
    const std::int64_t wrong_before = reader_.wrong();
    reader_.frames([this, now](std::span<const std::uint8_t> frame) { (void)take_state(frame, now); });
    refuse(wrong, reader_.wrong() - wrong_before);
    refuse(noise, reader_.noise() - *noise);
    return true;
  }
  bool send(bool is_idle) {
    if (sent_ < filled_) *unsent += 1;
    // Completes a frame that was partly sent. A frame of which nothing was sent is replaced by the new one.
    if (sent_ == 0 || sent_ == filled_) {
      const std::size_t payload = put_command(out_.data(), is_idle);
      if (payload == 0) return true;
      sent_ = 0;
      filled_ = close_frame(out_.data(), payload);
      is_idle_frame_ = is_idle;
    }
    const int put = port_.write(std::span(out_).subspan(sent_, filled_ - sent_));
    if (put > 0) sent_ += static_cast<std::size_t>(put);
    return put >= 0;
  }

  SerialPort port_;
  FrameReader reader_;
  std::array<std::uint8_t, 2 * kLongestFrame> out_{};
  std::size_t sent_ = 0, filled_ = 0;
  bool is_idle_frame_ = false;  // the frame in out_
};

CHIMERA_COMPONENT(SerialFrame, "serial_frame", "Exchanges framed values with a device on a serial line.", rate = 100.0);

}  // namespace
