// SPDX-License-Identifier: Apache-2.0
// Reads and writes registers and coils of a Modbus device. README.md is the data sheet.
//
//   cycle                                     background (may wait for the device)
//   told_.put(command)     -------------->    told_.get(), written, then read
//   brought_.get()         <--------------    brought_.put(reading)
#include <atomic>
#include <stdexcept>

#include "chimera/base/math.h"
#include "chimera/task/component.h"
#include "library/device/latest.h"
#include "library/device/sentence.h"
#include "library/modbus_io/modbus_line.h"
#include "library/modbus_io/modbus_request.h"

using namespace chimera;
using namespace chimera::library;

namespace {

constexpr int kCallsBetweenTries = 20;  // calls of background, 10 ms each: five connection attempts a second

struct ModbusIo {
  Many<Out<double>, kMostPoints> input{"input*", "X", initial = 0.0,
                                       doc = "Input registers, from first_input on."};
  Many<Out<bool>, kMostPoints> contact{"contact*", "1", initial = false,
                                          doc = "Discrete inputs, from first_contact on."};
  Many<In<double>, kMostPoints> holding{"holding*", "U", doc = "Written to holding registers, from first_holding on."};
  Many<In<bool>, kMostPoints> coil{"coil*", "1", doc = "Written to coils, from first_coil on."};
  Out<double> age{"age", "s", initial = 0.0, doc = "Time since the last exchange, or since on."};
  Out<bool> connected{"connected", initial = false, doc = "An exchange succeeded within the timeout."};
  Out<bool> idled{"idled", initial = false, safe_state,
                  doc = "The flag is up, and `idle` and false coils were written since."};
  Out<std::int64_t> unsent{"unsent", "1", initial = 0, doc = "Cycles whose inputs were not finite and not sent."};
  InConst<std::int32_t> first_input{"first_input", "1", initial = 0, range(0, 65535), doc = "Address of input[0]."};
  InConst<std::int32_t> first_contact{"first_contact", "1", initial = 0, range(0, 65535),
                                      doc = "Address of contact[0]."};
  InConst<std::int32_t> first_holding{"first_holding", "1", initial = 0, range(0, 65535),
                                      doc = "Address of holding[0]."};
  InConst<std::int32_t> first_coil{"first_coil", "1", initial = 0, range(0, 65535), doc = "Address of coil[0]."};
  InConst<double> input_resolution{"input_resolution", "X", initial = 1.0, doc = "Input for a 1 in the register."};
  InConst<double> holding_resolution{"holding_resolution", "U", initial = 1.0, doc = "Value for a 1 in the register."};
  InConst<bool> is_signed{"is_signed", initial = true, doc = "Registers are -32768 to 32767; false: 0 to 65535."};
  InConst<double> idle{"idle", "U", initial = 0.0, doc = "Value of each holding at off; coils are false."};
  InConst<double> timeout{"timeout", "s", initial = 1.0, range(0.05, 3600),
                          doc = "Silence after which the device counts as lost."};
  InConst<std::int32_t> unit{"unit", "1", initial = 1, range(0, 255), doc = "Unit (slave) number of the device."};
  InConst<std::int32_t> baud{"baud", "1", initial = 19200, range(1200, 115200),
                             doc = "Bits a second of rtu; 8 bits, even parity."};
  Resource device{"device", doc = "tcp:ADDRESS:PORT or rtu:PATH."};

  void init(Cycle c) {
    if (input.size() + contact.size() + holding.size() + coil.size() == 0)
      throw std::runtime_error("nothing is exchanged: name at least one input, contact, holding or coil");
    for (const double r : {*input_resolution, *holding_resolution})
      if (!math::is_finite(r) || r == 0) throw std::runtime_error("a resolution is finite and not 0");
    if (!math::is_finite(*idle)) throw std::runtime_error("`idle` is finite");
    lost_.set(device.text(), "does not answer");
    line_.plan(plan());
    int error = line_.connect();
    if (error == 0) error = line_.exchange({}, reading_);
    if (error != 0) throw std::runtime_error(refusal(error));
    brought(0);
    if (holding.size() + coil.size() > 0) hand_over_line(c);
  }
  void on(Cycle c) {
    is_lost_ = false;
    heard_ = c.now();
    *age = 0;
    *idled = false;
    idle_from_ = 0;
    put_safe_frames(c);
  }
  Outcome cycle(Cycle c) {
    if (is_lost_) return fault(lost_.text(), error_.load(std::memory_order_relaxed));
    if (has_lost_second_.load(std::memory_order_relaxed)) tell_lost_second(c);
    const ModbusReading& now = brought_.get();
    if (now.exchange != seen_) heard_ = c.now();
    seen_ = now.exchange;
    for (std::size_t i = 0; i < input.size(); ++i) *input[i] = value_of(now.inputs[i]);
    for (std::size_t i = 0; i < contact.size(); ++i) *contact[i] = now.contacts[i] != 0;
    *age = to_seconds(c.now() - heard_);
    is_lost_ = *age > *timeout;
    *connected = !is_lost_;
    tell(is_lost_ || c.illegal());
    if (!c.illegal()) idle_from_ = 0;
    else if (idle_from_ == 0) idle_from_ = told_number_;
    *idled = idle_from_ != 0 && now.command >= idle_from_;
    return ok();
  }
  void off() {
    tell(true);
    *connected = false;
  }
  Outcome clear() {
    if (is_good_.load(std::memory_order_relaxed)) return ok();
    return fault(lost_.text(), error_.load(std::memory_order_relaxed));
  }
  void background() {
    if (!is_good_.load(std::memory_order_relaxed)) {
      if (++calls_ % kCallsBetweenTries != 0) return;
      if (line_.has_second()) has_lost_second_.store(true, std::memory_order_relaxed);
      if (const int error = line_.connect(); error != 0) return brought(error);
    }
    brought(line_.exchange(told_.get(), reading_));
  }
  void kill(Cycle c) {
    for (const std::uint32_t frame : {0u, 1u}) c.safe_frame(frame, -1);
    line_.close();
  }

 private:
  // A serial line must rest for 3.5 characters, or the device takes the next bytes as a part of the cut request. The
  // second request comes later, so that the device can answer the first.
  void hand_over_line(Cycle c) {
    const int descriptor = line_.open_second();
    if (descriptor < 0) c.note("takes no second connection: it gets no `idle` when this process dies");
    const Nanoseconds rest = line_.is_tcp() ? Nanoseconds{} : Nanoseconds{38'500'000'000 / *baud};
    c.safe_frame(0, descriptor, rest);
    c.safe_frame(1, descriptor, rest + (holding.size() == 0 ? Nanoseconds{} : milliseconds(50)));
  }
  void tell_lost_second(Cycle c) {
    has_lost_second_.store(false, std::memory_order_relaxed);
    c.note("was connected again: it gets no `idle` when this process dies, until `kill` and `spawn`");
  }
  void put_safe_frames(Cycle c) {
    std::array<std::uint16_t, kMostPoints> values;
    values.fill(raw_of(*idle));
    const std::array<std::uint8_t, kMostPoints> fallen{};
    if (holding.size() > 0) {
      const auto request = ModbusRequest::registers(line_.is_tcp(), *unit, *first_holding,
                                                    std::span(values).first(holding.size()));
      c.safe_bytes(0, request.bytes().data(), request.bytes().size());
    }
    if (coil.size() == 0) return;
    const auto request = ModbusRequest::coils(line_.is_tcp(), *unit, *first_coil, std::span(fallen).first(coil.size()));
    c.safe_bytes(1, request.bytes().data(), request.bytes().size());
  }
  ModbusPlan plan() const {
    return {std::string(device.text()), *unit,          *baud,
            *first_input,               count(input),   *first_contact, count(contact),
            *first_holding,             count(holding), *first_coil,    count(coil)};
  }
  static int count(const auto& ports) { return static_cast<int>(ports.size()); }
  std::string refusal(int error) const {
    const std::string text = device.c_str() + std::string(": ") + ModbusLine::text_of(error);
    if (device.text().starts_with("rtu:") && (error == ENOENT || error == EACCES))
      return "rtu:" + open_refusal(device.c_str() + 4, error);
    return text + ": see that the device is on, and that its address, unit and registers are these";
  }
  double value_of(std::uint16_t raw) const {
    const double number = *is_signed ? static_cast<double>(static_cast<std::int16_t>(raw)) : static_cast<double>(raw);
    return number * *input_resolution;
  }
  std::uint16_t raw_of(double value) const {
    const double lowest = *is_signed ? -32768 : 0, highest = *is_signed ? 32767 : 65535;
    const double number = math::floor(value / *holding_resolution + 0.5);
    const double held = number < lowest ? lowest : number > highest ? highest : number;
    return static_cast<std::uint16_t>(static_cast<std::int32_t>(held));
  }
  void tell(bool is_idle) {
    ModbusCommand command;
    for (std::size_t i = 0; i < holding.size(); ++i) {
      if (!is_idle && !math::is_finite(*holding[i])) {
        *unsent += 1;
        return;
      }
      command.holdings[i] = raw_of(is_idle ? *idle : *holding[i]);
    }
    for (std::size_t i = 0; i < coil.size(); ++i) command.coils[i] = !is_idle && *coil[i] ? 1 : 0;
    command.number = ++told_number_;
    told_.put(command);
  }
  // Stores the result of an exchange or of a connection attempt.
  void brought(int error) {
    is_good_.store(error == 0, std::memory_order_relaxed);
    error_.store(error, std::memory_order_relaxed);
    if (error != 0) return;
    ++reading_.exchange;
    brought_.put(reading_);
  }

  Latest<ModbusCommand> told_;
  Latest<ModbusReading> brought_;
  // Relaxed, because they order no other data: background writes, cycle reports them in a fault.
  std::atomic<bool> is_good_{false};
  std::atomic<int> error_{0};
  std::atomic<bool> has_lost_second_{false};  // background writes, cycle gives a note
  // Used by background after init.
  ModbusLine line_;
  ModbusReading reading_;
  int calls_ = 0;
  // Used by cycle.
  LostSentence lost_;
  Nanoseconds heard_;
  std::uint64_t seen_ = 0;
  std::uint64_t told_number_ = 0;  // number of the last command
  std::uint64_t idle_from_ = 0;    // number of the first command after the flag rose; 0: the flag is down
  bool is_lost_ = false;
};

CHIMERA_COMPONENT(ModbusIo, "modbus_io", "Registers and coils of a Modbus device.", rate = 50.0,
                  source = "Modbus Application Protocol 1.1b3");

}  // namespace
