// SPDX-License-Identifier: Apache-2.0
// Exchanges of requests and answers with one Modbus device. Every exchange may wait, so no cycle makes one.
//
// Answers over TCP repeat the number of their request. Answers on a serial line have no number, and a late, repeated or
// foreign one may look like the next. So a serial exchange ends with a probe: it reads registers of which nothing but
// the count matters, and each of three successive probes has another count. Nothing of the exchange counts unless the
// answer to the probe has its length. A device answers in order, so no earlier answer is then due.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "library/modbus_io/modbus_request.h"
#include "library/modbus_io/modbus_wire.h"

namespace chimera::library {

// A component has at most 64 ports.
inline constexpr std::size_t kMostInputs = 9, kMostHoldings = 6, kMostBits = 8;

enum class ModbusKind : std::uint8_t { kInput, kHolding, kContact, kCoil };

/// Points of one kind, one behind the other, that one request reads or writes.
struct ModbusBlock {
  ModbusKind kind = ModbusKind::kInput;
  bool is_written = false;
  int first = 0;
  std::size_t count = 0;
  std::size_t at = 0;  ///< of its first value in ModbusReading or ModbusCommand

  bool is_bits() const noexcept { return kind >= ModbusKind::kContact; }
  /// "holding registers 100 to 103". Context: any; wait-free.
  void name(char (&text)[48]) const noexcept;
};

struct ModbusPlan {
  bool is_tcp = true;
  int unit = 1;
  int baud = 19200;                 // of a serial line
  std::vector<ModbusBlock> blocks;  // in the order of the requests; not empty
};

struct ModbusReading {
  std::array<std::uint16_t, 2 * kMostInputs> registers{};
  std::array<std::uint8_t, kMostBits> contacts{};
  std::uint64_t exchange = 0;  // number of the exchange that read it; 0: none yet
  std::uint64_t command = 0;   // number of the command written before it; 0: none
};

struct ModbusCommand {
  std::array<std::uint16_t, 2 * kMostHoldings> registers{};
  std::array<std::uint8_t, kMostBits> coils{};
  std::uint64_t number = 0;  // 0: nothing is written
};

/// Result of an exchange: an error number, or the code of a refusal by the device and the block that it refuses.
struct ModbusTrouble {
  std::int32_t error = 0;     ///< 0: none; ETIMEDOUT: no answer; EBADMSG: other bytes
  std::uint16_t refusal = 0;  ///< 1 to 11, of `block`
  std::uint16_t block = 0;

  bool is_good() const noexcept { return error == 0 && refusal == 0; }
  /// True if a further exchange may succeed at once.
  bool may_pass() const noexcept;
  /// "illegal data address". Context: any; wait-free.
  static const char* refusal_text(int code) noexcept;
};

class ModbusLine {
 public:
  static constexpr int kAnswerMs = 200;  ///< a device answers within this time

  explicit ModbusLine(ModbusWire& wire) noexcept : wire_(wire) {}

  /// Requires: the wire is closed.
  void plan(ModbusPlan plan) { plan_ = std::move(plan); }
  const ModbusPlan& plan() const noexcept { return plan_; }
  /// Opens the wire if it is closed. Writes, then reads, a request for each block, up to the first that fails. Each
  /// waits at most kAnswerMs and the time that the bytes take. Changes `reading`; its values count if the result is
  /// good.
  ModbusTrouble exchange(const ModbusCommand& command, ModbusReading& reading) noexcept;
  /// The request of a block of the plan. Context: any; wait-free.
  ModbusRequest request_of(const ModbusBlock& block, const ModbusCommand& command) const noexcept;

 private:
  int open() noexcept;
  ModbusTrouble ask(const ModbusBlock& block, const ModbusCommand& command, ModbusReading& reading) noexcept;
  int talk(ModbusRequest request, ModbusAnswer& answer) noexcept;
  int prove() noexcept;
  ModbusRequest probe() noexcept;
  int drain(int quiet_ms) noexcept;
  int bytes_ms(std::size_t bytes) const noexcept;

  ModbusWire& wire_;
  ModbusPlan plan_;
  int failures_ = 1;           // since the last good exchange; a new line may hold answers to another process
  bool has_probe_ = true;      // false: the device ignores probes
  bool was_proved_ = false;    // it has answered one since the line was opened
  bool ignored_one_ = false;   // likewise
  std::uint16_t number_ = 0;   // of the last request
  std::size_t probes_ = 0;
  std::array<std::uint8_t, ModbusRequest::kMost> answer_{};
  std::size_t size_ = 0;       // bytes of the answer
};

}  // namespace chimera::library
