// SPDX-License-Identifier: Apache-2.0
#include "chimera/bake/target.h"

#include <gtest/gtest.h>

#include <random>

namespace chimera::bake::target_test {

const std::string kWhole = R"(version: 1
cpu: cortex-m3
board: mps2
clock_hz: 25000000
flash: {address: 0x00000000, size: 64 KiB}
ram: {address: 0x20000000, size: 20 KiB}
stack: 2 KiB
uart: {address: 0x40004000, interrupt: uart0_rx, baud: 115200}
watchdog: 100 ms
interrupts: {uart0_rx: 0, timer0: 8}
pins: {led0: {register: 0x40028000, bit: 31, access: write}}
safe_writes: [{register: 0x40028000, value: 4294967295}]
)";

std::optional<std::string> find(const std::string& name, std::string& file) {
  file = name + ".yaml";
  if (name == "whole") return kWhole;
  if (name == "chain") return "version: 1\nlike: whole\n";
  if (name == "bad") return "version: 1\nclock_hz: fast\n";
  return std::nullopt;
}

ReadTarget read(const std::string& text) { return read_target(text, "boards/t.yaml", find); }

/// Everything that is said about the text; "" if it is a target.
std::string said(const std::string& text) {
  const ReadTarget reading = read(text);
  EXPECT_EQ(reading.target.has_value(), reading.report.is_legal()) << text;
  return reading.report.text();
}

std::string replaced(const std::string& old, const std::string& by) {
  std::string text = kWhole;
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), by);
}

TEST(Target, HasWhatItsFileSays) {
  const ReadTarget reading = read(kWhole);
  ASSERT_TRUE(reading.target) << reading.report.text();
  const Target& t = *reading.target;
  EXPECT_EQ(t.name + " " + t.cpu + " " + t.board, "t cortex-m3 mps2");
  EXPECT_EQ(t.clock_hz, 25'000'000u);
  EXPECT_EQ(t.tick.value, milliseconds(1));
  EXPECT_EQ(t.flash.bytes, 65536u);
  EXPECT_EQ(t.ram.address, 0x20000000u);
  EXPECT_EQ(t.stack_bytes + t.handler_stack_bytes, 3072u);
  EXPECT_EQ(t.uart->address, 0x40004000u);
  EXPECT_EQ(t.watchdog, milliseconds(100));
  EXPECT_EQ(t.interrupt("timer0"), 8u);
  EXPECT_EQ(t.pins[0].bit, 31u);
  EXPECT_TRUE(t.pins[0].is_output);
  EXPECT_EQ(t.safe_writes[0].value, UINT32_MAX);
}

TEST(Target, ReplacesKeysOfAnotherTarget) {
  const ReadTarget reading =
      read("version: 1\nlike: whole\ntick: 500 us\nresources: {a: {pedal: \"0:0\", n: [x, y]}}\n");
  ASSERT_TRUE(reading.target) << reading.report.text();
  EXPECT_EQ(reading.target->clock_hz, 25'000'000u);
  EXPECT_EQ(reading.target->tick.value, microseconds(500));
  EXPECT_EQ(reading.target->resource("a", "pedal")->texts[0].text, "0:0");
  EXPECT_EQ(reading.target->resource("a", "n")->texts.size(), 2u);
  EXPECT_EQ(reading.target->resource("a", "m"), nullptr);
}

TEST(Target, NamesEveryKeyThatIsMissing) {
  EXPECT_EQ(said("cpu: cortex-m3\n"),
            "boards/t.yaml:1:1: error: the key 'version' of the target is missing [key-missing]\n"
            "  write 'version: 1' as the first line\n");
  const std::string text = said("version: 1\n");
  for (const char* key : {"cpu", "board", "clock_hz", "flash", "ram"})
    EXPECT_NE(text.find("the key '" + std::string(key) + "' of the target is missing"), std::string::npos) << text;
}

TEST(Target, HasAShellUnlessSomethingElseHasTheLine) {
  const auto shell = [](const std::string& more) {
    const ReadTarget reading = read(kWhole + more);
    EXPECT_TRUE(reading.target) << reading.report.text();
    return reading.target && reading.target->has_shell();
  };
  EXPECT_TRUE(shell(""));
  EXPECT_TRUE(shell("shell: true\n"));
  EXPECT_FALSE(shell("shell: false\n"));
  EXPECT_FALSE(shell("resources: {screen: {device: uart}}\n"));
  EXPECT_FALSE(read("version: 1\nlike: whole\nshell: no\n").target);
}

TEST(Target, RefusesAnUnknownCpu) {
  EXPECT_EQ(said(replaced("cortex-m3", "cortex-m33")),
            "boards/t.yaml:2:6: error: 'cpu' is 'cortex-m33'; expected one of 'cortex-m0plus', 'cortex-m3', "
            "'cortex-m4' [word-unknown]\n  did you mean 'cortex-m3'?\n");
}

TEST(Target, RefusesATickOfBrokenClockCycles) {
  EXPECT_EQ(said(kWhole + "tick: 33 ns\n"),
            "boards/t.yaml:13:7: error: 'tick' is 33 ns, which is no whole number of 1 to 16777216 cycles of 25000000 "
            "Hz [time-range]\n  1 ms suits most applications; the timer of the core has 24 bits\n");
}

TEST(Target, RefusesATickBeyondTheTimer) {
  EXPECT_NE(said(kWhole + "tick: 1 s\n").find("'tick' is 1 s, which is no whole number"), std::string::npos);
  EXPECT_NE(said(kWhole + "tick: 0 s\n").find("'tick' is 0"), std::string::npos);
  EXPECT_NE(said(kWhole + "tick: 292 years\n"), "");
}

TEST(Target, RefusesAnInterruptThatIsNotListed) {
  EXPECT_EQ(said(replaced("interrupt: uart0_rx", "interrupt: uart0_rs")),
            "boards/t.yaml:8:40: error: 'interrupts' has no 'uart0_rs'; it has 'uart0_rx', 'timer0' [word-unknown]\n"
            "  did you mean 'uart0_rx'?\n");
}

TEST(Target, RefusesStacksThatFillTheRam) {
  EXPECT_EQ(said(replaced("stack: 2 KiB", "stack: 19 KiB")),
            "boards/t.yaml:6:6: error: 'stack' and 'handler_stack' take 20480 of the 20480 bytes of 'ram' "
            "[number-bad]\n  both lie in 'ram', with the states of all tasks\n");
}

TEST(Target, RefusesEachBadValueAtItsPlace) {
  const std::pair<std::string, std::string> cases[] = {
      {replaced("0x40028000, bit", "0x40028002, bit"), "expected a multiple of 4"},
      {replaced("bit: 31", "bit: 32"), "expected a whole number from 0 to 31"},
      {replaced("access: write", "access: both"), "expected one of 'read', 'write'"},
      {replaced("4294967295", "4294967296"), "expected a number from 0 to 0xffffffff"},
      {replaced("value: 4294967295", "value: -1"), "expected a number from 0 to 0xffffffff"},
      {replaced("timer0: 8", "timer0: 0"), "has the number '0' of 'uart0_rx'"},
      {replaced("timer0: 8", "timer0: 480"), "expected a whole number from 0 to 479"},
      {replaced("0x20000000", "0x00008000"), "'ram' and 'flash' overlap"},
      {replaced("0x20000000", "0xfffffffc"), "ends at 2^32 at the latest"},
      {replaced("0x20000000", "0x"), "expected a number"},
      {replaced("stack: 2 KiB", "stack: 1001 B"), "expected a multiple of 8 bytes"},
      {replaced("size: 20 KiB", "sizes: 20 KiB"), "the key 'size' of 'ram' is missing"},
      {replaced("board: mps2", "board: ../mps2"), "expected letters, digits"},
      {replaced("version: 1", "version: 2"), "'version' is '2'"},
      {replaced("pins: {", "pin: {"), "did you mean 'pins'?"},
      {"version: 1\nlike: nothing\n", "there is no target 'nothing'"},
      {"version: 1\nlike: chain\n", "target 'chain' has 'like' itself"},
      {"version: 1\nlike: bad\n", "bad.yaml:2: 'clock_hz' is 'fast'"},
      {"version: 1\nlike: [whole]\n", "'like' is a list"},
      {kWhole + "safe_writes: 7\n", "key"},
      {kWhole + "events: {a: 7}\n", "the event of task 'a'"},
      {kWhole + "resources: {a: text}\n", "'resources' of task 'a' is 'text'"},
      {"[]", "the file is a list"},
      {"", "the file is nothing"},
      {"version: 1\ncpu: *a\n", "alias"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_NE(said(text).find(expected), std::string::npos) << text << "\nsays " << said(text);
}

TEST(Target, SurvivesEveryCutAndFlippedByte) {
  std::mt19937 random(20261);
  std::size_t refused = 0;
  for (int i = 0; i < 600; ++i) {
    std::string text = kWhole;
    if (i % 2 == 0) text.resize(random() % text.size());
    else text[random() % text.size()] = static_cast<char>(random());
    refused += said(text).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 300u);
}

}  // namespace chimera::bake::target_test
