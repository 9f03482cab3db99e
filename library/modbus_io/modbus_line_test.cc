// SPDX-License-Identifier: Apache-2.0
// Every misdeed of a device at every request of an exchange, on a serial line and over TCP.
#include "library/modbus_io/modbus_line.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>

#include "library/modbus_io/register_form.h"
#include "library/modbus_io/testing/scripted_slave.h"

namespace chimera::library {
namespace {

using Blocks = std::vector<ModbusBlock>;

/// Plans of which each deceives in its own way: answers of one form, of forms that alternate, acknowledgements alone.
const std::vector<Blocks>& plans() {
  static const ModbusBlock input{ModbusKind::kInput, false, 10, 1, 0}, next{ModbusKind::kInput, false, 20, 1, 1},
      pair{ModbusKind::kInput, false, 30, 2, 2}, read{ModbusKind::kHolding, false, 100, 1, 4},
      contact{ModbusKind::kContact, false, 5, 8, 0}, holding{ModbusKind::kHolding, true, 0, 1, 0},
      coil{ModbusKind::kCoil, true, 0, 8, 0};
  static const std::vector<Blocks> kPlans = {
      {input},       {pair},           {contact}, {holding}, {coil}, {input, next},
      {holding, input}, {holding, coil, input, read, contact}};
  return kPlans;
}

/// A line and its device in virtual time. Attempts come as `background` makes them.
struct Exchanges {
  ScriptedSlave slave;
  ModbusLine line{slave};
  Blocks blocks;
  ModbusCommand command;

  Exchanges(bool is_tcp, Blocks plan, int latency_ms = 3) : slave(is_tcp), blocks(std::move(plan)) {
    slave.latency_ms = latency_ms;
    line.plan({is_tcp, 1, 19200, blocks});
  }
  bool is_probe(const Bytes& request) const {
    constexpr int kFunctions[] = {4, 3, 2, 1};
    return request[1] <= 4 && std::ranges::none_of(blocks, [&](const ModbusBlock& block) {
      return !block.is_written && kFunctions[static_cast<std::size_t>(block.kind)] == request[1] &&
             block.first == 256 * request[2] + request[3] && block.count == request[5];
    });
  }
  /// A good attempt is fresh: the device read each value, and took the command, after the attempt began.
  ModbusTrouble attempt() {
    const std::uint32_t before = slave.requests();
    command.number += 1;
    command.registers.fill(static_cast<std::uint16_t>(command.number));
    for (std::size_t bit = 0; bit < 8; ++bit) command.coils[bit] = command.number >> bit & 1;
    ModbusReading reading;
    const ModbusTrouble trouble = line.exchange(command, reading);
    slave.pass(trouble.is_good() ? 10 : 200);
    if (!trouble.is_good()) return trouble;
    for (const ModbusBlock& block : blocks) {
      std::uint32_t contacts = 0;
      for (std::size_t bit = 0; bit < 8; ++bit) contacts |= static_cast<std::uint32_t>(reading.contacts[bit]) << bit;
      if (block.is_written) EXPECT_EQ(slave.written() & 0xFF, command.number & 0xFF);
      else if (block.is_bits()) EXPECT_LE((contacts - before - 1) & 0xFF, slave.requests() - before - 1) << "contacts";
      else EXPECT_GT(reading.registers[block.at], before) << "register " << block.first;
    }
    EXPECT_EQ(reading.command, command.number);
    return trouble;
  }
  /// The device behaves from now on. Soon after its last late answer an exchange succeeds, and then each one.
  void recovers() {
    slave.script = nullptr;
    const std::int64_t end = slave.end_ms() + 1000 + 10 * slave.latency_ms;
    while (!attempt().is_good()) ASSERT_LE(slave.now_ms(), end) << "out of step";
    while (slave.now_ms() < slave.end_ms()) slave.pass(10);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(attempt().is_good());
  }
};

struct ModbusLineTest : ::testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Lines, ModbusLineTest, ::testing::Bool(),
                         [](const auto& line) { return line.param ? "Tcp" : "Serial"; });

bool has_delay(Misdeed how) {
  return how == Misdeed::kLate || how == Misdeed::kCutThenRest || how == Misdeed::kDoubledLate;
}

/// Calls `act(exchanges, deed, request)` for each plan, speed of the device, misdeed, delay and request of an exchange.
template <class Act>
void for_each_misdeed(bool is_tcp, Act act) {
  for (std::size_t plan = 0; plan < plans().size(); ++plan) {
    for (const int latency : {0, 3, 60, 150}) {
      for (std::size_t how = 1; how < kMisdeeds; ++how) {
        for (const int delay : {20, 90, 210, 350, 500, 900, 2500}) {
          if (delay != 20 && !has_delay(static_cast<Misdeed>(how))) break;
          for (std::uint32_t request = 1; request <= plans()[plan].size() + 1; ++request) {
            SCOPED_TRACE("plan " + std::to_string(plan) + ", latency " + std::to_string(latency) + ", misdeed " +
                         std::to_string(how) + ", delay " + std::to_string(delay) + ", request " +
                         std::to_string(request));
            Exchanges exchanges(is_tcp, plans()[plan], latency);
            act(exchanges, Deed{static_cast<Misdeed>(how), delay}, request);
            if (::testing::Test::HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

TEST_P(ModbusLineTest, NoMisdeedAtAnyRequestMakesAnOldValueNew) {
  for_each_misdeed(GetParam(), [](Exchanges& one, Deed deed, std::uint32_t request) {
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(one.attempt().is_good());
    const std::uint32_t at = one.slave.requests() + request;
    one.slave.script = [=](std::uint32_t number, const Bytes&) { return number == at ? deed : Deed{}; };
    const ModbusTrouble trouble = one.attempt();
    if (deed.how == Misdeed::kRefusal && request <= one.blocks.size()) {
      EXPECT_EQ(trouble.refusal, 2);
      EXPECT_EQ(trouble.block, request - 1);
    }
    for (int i = 0; i < 4; ++i) one.attempt();
    one.recovers();
  });
}

TEST_P(ModbusLineTest, ANewLineTakesNoAnswerToTheOneBefore) {
  for_each_misdeed(GetParam(), [](Exchanges& one, Deed deed, std::uint32_t request) {
    one.slave.script = [=](std::uint32_t number, const Bytes&) { return number == request ? deed : Deed{}; };
    one.attempt();
    one.slave.close();  // as at the death of the process
    one.recovers();
  });
}

TEST_P(ModbusLineTest, NoConstantDelayMakesAnOldValueNew) {
  for (const Blocks& plan : plans()) {
    for (int latency = 0; latency < 2400; ++latency) {
      SCOPED_TRACE("blocks " + std::to_string(plan.size()) + ", latency " + std::to_string(latency / 2));
      Exchanges one(GetParam(), plan, latency / 2);
      one.slave.has_queue = latency % 2 == 0;
      for (int i = 0; i < 20; ++i) {
        const bool is_good = one.attempt().is_good();
        const bool is_near = std::abs(latency / 2 - ModbusLine::kAnswerMs) < 30;  // the bytes take time, too
        EXPECT_TRUE(is_near || is_good == (latency / 2 < ModbusLine::kAnswerMs));
      }
      one.slave.latency_ms = 3;
      one.recovers();
      if (HasFatalFailure()) return;
    }
  }
}

// One misdeed at a time: if an answer is lost and a repeated one comes in its place, nothing shows it.
TEST_P(ModbusLineTest, NoSequenceOfMisdeedsMakesAnOldValueNew) {
  std::mt19937 source(19);
  const auto random = [&] { return static_cast<std::uint32_t>(source()); };
  for (int sequence = 0; sequence < 3000; ++sequence) {
    SCOPED_TRACE("sequence " + std::to_string(sequence));
    Exchanges one(GetParam(), plans()[random() % plans().size()], static_cast<int>(random() % 180));
    std::uint32_t next = 1 + random() % 12;
    one.slave.script = [&](std::uint32_t number, const Bytes&) {
      if (number < next || !one.slave.is_idle()) return Deed{};
      next = number + 1 + random() % 12;
      return Deed{static_cast<Misdeed>(random() % kMisdeeds), static_cast<int>(random() % 900)};
    };
    for (int i = 0; i < 30; ++i) one.attempt();
    one.recovers();
    if (HasFatalFailure()) return;
  }
}

TEST_P(ModbusLineTest, ADeviceThatRefusesOrIgnoresProbesIsExchangedWith) {
  for (const Blocks& plan : plans()) {
    for (const Misdeed how : {Misdeed::kRefusal, Misdeed::kMute}) {
      Exchanges one(GetParam(), plan);
      bool is_late = false;
      one.slave.script = [&](std::uint32_t, const Bytes& request) {
        if (one.is_probe(request)) return Deed{how, 0};
        return std::exchange(is_late, false) ? Deed{Misdeed::kLate, 350} : Deed{};
      };
      for (int i = 0; i < 5; ++i) ASSERT_TRUE(one.attempt().is_good());
      is_late = true;
      EXPECT_EQ(one.attempt().error, ETIMEDOUT);
      for (int i = 0; i < 5; ++i) EXPECT_TRUE(one.attempt().is_good());
    }
  }
}

TEST(ModbusRequest, EachCutLengthOfAGoodAnswerIsIncompleteAndEachFlippedBitIsForeign) {
  const ModbusRequest request = ModbusRequest::read(false, 1, 3, 100, 2);
  ASSERT_EQ(request.bytes().size(), 8u);
  const Bytes good = with_check({1, 3, 4, 0x43, 0x66, 0x80, 0x00});
  EXPECT_EQ(request.judge(good), ModbusAnswer::kGood);
  for (std::size_t n = 0; n < good.size(); ++n)
    EXPECT_EQ(request.judge({good.data(), n}), ModbusAnswer::kIncomplete) << n;
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1u << (bit % 8)));
    EXPECT_EQ(request.judge(bad), ModbusAnswer::kForeign) << bit;
  }
  EXPECT_EQ(request.register_at(good, 0), 0x4366);
}

TEST(RegisterForm, AFloatAndWholeNumbersInEitherWordOrder) {
  const auto read = [](const char* form, std::uint16_t first, std::uint16_t second) {
    const std::uint16_t words[] = {first, second};
    return register_places(form, "input_form", 1, false)[0].number(words);
  };
  EXPECT_EQ(read("float32", 0x4366, 0x8000), 230.5);
  EXPECT_EQ(read("float32_low", 0x8000, 0x4366), 230.5);
  EXPECT_EQ(read("int32", 0xFFFF, 0xFFFE), -2);
  EXPECT_EQ(read("int32_low", 0xFFFE, 0xFFFF), -2);
  EXPECT_EQ(read("uint32", 0xFFFF, 0xFFFE), 4294967294.0);
  EXPECT_EQ(read("int16", 0xFFFE, 0), -2);
  EXPECT_EQ(read("uint16", 0xFFFE, 0), 65534);
}

TEST(RegisterForm, WhatIsWrittenIsReadAgainAndCutAtTheLimits) {
  for (const char* form :
       {"int16", "uint16", "int32", "uint32", "float32", "int32_low", "uint32_low", "float32_low"}) {
    const RegisterPlace place = register_places(form, "holding_form", 1, true)[0];
    const bool is_unsigned = form[0] == 'u', is_float = form[0] == 'f';
    for (const double x : {0.0, 1.0, -1.0, 230.0, 32767.0, -32768.0, 1e300, -1e300}) {
      std::uint16_t words[2] = {};
      place.put(x, words);
      const double back = place.number(words);
      if (std::fabs(x) < 1e9) {
        EXPECT_EQ(back, is_unsigned && x < 0 ? 0 : x) << form;
      } else {
        EXPECT_TRUE(std::isfinite(back) && (x > 0 ? back > 0 : back <= 0)) << form << ' ' << x;
        EXPECT_EQ(is_float, std::fabs(back) > 1e38) << form;
      }
    }
  }
}

TEST(RegisterPlaces, FollowEachOtherAndKeepTheLastForm) {
  const auto places = register_places(" input:3 int16 float32_low holding:100 uint16", "input_form", 5, false);
  const std::pair<bool, int> expected[] = {{false, 3}, {false, 4}, {true, 100}, {true, 101}, {true, 102}};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(places[i].is_holding, expected[i].first) << i;
    EXPECT_EQ(places[i].address, expected[i].second) << i;
  }
  EXPECT_TRUE(places[1].is_low_first);
  EXPECT_EQ(register_places("", "input_form", 2, false)[1].address, 1);
  EXPECT_TRUE(register_places("", "holding_form", 1, true)[0].is_holding);
}

TEST(RegisterPlaces, RefuseOtherWords) {
  const auto refusal = [](const char* text, std::size_t count, bool is_written) -> std::string {
    try {
      register_places(text, "form", count, is_written);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("float", 1, false),
            "`form`: \"float\" is no form: int16 uint16 int32 uint32 float32, and int32_low uint32_low float32_low "
            "with the low word first");
  EXPECT_NE(refusal("int16_low", 1, false), "");
  EXPECT_EQ(refusal("coil:3", 1, false), "`form`: \"coil:3\" is no place: holding:100 is one, input:100 another");
  EXPECT_EQ(refusal("input:3", 1, true), "`form`: \"input:3\" is no place: holding:100 is one");
  EXPECT_EQ(refusal("int16 int16", 1, false), "`form`: has 2 forms, and there are 1 ports");
  EXPECT_EQ(refusal("input:65535 int32", 1, false), "`form`: the last register is 65535");
}

}  // namespace
}  // namespace chimera::library
