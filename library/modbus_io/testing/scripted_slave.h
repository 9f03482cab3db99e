// SPDX-License-Identifier: Apache-2.0
// A Modbus device in virtual time, on a serial line or TCP, that misbehaves at chosen requests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "library/modbus_io/modbus_wire.h"

namespace chimera::library {

enum class Misdeed {
  kNone, kLate, kMute, kCut, kCutThenRest, kDoubled, kDoubledLate, kForeignUnit, kForeignFunction, kForeignThenGood,
  kOtherLength, kDamaged, kNoiseBefore, kNoiseBehind, kEcho, kRefusal
};
inline constexpr std::size_t kMisdeeds = 16;

/// A misdeed at one request; `delay_ms` for those that have one.
struct Deed {
  Misdeed how = Misdeed::kNone;
  int delay_ms = 0;
};

using Bytes = std::vector<std::uint8_t>;

/// Appends the check of a serial line.
inline Bytes with_check(Bytes bytes) {
  std::uint32_t check = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    check ^= byte;
    for (int bit = 0; bit < 8; ++bit) check = (check >> 1) ^ ((check & 1) != 0 ? 0xA001u : 0u);
  }
  bytes.push_back(static_cast<std::uint8_t>(check));
  bytes.push_back(static_cast<std::uint8_t>(check >> 8));
  return bytes;
}

/// Each register, and each byte of bits, holds the number of the request that reads it, counted from 1. One request is
/// served after the other.
class ScriptedSlave final : public ModbusWire {
 public:
  explicit ScriptedSlave(bool is_tcp) : head_(is_tcp ? 6 : 0) {}

  int latency_ms = 3;     ///< of each answer
  bool has_queue = true;  ///< false: it serves all requests at once
  /// For the number of a request, and its bytes without the head of TCP.
  std::function<Deed(std::uint32_t, const Bytes&)> script;
  std::uint32_t requests() const { return requests_; }
  std::uint16_t written() const { return written_; }  ///< first register or byte of coils that was written last
  void pass(int ms) { now_ms_ += ms; }
  /// True if no request is being served and no byte is on its way.
  bool is_idle() const { return end_ms() == now_ms_; }
  /// The time at which all requests of before are served and all bytes have arrived.
  std::int64_t end_ms() const {
    return std::max({now_ms_, free_ms_, arriving_.empty() ? 0 : arriving_.rbegin()->first});
  }

  int open() noexcept override {
    is_open_ = true;
    return 0;
  }
  void close() noexcept override {
    is_open_ = false;
    if (head_ != 0) arriving_.clear();  // a terminal keeps its bytes
  }
  bool is_open() const noexcept override { return is_open_; }
  int read(std::span<std::uint8_t> to, int ms) noexcept override {
    if (arriving_.empty() || arriving_.begin()->first > now_ms_ + ms) {
      now_ms_ += ms;
      return 0;
    }
    now_ms_ = std::max(now_ms_, arriving_.begin()->first);
    int n = 0;
    for (std::uint8_t& byte : to) {
      if (arriving_.empty() || arriving_.begin()->first > now_ms_) break;
      byte = arriving_.begin()->second;
      arriving_.erase(arriving_.begin());
      ++n;
    }
    return n;
  }
  int write(std::span<const std::uint8_t> bytes) noexcept override {
    const Bytes request(bytes.begin(), bytes.end()), body(request.begin() + head_, request.end());
    const std::uint32_t number = ++requests_;
    if (body[1] > 4) written_ = body[1] == 16 ? static_cast<std::uint16_t>(256 * body[7] + body[8]) : body[7];
    const Deed deed = script ? script(number, body) : Deed{};
    const int late_ms = deed.how == Misdeed::kLate ? deed.delay_ms : 0;
    free_ms_ = (has_queue ? std::max(now_ms_, free_ms_) : now_ms_) + latency_ms + late_ms;
    answer(request, answer_to(body, number), deed);
    return 0;
  }
  std::int64_t now_ms() const noexcept override { return now_ms_; }

 private:
  static Bytes answer_to(const Bytes& body, std::uint32_t number) {
    if (body[1] > 4) return {body.begin(), body.begin() + 6};
    const bool is_bits = body[1] <= 2;
    const std::size_t count = 256u * body[4] + body[5], size = is_bits ? (count + 7) / 8 : 2 * count;
    Bytes made = {body[0], body[1], static_cast<std::uint8_t>(size)};
    for (std::size_t i = 0; i < size; ++i)
      made.push_back(static_cast<std::uint8_t>(!is_bits && i % 2 == 0 ? number >> 8 : number));
    return made;
  }
  Bytes framed(const Bytes& request, const Bytes& body) const {
    if (head_ == 0) return with_check(body);
    Bytes made = {request[0], request[1], 0, 0, 0, static_cast<std::uint8_t>(body.size())};
    made.insert(made.end(), body.begin(), body.end());
    return made;
  }
  void answer(const Bytes& request, Bytes body, Deed deed) {
    const Bytes good = framed(request, body);
    const auto half = good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2);
    switch (deed.how) {
      case Misdeed::kNone:
      case Misdeed::kLate: return say(good);
      case Misdeed::kMute: return;
      case Misdeed::kCut: return say({good.begin(), half});
      case Misdeed::kCutThenRest:
        say({good.begin(), half});
        return say({half, good.end()}, deed.delay_ms);
      case Misdeed::kDoubled: return say(good), say(good);
      case Misdeed::kDoubledLate: return say(good), say(good, deed.delay_ms);
      case Misdeed::kForeignUnit: return body[0] ^= 7, say(framed(request, body));
      case Misdeed::kForeignFunction: return body[1] ^= 7, say(framed(request, body));
      case Misdeed::kForeignThenGood: return body[0] ^= 7, say(framed(request, body)), say(good);
      case Misdeed::kOtherLength: return body.pop_back(), say(framed(request, body));
      case Misdeed::kDamaged: return say(damaged(good));
      case Misdeed::kNoiseBefore: return say({0xFF, 0x00, 0x13}), say(good);
      case Misdeed::kNoiseBehind: return say(good), say({0x01, 0x04});
      case Misdeed::kEcho: return say(request), say(good);
      case Misdeed::kRefusal:
        return say(framed(request, {body[0], static_cast<std::uint8_t>(body[1] | 0x80), 2}));
    }
  }
  // TCP finds damage itself; what remains is another number.
  Bytes damaged(Bytes bytes) const {
    bytes[head_ == 0 ? bytes.size() - 3 : 1] ^= 1;
    return bytes;
  }
  // In order. Bytes with a delay let others overtake them.
  void say(const Bytes& bytes, int delay_ms = 0) {
    for (const std::uint8_t byte : bytes) arriving_.emplace(free_ms_ + delay_ms, byte);
  }

  const std::ptrdiff_t head_;
  bool is_open_ = false;
  std::uint32_t requests_ = 0;
  std::uint16_t written_ = 0;
  std::int64_t now_ms_ = 0, free_ms_ = 0;
  std::multimap<std::int64_t, std::uint8_t> arriving_;  // by time
};

}  // namespace chimera::library
