// SPDX-License-Identifier: Apache-2.0
// Reads and writes registers and coils of a Modbus device. README.md is the data sheet.
//
//   cycle                                     background (may wait for the device)
//   told_.put(command)     -------------->    told_.get(), written, then read
//   brought_.get()         <--------------    brought_.put(reading)
#include <atomic>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "chimera/base/math.h"
#include "chimera/task/component.h"
#include "library/device/answers.h"
#include "library/device/latest.h"
#include "library/device/sentence.h"
#include "library/modbus_io/modbus_line.h"
#include "library/modbus_io/modbus_wire.h"
#include "library/modbus_io/register_form.h"

using namespace chimera;
using namespace chimera::library;

namespace {

constexpr int kCallsBetweenTries = 20;  // calls of background, 10 ms each: five attempts a second
constexpr int kTriesOfInit = 5;         // late answers to the process before may still come

struct ModbusIo {
  Many<Out<double>, kMostInputs> input{"input*", "X", initial = 0.0, doc = "Numbers read, as `input_form` says."};
  Many<Out<bool>, kMostBits> contact{"contact*", "1", initial = false, doc = "Discrete inputs, from first_contact on."};
  Many<In<double>, kMostHoldings> holding{"holding*", "U", doc = "Numbers written, as `holding_form` says."};
  Many<In<bool>, kMostBits> coil{"coil*", "1", doc = "Written to coils, from first_coil on."};
  Out<double> age{"age", "s", initial = 0.0, doc = "Time since the last exchange, or since on."};
  Out<bool> connected{"connected", initial = false, doc = "An exchange succeeded within the timeout."};
  Out<bool> idled{"idled", initial = false, safe_state,
                  doc = "The flag is up, and `idle` and false coils were written since."};
  Out<std::int64_t> unsent{"unsent", "1", initial = 0, doc = "Cycles whose inputs were not finite and not sent."};
  InConst<Text<256>> input_form{"input_form", initial = "input:0 int16", doc = "Places and forms of the inputs."};
  InConst<Text<256>> holding_form{"holding_form", initial = "holding:0 int16", doc = "Those of the holdings."};
  InConst<std::int32_t> first_contact{"first_contact", "1", initial = 0, range(0, 65535),
                                      doc = "Address of contact[0]."};
  InConst<std::int32_t> first_coil{"first_coil", "1", initial = 0, range(0, 65535), doc = "Address of coil[0]."};
  Many<InConst<double>, kMostInputs> input_resolution{"input_resolution*", "X", initial = 1.0,
                                                      doc = "Input for a 1 in the register: a list, or none."};
  Many<InConst<double>, kMostHoldings> holding_resolution{"holding_resolution*", "U", initial = 1.0,
                                                          doc = "Value for a 1 in the register, likewise."};
  Many<InConst<double>, kMostHoldings> idle{"idle*", "U", initial = 0.0,
                                            doc = "Value at off and until the first answer: a list, or none."};
  InConst<double> timeout{"timeout", "s", initial = 1.0, range(0.05, 3600),
                          doc = "Silence after which the device counts as lost."};
  InConst<std::int32_t> unit{"unit", "1", initial = 1, range(0, 255), doc = "Unit (slave) number of the device."};
  InConst<std::int32_t> baud{"baud", "1", initial = 19200, range(1200, 115200),
                             doc = "Bits a second of rtu; 8 bits, even parity."};
  Resource device{"device", doc = "tcp:ADDRESS:PORT or rtu:PATH."};

  void init(Cycle c) {
    if (input.size() + contact.size() + holding.size() + coil.size() == 0)
      throw std::runtime_error("nothing is exchanged: name at least one input, contact, holding or coil");
    check_constants();
    input_places_ = register_places(input_form->view(), "input_form", input.size(), false);
    holding_places_ = register_places(holding_form->view(), "holding_form", holding.size(), true);
    silent_.set(device.text(), "does not answer");
    garbled_.set(device.text(), "answers with other bytes");
    wire_.plan(std::string(device.text()), *baud);
    line_.plan({wire_.is_tcp(), *unit, *baud, blocks()});
    ModbusTrouble trouble = line_.exchange({}, reading_);
    for (int tries = 1; tries < kTriesOfInit && trouble.may_pass(); ++tries) trouble = line_.exchange({}, reading_);
    if (!trouble.is_good()) throw std::runtime_error(refusal(trouble));
    brought({});
    if (holding.size() + coil.size() > 0) hand_over_line(c);
  }
  void on(Cycle c) {
    is_lost_ = false;
    answers_.begin(c.now());
    seen_ = brought_.get().exchange;
    *age = 0;
    *idled = false;
    idle_from_ = 0;
    put_safe_frames(c);
  }
  Outcome cycle(Cycle c) {
    if (is_lost_) return lost();
    if (has_lost_second_.load(std::memory_order_relaxed)) tell_lost_second(c);
    const ModbusReading& now = brought_.get();
    if (now.exchange != seen_) answers_.take(c.now());
    seen_ = now.exchange;
    show(now);
    *age = answers_.age(c.now());
    is_lost_ = *age > *timeout;
    *connected = !is_lost_;
    tell(is_lost_ || answers_.must_idle(c));
    if (!c.illegal()) idle_from_ = 0;
    else if (idle_from_ == 0) idle_from_ = told_number_;
    *idled = idle_from_ != 0 && now.command >= idle_from_;
    return ok();
  }
  void off() {
    tell(true);
    *connected = false;
  }
  Outcome clear() { return trouble_.load(std::memory_order_relaxed).is_good() ? ok() : lost(); }
  void background() {
    if (!trouble_.load(std::memory_order_relaxed).is_good() && ++calls_ % kCallsBetweenTries != 0) return;
    const bool had_second = wire_.has_second();
    brought(line_.exchange(told_.get(), reading_));
    if (had_second && !wire_.has_second()) has_lost_second_.store(true, std::memory_order_relaxed);
  }
  void kill(Cycle c) {
    for (std::uint32_t frame = 0; frame < n_written_; ++frame) c.safe_frame(frame, -1);
    wire_.close();
  }

 private:
  void check_constants() const {
    const auto check = [](const auto& given, std::size_t count, const char* name, bool is_divisor) {
      if (given.size() != 0 && given.size() != count)
        throw std::runtime_error(std::string("give one `") + name + "` for each port, or none");
      for (const auto& one : given)
        if (!math::is_finite(*one) || (is_divisor && *one == 0))
          throw std::runtime_error(std::string("`") + name + "` is finite" + (is_divisor ? " and not 0" : ""));
    };
    check(input_resolution, input.size(), "input_resolution", true);
    check(holding_resolution, holding.size(), "holding_resolution", true);
    check(idle, holding.size(), "idle", false);
  }
  // Joins numbers in neighbouring registers of one kind.
  static void add_blocks(std::vector<ModbusBlock>& blocks, const std::vector<RegisterPlace>& places, bool is_written) {
    std::size_t at = 0;
    for (const RegisterPlace& place : places) {
      const ModbusKind kind = place.is_holding ? ModbusKind::kHolding : ModbusKind::kInput;
      const bool is_next = at > 0 && blocks.back().kind == kind &&
                           blocks.back().first + static_cast<int>(blocks.back().count) == place.address;
      if (!is_next) blocks.push_back({kind, is_written, place.address, 0, at});
      blocks.back().count += place.width();
      at += place.width();
    }
  }
  std::vector<ModbusBlock> blocks() {
    std::vector<ModbusBlock> made;
    add_blocks(made, holding_places_, true);
    if (coil.size() > 0) made.push_back({ModbusKind::kCoil, true, *first_coil, coil.size(), 0});
    n_written_ = static_cast<std::uint32_t>(made.size());
    if (n_written_ > CHIMERA_SAFE_FRAMES)
      throw std::runtime_error("`holding_form`: at most " + std::to_string(CHIMERA_SAFE_FRAMES) +
                               " groups of registers and coils are written");
    add_blocks(made, input_places_, false);
    if (contact.size() > 0) made.push_back({ModbusKind::kContact, false, *first_contact, contact.size(), 0});
    return made;
  }
  // A serial line must rest for 3.5 characters, or the device takes the next bytes as a part of the cut request. The
  // second request comes later, so that the device can answer the first.
  void hand_over_line(Cycle c) {
    const int descriptor = wire_.open_second();
    if (descriptor < 0) c.note("takes no second connection: it gets no `idle` when this process dies");
    const Nanoseconds rest = wire_.is_tcp() ? Nanoseconds{} : Nanoseconds{38'500'000'000 / *baud};
    for (std::uint32_t frame = 0; frame < n_written_; ++frame)
      c.safe_frame(frame, descriptor, rest + (frame == 0 ? Nanoseconds{} : milliseconds(50)));
  }
  void tell_lost_second(Cycle c) {
    has_lost_second_.store(false, std::memory_order_relaxed);
    c.note("was connected again: it gets no `idle` when this process dies, until `kill` and `spawn`");
  }
  void put_safe_frames(Cycle c) {
    ModbusCommand command;
    (void)fill(command, true);
    std::uint32_t frame = 0;
    for (const ModbusBlock& block : line_.plan().blocks) {
      if (!block.is_written) continue;
      const ModbusRequest request = line_.request_of(block, command);
      c.safe_bytes(frame++, request.bytes().data(), request.bytes().size());
    }
  }
  std::string refusal(const ModbusTrouble& trouble) const {
    if (device.text().starts_with("rtu:") && (trouble.error == ENOENT || trouble.error == EACCES))
      return "rtu:" + open_refusal(device.c_str() + 4, trouble.error);
    char text[CHIMERA_FAULT_TEXT];
    name(trouble, text);
    return device.c_str() + std::string(": ") + text +
           (trouble.refusal != 0 ? ": see its registers and `unit`"
                                 : ": see that the device is on, and that its address and `unit` are these");
  }
  // "refuses coil 3: exception 2, illegal data address"
  void name(const ModbusTrouble& trouble, char (&text)[CHIMERA_FAULT_TEXT]) const {
    char block[48] = "";
    if (trouble.refusal == 0) {
      std::snprintf(text, sizeof text, "%s", trouble.error == ETIMEDOUT ? "does not answer"
                                             : trouble.error == EBADMSG ? "answers with other bytes"
                                                                        : ::strerrordesc_np(trouble.error));
      return;
    }
    line_.plan().blocks[trouble.block].name(block);
    std::snprintf(text, sizeof text, "refuses %s: exception %d, %s", block, trouble.refusal,
                  ModbusTrouble::refusal_text(trouble.refusal));
  }
  Outcome lost() const {
    const ModbusTrouble trouble = trouble_.load(std::memory_order_relaxed);
    if (trouble.refusal == 0) return fault(trouble.error == EBADMSG ? garbled_.text() : silent_.text(), trouble.error);
    char text[CHIMERA_FAULT_TEXT];
    name(trouble, text);
    return fault(text, trouble.refusal);
  }
  void show(const ModbusReading& now) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < input_places_.size(); ++i) {
      const double number = input_places_[i].number(now.registers.data() + at);
      const double value = number * (input_resolution.size() == 0 ? 1.0 : *input_resolution[i]);
      at += input_places_[i].width();
      if (math::is_finite(value)) *input[i] = value;
    }
    for (std::size_t i = 0; i < contact.size(); ++i) *contact[i] = now.contacts[i] != 0;
  }
  // Returns false if a holding is not finite.
  bool fill(ModbusCommand& command, bool is_idle) const {
    std::size_t at = 0;
    for (std::size_t i = 0; i < holding_places_.size(); ++i) {
      const double value = !is_idle ? *holding[i] : idle.size() == 0 ? 0.0 : *idle[i];
      if (!math::is_finite(value)) return false;
      const double number = value / (holding_resolution.size() == 0 ? 1.0 : *holding_resolution[i]);
      holding_places_[i].put(number, command.registers.data() + at);
      at += holding_places_[i].width();
    }
    for (std::size_t i = 0; i < coil.size(); ++i) command.coils[i] = !is_idle && *coil[i] ? 1 : 0;
    return true;
  }
  void tell(bool is_idle) {
    ModbusCommand command;
    if (!fill(command, is_idle)) {
      *unsent += 1;
      return;
    }
    command.number = ++told_number_;
    told_.put(command);
  }
  // Stores the result of an exchange or of a connection attempt.
  void brought(const ModbusTrouble& trouble) {
    trouble_.store(trouble, std::memory_order_relaxed);
    if (!trouble.is_good()) return;
    ++reading_.exchange;
    brought_.put(reading_);
  }

  // Constant after init; empty if init refused.
  std::vector<RegisterPlace> input_places_, holding_places_;
  LostSentence silent_, garbled_;
  std::uint32_t n_written_ = 0;  // blocks, each of which has a safe frame

  Latest<ModbusCommand> told_;
  Latest<ModbusReading> brought_;
  // Relaxed, because they order no other data: background writes, cycle reports them in a fault.
  std::atomic<ModbusTrouble> trouble_{};
  std::atomic<bool> has_lost_second_{false};  // background writes, cycle gives a note
  // Used by background after init.
  DeviceWire wire_;
  ModbusLine line_{wire_};
  ModbusReading reading_;
  int calls_ = 0;
  // Used by cycle.
  Answers answers_;
  std::uint64_t seen_ = 0;
  std::uint64_t told_number_ = 0;  // number of the last command
  std::uint64_t idle_from_ = 0;    // number of the first command after the flag rose; 0: the flag is down
  bool is_lost_ = false;
};

CHIMERA_COMPONENT(ModbusIo, "modbus_io", "Registers and coils of a Modbus device.", rate = 50.0,
                  source = "Modbus Application Protocol 1.1b3");

}  // namespace
