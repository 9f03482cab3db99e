// SPDX-License-Identifier: Apache-2.0
// Exchanges frames with a device on the network in numbered datagrams. README.md is the data sheet.
#include "library/frame/frame_device.h"
#include "library/udp_frame/udp_socket.h"

using namespace chimera;
using namespace chimera::library;

namespace {

constexpr int kMostDatagrams = 8;   // received in a cycle
constexpr int kMostForgotten = 64;  // dropped in a cycle, of those from before `on`
constexpr int kMostOld = 1000;      // from before `on`: more than a queue holds
// The number of the safe frame is kAhead after the last one sent, and moves on after kAnewAfter datagrams. A device
// that drops old numbers therefore accepts it, whatever datagrams are under way.
constexpr std::uint32_t kAhead = 1u << 30, kAnewAfter = 1u << 20;

struct UdpFrame : FrameDevice {
  InConst<std::int32_t> local_port{"local_port", "1", initial = 0, range(0, 65535), doc = "Local UDP port; 0: any."};
  Out<std::int64_t> missing{"missing", "1", initial = 0, doc = "Datagrams lost or late."};
  Out<std::int64_t> old{"old", "1", initial = 0, doc = "Datagrams repeated or out of order."};
  Resource device{"device", doc = "Numeric address and port, such as 192.168.0.7:5000."};

  void init(Cycle c) {
    prepare(device.text(), 4);
    open(c);
  }
  void on(Cycle c) {
    begin(c);
    old_ = kMostOld;
    forget(kMostDatagrams);
    has_number_ = false;
    put_safe_frame(c);
  }
  Outcome cycle(Cycle c) {
    if (lost() != nullptr) return fault(lost(), socket_.error());
    std::uint8_t bytes[kLongestFrame];
    if (old_ > 0) {
      forget(kMostForgotten);
      wait(c.now());
    }
    for (int i = 0; old_ == 0 && i < kMostDatagrams; ++i) {
      const std::optional<std::size_t> size = socket_.receive(bytes);
      if (!size) break;
      take(bytes, *size, c.now());
    }
    tell_idled(c, send(must_idle(c, true)));
    if (sent_ % kAnewAfter == 0) put_safe_frame(c);
    return ok();
  }
  void off() {
    send(true);
    *connected = false;
  }
  // Keeps the port, because the guard has a copy of the descriptor and closes it later.
  bool clear(Cycle c) {
    if (socket_.descriptor() < 0) open(c);
    else socket_.connect(std::string(device.text()));
    return true;
  }
  void kill(Cycle c) {
    c.safe_frame(0, -1);
    socket_.close();
  }

 private:
  void open(Cycle c) {
    c.safe_frame(0, -1);
    socket_.open(std::string(device.text()), *local_port);
    c.safe_frame(0, socket_.descriptor());
  }
  // Drops datagrams from before `on`. A full queue takes several cycles.
  void forget(int most) {
    std::uint8_t bytes[1];
    for (int i = 0; old_ > 0 && i < most; ++i) old_ = socket_.receive(bytes) ? old_ - 1 : 0;
  }
  void put_safe_frame(Cycle c) {
    std::uint8_t bytes[kLongestFrame];
    const std::size_t size = put_command(bytes, true);
    put_bytes(bytes + 2, sent_ + kAhead, 4);
    c.safe_bytes(0, bytes, close_frame(bytes, size));
  }
  void take(const std::uint8_t* bytes, std::size_t size, Nanoseconds now) {
    if (size != payload() + kFrameOverhead || !is_frame({bytes, size}, payload())) {
      refuse(wrong);
      return;
    }
    const std::uint32_t number = get_bytes(bytes + 2, 4);
    const auto step = static_cast<std::int32_t>(number - number_);
    if (has_number_ && step <= 0) {
      refuse(old);
      return;
    }
    if (!take_state({bytes + 2, payload()}, now)) return;
    if (has_number_) *missing += step - 1;
    has_number_ = true;
    number_ = number;
  }
  bool send(bool is_idle) {
    std::uint8_t bytes[kLongestFrame];
    const std::size_t size = put_command(bytes, is_idle);
    if (size == 0) return false;
    put_bytes(bytes + 2, ++sent_, 4);
    if (socket_.send({bytes, close_frame(bytes, size)})) return true;
    *unsent += 1;
    return false;
  }

  UdpSocket socket_;
  int old_ = 0;  // largest number of datagrams from before `on`; 0: all are dropped
  bool has_number_ = false;
  std::uint32_t number_ = 0;  // number of the last good datagram
  std::uint32_t sent_ = 0;
};

CHIMERA_COMPONENT(UdpFrame, "udp_frame", "Exchanges framed values with a device in numbered datagrams.", rate = 100.0);

}  // namespace
