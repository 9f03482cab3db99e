// SPDX-License-Identifier: Apache-2.0
// Exchanges requests and answers with a Modbus device, and believes no late, repeated, cut or foreign answer.
#include "library/modbus_io/modbus_line.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>

namespace chimera::library {
namespace {

constexpr std::size_t kProbeCounts = 3;
constexpr int kSilenceMs = 1000;    // after it no answer is due
constexpr int kMostDrainMs = 1000;  // of a device that never ends

/// Time without a byte before the next exchange. It grows with each failure, so that a device that is always late
/// has answered all earlier requests.
constexpr int quiet_ms(int failures) { return failures == 0 ? 0 : 25 << std::min(failures, 4); }

}  // namespace

void ModbusBlock::name(char (&text)[48]) const noexcept {
  constexpr const char* kNames[] = {"input register", "holding register", "discrete input", "coil"};
  const char* const kind_name = kNames[static_cast<std::size_t>(kind)];
  const int last = first + static_cast<int>(count) - 1;
  if (count == 1) std::snprintf(text, sizeof text, "%s %d", kind_name, first);
  else std::snprintf(text, sizeof text, "%ss %d to %d", kind_name, first, last);
}

bool ModbusTrouble::may_pass() const noexcept { return error == ETIMEDOUT || error == EBADMSG; }

const char* ModbusTrouble::refusal_text(int code) noexcept {
  constexpr const char* kTexts[] = {"", "illegal function", "illegal data address", "illegal data value",
                                    "device failure", "acknowledge", "device busy", "negative acknowledge",
                                    "memory parity error", "", "gateway path unavailable", "gateway target silent"};
  return code >= 0 && code < static_cast<int>(std::size(kTexts)) ? kTexts[code] : "";
}

int ModbusLine::open() noexcept {
  if (wire_.is_open()) return 0;
  was_proved_ = ignored_one_ = false;
  failures_ = std::max(failures_, 1);
  return -wire_.open();
}

// After a failure of TCP a new connection is in step. A serial line stays open while it can be read and written.
ModbusTrouble ModbusLine::exchange(const ModbusCommand& command, ModbusReading& reading) noexcept {
  ModbusTrouble trouble{.error = open()};
  if (trouble.error != 0) return trouble;
  if (failures_ > 0) has_probe_ = !plan_.is_tcp;
  const int left = drain(plan_.is_tcp ? 0 : quiet_ms(failures_));
  if (left != EBADMSG) trouble.error = left;
  for (std::size_t i = 0; i < plan_.blocks.size() && trouble.is_good(); ++i) {
    if (plan_.blocks[i].is_written && command.number == 0) continue;
    trouble = ask(plan_.blocks[i], command, reading);
    trouble.block = static_cast<std::uint16_t>(i);
  }
  if (trouble.is_good() && has_probe_) trouble.error = prove();
  failures_ = trouble.is_good() ? 0 : failures_ + 1;
  if (trouble.error != 0 && (plan_.is_tcp || !trouble.may_pass())) wire_.close();
  if (trouble.is_good()) reading.command = command.number;
  return trouble;
}

ModbusRequest ModbusLine::request_of(const ModbusBlock& block, const ModbusCommand& command) const noexcept {
  constexpr std::uint8_t kRead[] = {4, 3, 2, 1};
  const bool tcp = plan_.is_tcp;
  if (!block.is_written)
    return ModbusRequest::read(tcp, plan_.unit, kRead[static_cast<std::size_t>(block.kind)], block.first, block.count);
  if (block.is_bits())
    return ModbusRequest::coils(tcp, plan_.unit, block.first,
                                std::span(command.coils).subspan(block.at, block.count));
  return ModbusRequest::registers(tcp, plan_.unit, block.first,
                                  std::span(command.registers).subspan(block.at, block.count));
}

ModbusTrouble ModbusLine::ask(const ModbusBlock& block, const ModbusCommand& command,
                              ModbusReading& reading) noexcept {
  const ModbusRequest request = request_of(block, command);
  ModbusAnswer answer{};
  if (const int error = talk(request, answer); error != 0) return {.error = error};
  const auto bytes = std::span<const std::uint8_t>(answer_).first(size_);
  if (answer == ModbusAnswer::kRefusal) return {.refusal = request.refusal(bytes)};
  for (std::size_t i = 0; i < block.count && !block.is_written; ++i) {
    if (block.is_bits()) reading.contacts[block.at + i] = request.bit_at(bytes, i) ? 1 : 0;
    else reading.registers[block.at + i] = request.register_at(bytes, i);
  }
  return {};
}

// Returns 0 or an error number. A device needs a pause of 3.5 characters before the request. A byte that comes in the
// pause belongs to no request.
int ModbusLine::talk(ModbusRequest request, ModbusAnswer& answer) noexcept {
  if (const int error = drain(plan_.is_tcp ? 0 : bytes_ms(4)); error != 0) return error;
  request.number(++number_);
  if (const int error = wire_.write(request.bytes()); error != 0) return -error;
  const std::int64_t end = wire_.now_ms() + kAnswerMs + bytes_ms(request.bytes().size() + request.answer_size());
  size_ = 0;
  for (std::int64_t left = 0; (left = end - wire_.now_ms()) > 0;) {
    const int got = wire_.read(std::span(answer_).subspan(size_), static_cast<int>(left));
    if (got < 0) return -got;
    size_ += static_cast<std::size_t>(got);
    answer = request.judge({answer_.data(), size_});
    if (answer == ModbusAnswer::kForeign) return EBADMSG;
    if (answer != ModbusAnswer::kIncomplete) return 0;
  }
  return size_ == 0 ? ETIMEDOUT : EBADMSG;
}

// A refusal is an answer, too. A device may ignore probes: then a long silence shows that no answer is due. After two
// ignored probes, exchanges have no probe until the next failure.
int ModbusLine::prove() noexcept {
  ModbusAnswer answer{};
  const int error = talk(probe(), answer);
  was_proved_ = was_proved_ || error == 0;
  if (error != ETIMEDOUT || was_proved_) return error;
  const int got = wire_.read(answer_, kSilenceMs);
  if (got != 0) return got < 0 ? -got : EBADMSG;
  has_probe_ = !std::exchange(ignored_one_, true);
  return 0;
}

// Reads at the place of the largest block, so that a device can answer a smaller count. No request of the plan has an
// answer of this function and length.
ModbusRequest ModbusLine::probe() noexcept {
  ModbusBlock made = plan_.blocks.back();
  for (const ModbusBlock& block : plan_.blocks)
    if (!block.is_written && !block.is_bits() && (made.is_written || made.is_bits() || block.count > made.count))
      made = block;
  made.is_written = false;
  const std::size_t step = made.is_bits() ? 8 : 1;  // bits of one byte have one length
  const auto is_used = [&](const ModbusBlock& block) {
    return !block.is_written && block.kind == made.kind && (block.count - 1) / step == (made.count - 1) / step;
  };
  made.count = 1;
  for (std::size_t left = ++probes_ % kProbeCounts;; made.count += step)
    if (std::ranges::none_of(plan_.blocks, is_used) && left-- == 0) return request_of(made, {});
}

// Drops the bytes that the line holds, until `quiet_ms` pass without one. Returns 0 if there were none, else EBADMSG or
// another error number.
int ModbusLine::drain(int quiet_ms) noexcept {
  std::uint8_t bytes[256];
  int result = 0;
  for (const std::int64_t end = wire_.now_ms() + kMostDrainMs; wire_.now_ms() < end; result = EBADMSG) {
    const int got = wire_.read(bytes, quiet_ms);
    if (got == 0) return result;
    if (got < 0) return -got;
  }
  return result;
}

int ModbusLine::bytes_ms(std::size_t bytes) const noexcept {
  return plan_.is_tcp ? 0 : static_cast<int>(bytes * 11'000 / static_cast<std::size_t>(plan_.baud)) + 2;
}

}  // namespace chimera::library
