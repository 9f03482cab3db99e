// SPDX-License-Identifier: Apache-2.0
#include "firmware/shell/shell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "firmware/shell/testing/shell_scene.h"

namespace chimera::firmware::shell_test {
namespace {

using testing::kGain;
using testing::kSpare;
using testing::kWave;
using testing::orders;
using testing::ShellScene;

TEST(Shell, StatusShowsTimeFlagAndTasks) {
  ShellScene scene;
  scene.run(10);
  EXPECT_EQ(scene.ask("status"),
            "test at 0.010 s: 2 of 3 tasks ON, flag down, configuration normal\n"
            "wave ON cycles 11 missed 0 dropped 0 faults 0\n"
            "spare OFF cycles 0 missed 0 dropped 0 faults 0\n"
            "gain ON cycles 11 missed 0 dropped 0 faults 0\n"
            "ok\n");
}

TEST(Shell, StatusShowsStacksAndWatchdog) {
  std::array<std::uint32_t, 300> main{}, handler{};
  paint(main);
  paint(handler);
  main[280] = 1;    // and what lies behind it
  handler[3] = 1;
  const std::array<Stack, 2> stacks{Stack{"main", main}, Stack{"handler", handler}};
  struct NoPort final : WatchdogPort {
    void stroke() noexcept override {}
  } port;
  ShellScene scene;
  HeapMemory heap;
  Vitals vitals(scene.set().tasks(), stacks, heap);
  ResetRecord record;
  Watchdog watchdog(vitals, port, record);
  watchdog.tick(milliseconds(0));
  scene.use(stacks, &watchdog);
  const std::string said = scene.ask("status");
  EXPECT_TRUE(said.ends_with("stack main: 80 of 1200 bytes used\n"
                             "stack handler: 1188 of 1200 bytes used, its guard is overwritten\n"
                             "watchdog: stack guard: stack 1\nok\n"))
      << said;
}

TEST(Shell, CarriesOutSignalsAtACycleBoundary) {
  ShellScene scene;
  EXPECT_EQ(scene.ask("off gain"), "ok\n");
  EXPECT_EQ(scene.state(kGain), State::kOff);
  EXPECT_EQ(scene.ask("kill gain"), "ok\n");
  EXPECT_EQ(scene.state(kGain), State::kNotCreated);
  EXPECT_EQ(scene.ask("spawn gain"), "ok\n");
  EXPECT_EQ(scene.state(kGain), State::kOff);
  EXPECT_EQ(scene.ask("on gain"), "ok\n");
  EXPECT_EQ(scene.state(kGain), State::kOn);
  EXPECT_EQ(scene.ask("reinit gain"), "ok\n");
  orders.gain_faults = true;
  scene.run(2);
  EXPECT_EQ(scene.state(kGain), State::kError);
  EXPECT_EQ(scene.ask("clear gain"), "ok\n");
  EXPECT_EQ(scene.state(kGain), State::kOff);
}

TEST(Shell, TurnsSeveralTasksTogether) {
  ShellScene scene;
  EXPECT_EQ(scene.ask("off gain wave"), "ok\n");
  EXPECT_EQ(scene.state(kWave), State::kOff);
  EXPECT_EQ(scene.ask("on spare gain"), "ok\n");
  EXPECT_EQ(scene.state(kSpare), State::kOn);
  EXPECT_EQ(scene.state(kGain), State::kOn);
}

TEST(Shell, RefusesSignalsInTheWordsOfTheHost) {
  ShellScene scene;
  EXPECT_EQ(scene.ask("on wave"), "no: on is not legal for wave in state ON\n");
  EXPECT_EQ(scene.ask("clear gain"), "no: clear is not legal for gain in state ON\n");
  EXPECT_EQ(scene.ask("on spare"), "no: y would have two producers: wave and spare\n");
  scene.ask("off gain wave");
  EXPECT_EQ(scene.ask("on gain"), "no: y would have no producer\n");
  orders.spare_refuses = true;
  EXPECT_EQ(scene.ask("on spare"), "no: on: spare: no current\n");
  scene.ask("clear spare");
  orders.spare_refuses = false;
  orders.spare_is_slow = true;
  EXPECT_EQ(scene.ask("on spare"), "no: on: spare is not ready yet\n");
}

TEST(Shell, RefusesUnknownNamesAndWrongOperands) {
  ShellScene scene;
  EXPECT_EQ(scene.ask("jump"), "no: no command 'jump': try help\n");
  EXPECT_EQ(scene.ask("on pump"), "no: no task 'pump'\n");
  EXPECT_EQ(scene.ask("profile y"), "no: no task 'y'\n");
  EXPECT_EQ(scene.ask("get wave"), "no: no variable 'wave'\n");
  EXPECT_EQ(scene.ask("switch wave"), "no: no configuration 'wave'\n");
  EXPECT_EQ(scene.ask("on"), "no: on takes TASK...\n");
  EXPECT_EQ(scene.ask("kill gain wave"), "no: kill takes TASK\n");
  EXPECT_EQ(scene.ask("status all"), "no: status takes no operand\n");
  EXPECT_EQ(scene.ask("set k"), "no: set takes VARIABLE VALUE... [UNIT]\n");
  EXPECT_EQ(scene.ask("off gain gain"), "no: task 'gain' is named twice\n");
  EXPECT_EQ(scene.ask("off a b c d e f g h i j k l"), "no: a line has at most 12 words\n");
  EXPECT_EQ(scene.state(kGain), State::kOn);
}

TEST(Shell, RefusesLinesThatAreTooLongOrHaveBadBytes) {
  ShellScene scene;
  EXPECT_EQ(scene.ask("status" + std::string(90, ' ')).substr(0, 5), "test ");
  EXPECT_EQ(scene.ask("off gain" + std::string(89, ' ')), "no: a line has at most 96 bytes, not 97\n");
  EXPECT_EQ(scene.ask("off \xc3\xa4"), "no: byte 195 is no character of a command\n");
  EXPECT_EQ(scene.ask(std::string_view("off gain\0", 9)), "no: byte 0 is no character of a command\n");
  EXPECT_EQ(scene.state(kGain), State::kOn);
}

TEST(Shell, SkipsEmptyLines) {
  ShellScene scene;
  scene.type("\r\n\n   \r\n");
  EXPECT_EQ(scene.run(5), "");
  EXPECT_EQ(scene.ask("\toff  gain "), "ok\n");
}

TEST(Shell, SetsOperatorVariablesInTheirUnit) {
  ShellScene scene;
  scene.run(10);
  EXPECT_EQ(scene.ask("get k"), "k = 2 N.s/m, age 0.010 s\nok\n");
  EXPECT_EQ(scene.ask("set k 2.5 N.s/m"), "ok\n");
  EXPECT_EQ(scene.value("k"), 2.5);
  EXPECT_EQ(scene.ask("set k -1e-3"), "ok\n");
  EXPECT_EQ(scene.value("k"), -1e-3);
  EXPECT_EQ(scene.ask("set n -9223372036854775808"), "ok\n");
  EXPECT_TRUE(scene.ask("get n").starts_with("n = -9223372036854775808, age "));
  EXPECT_EQ(scene.ask("set k 3 m"), "no: k is in N.s/m, not in 'm'\n");
  EXPECT_EQ(scene.ask("set k 3 4"), "no: k has 1 element, not 2\n");
  EXPECT_EQ(scene.ask("set k 1e400"), "no: '1e400' is no float64\n");
  EXPECT_EQ(scene.ask("set n 1.5"), "no: '1.5' is no int64\n");
  EXPECT_EQ(scene.ask("set n one"), "no: n has no unit, and 'one' is no number\n");
  EXPECT_EQ(scene.ask("set y 1"), "no: y is no operator variable\n");
  EXPECT_EQ(scene.value("k"), -1e-3);
}

TEST(Shell, GetsValuesWithUnitAndAge) {
  ShellScene scene;
  scene.run(41);
  EXPECT_EQ(scene.ask("get y"), "y = 10.25 m/s, age 0.000 s\nok\n");
  EXPECT_EQ(scene.ask("get u").substr(0, 4), "u = ");
  EXPECT_EQ(scene.ask("get list"), "list = [0 0.5 1] rad, age 0.000 s\nok\n");
  EXPECT_EQ(scene.ask("get late"), "no: late has no value\n");
}

TEST(Shell, SwitchesAndShowsTheReceipt) {
  ShellScene scene;
  scene.run(20);
  const std::string said = scene.ask("switch reserve");
  EXPECT_TRUE(said.starts_with("changed after ")) << said;
  EXPECT_TRUE(said.find(" us, cycles lost: 0\ny moves by ") != std::string::npos) << said;
  EXPECT_TRUE(said.ends_with(" m/s\nok\n")) << said;
  EXPECT_EQ(scene.state(kWave), State::kOff);
  EXPECT_EQ(scene.state(kSpare), State::kOn);
  EXPECT_EQ(scene.ask("switch reserve"), "reserve is in force, nothing to do\nok\n");
  orders.gain_faults = true;
  scene.run(2);
  EXPECT_EQ(scene.ask("switch normal"), "no: refused, in-error, task gain\n");
}

TEST(Shell, ReportsASwitchThatIsAborted) {
  ShellScene scene;
  orders.spare_refuses = true;
  EXPECT_EQ(scene.ask("switch reserve"), "no: aborted, on-failed, task spare: no current\n");
  EXPECT_EQ(scene.state(kWave), State::kOn);
}

TEST(Shell, EventsShowsEachEventOnce) {
  ShellScene scene;
  scene.run(5);
  const std::string first = scene.ask("events");  // those of one instant come in any order
  for (const char* line : {"wave: NOT-CREATED -> ON", "spare: NOT-CREATED -> OFF", "gain: NOT-CREATED -> ON"})
    EXPECT_TRUE(first.find("0.000 s " + std::string(line) + "\n") != std::string::npos) << first;
  EXPECT_EQ(std::ranges::count(first, '\n'), 4) << first;
  EXPECT_EQ(scene.ask("events"), "ok\n");
  orders.gain_faults = true;
  scene.run(3);
  orders.gain_faults = false;
  EXPECT_EQ(scene.ask("events"), "0.007 s gain: fault in cycle, code 42: the gain?is broken\n"
                                 "0.007 s gain: ON -> ERROR\nok\n");
  scene.ask("clear gain");
  scene.ask("switch reserve");
  const std::string said = scene.ask("events");
  EXPECT_TRUE(said.find("gain: ERROR -> OFF\n") != std::string::npos) << said;
  EXPECT_TRUE(said.find(" s switch from other tasks to reserve: done, cycles lost: 0\n") != std::string::npos) << said;
}

TEST(Shell, CountsFaultsOfOneKindInOneEvent) {
  ShellScene scene;
  scene.ask("events");
  orders.gain_faults = orders.gain_recovers = true;
  scene.run(50);
  const std::string said = scene.ask("events");
  EXPECT_TRUE(said.find(" s gain: fault in cycle, code 42: the gain?is broken (5") != std::string::npos) << said;
}

TEST(Shell, CountsEventsThatWentBeforeTheyWereShown) {
  ShellScene scene;
  scene.ask("events");
  for (int i = 0; i < 10; ++i) scene.ask(i % 2 == 0 ? "off gain" : "on gain"), scene.ask("reinit gain");
  for (int i = 0; i < 10; ++i) scene.ask(i % 2 == 0 ? "off gain" : "on gain");
  const std::string said = scene.ask("events");
  EXPECT_TRUE(said.starts_with("older events lost: 4\n")) << said;
  EXPECT_EQ(std::ranges::count(said, '\n'), 18);
}

TEST(Shell, ProfileShowsTimesAndTheLastFault) {
  ShellScene scene;
  scene.run(3);
  EXPECT_EQ(scene.ask("profile spare"),
            "spare OFF cycles 0 every 1000.000 us\ncycle: none yet\nresponse: none yet\nstart delay: none yet\n"
            "missed 0 dropped 0 overrun 0 aborted 0 held 0 rejected 0 events lost 0 faults 0\nok\n");
  orders.gain_faults = true;
  scene.run(2);
  const std::string said = scene.ask("profile gain");
  EXPECT_TRUE(said.find("cycle: 0.000 us to 0.000 us, mean 0.000 us\n") != std::string::npos) << said;
  EXPECT_TRUE(said.ends_with(" in cycle, code 42:\nthe gain?is broken\nok\n")) << said;
}

TEST(Shell, HelpShowsEveryCommand) {
  ShellScene scene;
  const std::string said = scene.ask("help");
  EXPECT_EQ(std::ranges::count(said, '\n'), 14);
  for (const CommandSpec& each : commands())
    EXPECT_TRUE(said.find(std::string(each.name) + " ") != std::string::npos) << each.name;
}

TEST(Shell, LineThatCameTooEarlyWaits) {
  ShellScene scene;
  scene.is_hasty = true;
  scene.type("off gain\nget k\non gain\n");
  const std::string said = scene.run(20);
  EXPECT_TRUE(said.starts_with("ok\nk = 2 N.s/m")) << said;
  EXPECT_TRUE(said.ends_with("ok\nok\n")) << said;
  EXPECT_EQ(scene.state(kGain), State::kOn);
}

TEST(Shell, RefusesALineThatLostBytes) {
  ShellScene scene;
  scene.sends = false;  // no row leaves, so that the shell stops in the middle of an answer
  scene.type("status\nhelp\n");
  scene.run(3);
  scene.is_hasty = true;
  scene.type(std::string(121, ' ') + "off gain\n");  // 130 bytes
  scene.run(1);
  EXPECT_EQ(scene.shell().lost_bytes(), 2u);
  scene.sends = true;
  scene.is_hasty = false;
  EXPECT_TRUE(scene.run(20).ends_with("ok\n")) << "the answer to help";
  EXPECT_EQ(scene.ask("status"), "no: at least 2 bytes of this line or before it were lost: wait for each answer\n");
  EXPECT_EQ(scene.state(kGain), State::kOn);
  EXPECT_TRUE(scene.ask("status").ends_with("input: at least 2 bytes lost\nok\n"));
}

TEST(Shell, HandsOutWholeRowsOnly) {
  ShellScene scene;
  scene.run(1);
  for (const char c : std::string_view("status\n")) scene.shell().receive(static_cast<std::uint8_t>(c));
  int n_rows = 0, n_steps = 0;
  for (; scene.shell().has_work(); ++n_steps) {
    scene.shell().step({});
    std::string handed;
    for (int byte = 0; (byte = scene.shell().next_byte()) >= 0;) handed += static_cast<char>(byte);
    EXPECT_TRUE(handed.empty() || handed.ends_with("\r\n")) << handed;
    n_rows += handed.empty() ? 0 : 1;
  }
  EXPECT_GE(n_rows, 5) << "head, three tasks, answer";
  EXPECT_GT(n_steps, 2 * n_rows) << "a row of more than 64 bytes takes two steps";
}

TEST(Shell, StatusShowsHowTheImageBegan) {
  ShellScene scene;
  Boot boot;
  boot.is_warm = true;
  boot.warm_boots = 1;
  boot.cause = ResetCause::kWatchdog;
  scene.use({}, nullptr, &boot);
  EXPECT_TRUE(scene.ask("status").ends_with("warm boot 1: watchdog\nok\n"));
}

TEST(Shell, AStepDoesASmallPieceOfWork) {
  ShellScene scene;
  scene.run(1);
  const std::uint64_t before = scene.steps();
  const std::string said = scene.ask("help");
  const auto rows = static_cast<std::uint64_t>(std::ranges::count(said, '\n'));
  EXPECT_GE(scene.steps() - before, 2 * rows + 1) << "to make a row and to send it are two steps";
  EXPECT_LE(scene.most_bytes_sent(), 64u);
}

std::vector<DigestLine> digest_with(std::string_view noise, bool is_hasty) {
  ShellScene scene;
  scene.is_hasty = is_hasty;
  scene.type(noise);
  scene.run(2500);
  return scene.end();
}

void expect_equal(const std::vector<DigestLine>& a, const std::vector<DigestLine>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].second, b[i].second);
    EXPECT_EQ(a[i].hash, b[i].hash);
    EXPECT_EQ(a[i].publications, b[i].publications);
    EXPECT_EQ(a[i].faults, b[i].faults);
  }
}

/// Bytes of a linear congruential generator: the same on every machine.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed) {}
  std::uint32_t below(std::uint32_t n) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::uint32_t>((state_ >> 33) % n);
  }

 private:
  std::uint64_t state_;
};

TEST(Shell, AMegabyteOfNoiseChangesNoDigest) {
  Noise noise(20260730);
  std::string bytes;
  while (bytes.size() < 1'000'000) bytes += static_cast<char>(noise.below(256));
  const std::vector<DigestLine> quiet = digest_with("", false);
  const auto is_of_gain = [](const DigestLine& line) { return line.task == kGain; };
  ASSERT_EQ(std::ranges::count_if(quiet, is_of_gain), 3) << "one line for each second";
  expect_equal(digest_with(bytes, false), quiet);
  expect_equal(digest_with(bytes, true), quiet);
}

TEST(Shell, CommandsThatReadChangeNoDigest) {
  constexpr std::string_view kWords[] = {"status", "get",  "y",   "u",   "k",    "profile", "gain", "events",
                                         "help",   "wave", "set", "m/s", "jump", "normal",  "\x7f", "999"};
  Noise noise(7);
  std::string bytes;
  while (bytes.size() < 200'000) {
    for (std::uint32_t n = noise.below(5); n > 0; --n) bytes += std::string(kWords[noise.below(16)]) + " ";
    if (bytes.ends_with("set k 999 ") || bytes.ends_with("set k 999 999 ")) bytes += "jump";
    bytes += "\n";
  }
  expect_equal(digest_with(bytes, false), digest_with("", false));
}

TEST(Shell, AnActChangesTheDigest) {
  const std::vector<DigestLine> quiet = digest_with("", false), set = digest_with("set k 3\n", false);
  ASSERT_EQ(quiet.size(), set.size());
  const auto is_equal = [](const DigestLine& a, const DigestLine& b) { return a.hash == b.hash; };
  EXPECT_FALSE(std::ranges::equal(quiet, set, is_equal));
}

}  // namespace
}  // namespace chimera::firmware::shell_test
