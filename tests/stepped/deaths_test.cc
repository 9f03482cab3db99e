// SPDX-License-Identifier: Apache-2.0
// The death of an rtpu or of the manager, and a method that fails, have only their declared effects on the tasks.
#include <gtest/gtest.h>

#include <csignal>

#include "chimera/base/testing/await.h"
#include "chimera/manager/answer/status_json.h"
#include "chimera/platform/process.h"
#include "tests/stepped/stepped_subsystem.h"

namespace chimera::manager::deaths_test {
namespace {

// `steady` must not notice what happens in the second rtpu.
const std::string kTwoRtpus = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  victim: {component: t_thrower, rtpu: second, rate: 200 Hz, alias: {count: n}}
  beside: {component: t_source, rtpu: second, rate: 100 Hz}
configurations: {all: [steady, victim, beside]}
start: all
)";
const std::string kAllOn = "steady victim beside ";

struct Deaths : ::testing::Test {
  /// `steady` has cycled on without a lost cycle, in its first incarnation.
  static void expect_steady(SteppedSubsystem& system) {
    EXPECT_EQ(system.state("steady"), State::kOn);
    EXPECT_EQ(system.profile("steady").dropped, 0u);
    EXPECT_EQ(system.profile("steady").missed, 0u);
    EXPECT_EQ(system.rtpu("first").segment.block.head().incarnation, 1u);
  }
};

TEST_F(Deaths, ADeadRtpuIsNamedWithItsCauseAndComesBackWithItsTasks) {
  const std::pair<int, const char*> ways[] = {{SIGSEGV, "signal 11 (SIGSEGV)"}, {SIGABRT, "signal 6 (SIGABRT)"},
                                              {SIGBUS, "signal 7 (SIGBUS)"},    {SIGFPE, "signal 8 (SIGFPE)"},
                                              {SIGILL, "signal 4 (SIGILL)"},    {SIGKILL, "signal 9 (SIGKILL)"}};
  for (const auto& [signal, words] : ways) {
    SteppedSubsystem system(kTwoRtpus);
    ASSERT_TRUE(system.until_started());
    system.rtpu("second").segment.block.head().running = TaskWord(system.task("victim"), Method::kCycle).word();
    system.die("second", signal);
    ASSERT_TRUE(system.until([&] { return !system.events("rtpu-restarted").empty() && system.on() == kAllOn; }));
    EXPECT_EQ(system.events("rtpu-ended"), std::string("second ended by ") + words + " in victim.cycle\n");
    expect_steady(system);
  }
}

// `reader` reads what `source` writes in the rtpu whose memory is overwritten.
const std::string kReader = R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  reader: {component: t_ages, rtpu: first, rate: 200 Hz}
  source: {component: t_source, rtpu: second, rate: 100 Hz}
configurations: {all: [steady, reader, source]}
start: all
)";

TEST_F(Deaths, AnRtpuThatOverwroteAnyPartOfItsMemoryIsNamedNotBelievedAndEnded) {
  const auto fill = [](testing::TestRtpu& rtpu, int byte) {
    const std::span<std::byte> all = rtpu.segment.region.writable();
    std::memset(all.data(), byte, all.size());
  };
  const TaskId source(2u);
  const std::function<void(testing::TestRtpu&)> ways[] = {
      [&](auto& rtpu) { fill(rtpu, 0); },
      [&](auto& rtpu) { fill(rtpu, 255); },
      [](auto& rtpu) { rtpu.segment.block.head().magic ^= 1; },
      [](auto& rtpu) { ++rtpu.segment.block.head().incarnation; },
      [](auto& rtpu) { rtpu.segment.block.head().phase = static_cast<PeerPhase>(77); },
      [](auto& rtpu) { rtpu.segment.block.head().lost_posts = UINT64_MAX; },
      [&](auto& rtpu) { rtpu.segment.block.set_status(source, {static_cast<State>(200), false, 1}); },
      [&](auto& rtpu) { rtpu.segment.block.profile(source).missed = UINT64_MAX; },
      [&](auto& rtpu) { rtpu.segment.block.profile(source).on_since = Nanoseconds{-5}; }};
  for (const auto& way : ways) {
    SCOPED_TRACE(&way - ways);
    SteppedSubsystem system(kReader);
    ASSERT_TRUE(system.until_started());
    system.stop("second", true);  // it repairs no word
    way(system.rtpu("second"));
    ASSERT_TRUE(system.until([&] { return !system.events("fault").empty(); }, milliseconds(200)));
    EXPECT_NE(system.events("fault").find("something in it has overwritten its memory ("), std::string::npos);
    EXPECT_EQ(system.state("source"), State::kError);
    const Json status = system.status();
    EXPECT_FALSE(status["rtpus"][1]["alive"].as_bool());
    EXPECT_EQ(status["rtpus"][1]["lost_events"].as_int64(), 0);
    EXPECT_EQ(status["tasks"][2]["missed"].as_int64(), 0);
    EXPECT_EQ(status["tasks"][2]["faults"].as_int64(), 0);
    ASSERT_TRUE(system.until(
        [&] { return !system.events("rtpu-restarted").empty() && system.on() == "steady reader source "; }));
    EXPECT_NE(system.events("flag").find("x"), std::string::npos) << "raised by the rtpu of the reader";
    EXPECT_EQ(system.events("rtpu-ended"), "second ended by signal 9 (SIGKILL) with its memory overwritten\n");
    EXPECT_EQ(system.events("lost") + system.events("miss") + system.events("rights"), "");
    expect_steady(system);
  }
}

TEST_F(Deaths, AnRtpuThatDiesFourTimesIsGivenUpUntilClear) {
  SteppedSubsystem system(kTwoRtpus);
  ASSERT_TRUE(system.until_started());
  for (int n = 0; n < 4; ++n) {
    system.die("second", SIGSEGV);
    system.run(milliseconds(300));
  }
  EXPECT_NE(system.events("rtpu-given-up"), "");
  EXPECT_EQ(system.state("victim"), State::kError);
  EXPECT_EQ(system.state("beside"), State::kError);
  EXPECT_EQ(system.signal("clear", "victim"), "");
  ASSERT_TRUE(system.until([&] { return system.state("victim") == State::kOff; }));
  EXPECT_EQ(system.signal("on", "victim"), "");
  EXPECT_TRUE(system.until_on("victim"));
  expect_steady(system);
}

/// The rtpu dies at each step of 100 us after a signal was sent to one of its tasks.
TEST_F(Deaths, AnRtpuThatDiesAtAnyStepOfASignalComesBack) {
  for (const std::string word : {"off", "reinit", "spawn", "on", "kill"}) {
    for (int steps = 0; steps < 8; ++steps) {
      SteppedSubsystem system(kTwoRtpus);
      ASSERT_TRUE(system.until_started());
      const bool is_off_before = word != "off" && word != "reinit";
      ASSERT_EQ(is_off_before ? system.signal("off", "victim") : "", "");
      ASSERT_EQ(word == "spawn" ? system.signal("kill", "victim") : "", "");
      const Json parameters{{"signal", word}, {"tasks", Json::array({"victim"})}};
      const PendingAnswer answer = system.ask("signal", parameters);
      system.run(microseconds(100) * steps);
      system.die("second");
      EXPECT_TRUE(system.until([&] { return answer->has_value(); })) << word << steps;
      EXPECT_TRUE(system.until_on("beside")) << word << steps;
      const auto is_whole = [&] {
        return system.state("victim") != State::kError && system.result("status")["rtpus"][1]["phase"] == "serving";
      };
      EXPECT_TRUE(system.until(is_whole)) << word << steps;
      expect_steady(system);
    }
  }
}

/// The manager dies at each step of a command. Its successor has all events of before, with their authors, and numbers
/// the events on. No task loses a cycle.
TEST_F(Deaths, TheManagerMayDieAtAnyStepOfACommand) {
  bool has_author = false;
  for (int steps = 0; steps < 20; ++steps) {
    SteppedSubsystem system(kTwoRtpus);
    ASSERT_TRUE(system.until_started());
    (void)system.ask("signal", {{"signal", "off"}, {"tasks", Json::array({"victim"})}});
    system.run(microseconds(100) * steps);
    const std::string before = events_json(system.manager().state(), 1, 1000)["events"].dump();
    const std::uint64_t last = system.manager().state().log.last();
    system.kill_manager();
    system.run(milliseconds(20));
    system.start_manager();
    ASSERT_TRUE(system.until([&] { return system.manager().is_ready(); })) << steps;
    const ManagerState& state = system.manager().state();
    EXPECT_EQ(events_json(state, 1, last)["events"].dump(), before) << steps;
    has_author = has_author || before.find("\"by\":\"configure:") != before.npos;
    EXPECT_EQ(state.log.at(last + 1).kind, "manager-started") << steps;
    system.run(milliseconds(50));
    const State is = system.state("victim");
    EXPECT_TRUE(is == State::kOn || is == State::kOff) << steps;
    EXPECT_EQ(is == State::kOff ? system.signal("on", "victim") : "", "") << steps;
    EXPECT_EQ(system.on(), kAllOn) << steps;
    expect_steady(system);
    EXPECT_EQ(system.profile("beside").dropped, 0u) << steps;
  }
  EXPECT_TRUE(has_author);
}

TEST_F(Deaths, AStoppedGuardIsReportedWithinTwoSecondsAndAgainWhenItRuns) {
  SteppedSubsystem system(kTwoRtpus);
  ASSERT_TRUE(system.until_started());
  const char* const words[] = {"sleep", "60"};
  Process guard = *Process::start("/bin/sleep", words, {});
  guard.signal(SIGSTOP);
  ASSERT_TRUE(await_that([&] { return process_state(guard.pid()).letter == 'T'; }));
  system.decision_page().guard_beats = 7;
  system.page().guard_pid = guard.pid();
  system.run(seconds(2));
  EXPECT_NE(system.events("hang").find("guard does not run: stopped by a signal (state T), for 1.5 s\n"),
            std::string::npos)
      << system.events("hang");
  EXPECT_TRUE(system.status()["guard"]["hang"].as_string().starts_with("does not run: stopped by a signal"));
  EXPECT_NE(system.refusal("drill", {{"kill", "second"}}).find("the guard does not run: stopped"), std::string::npos);
  system.decision_page().guard_beats = 8;
  system.run(milliseconds(300));
  EXPECT_NE(system.events("hang").find("guard runs again after 2."), std::string::npos) << system.events("hang");
  EXPECT_TRUE(system.status()["guard"]["hang"].is_null());
  ProcessEnd how;
  guard.signal(SIGKILL);
  EXPECT_TRUE(guard.wait(how, kHangLimit.count));
}

TEST_F(Deaths, AnErrorInAnyMethodStaysWithItsTask) {
  for (const std::string where : {"cycle", "off", "reinit", "kill"}) {
    for (const std::string how : {"1", "2", "3"}) {
      SteppedSubsystem system(R"(subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: first, rate: 200 Hz}
  thrower:
    component: t_thrower
    rtpu: second
    rate: 200 Hz
    alias: {count: n}
    constants: {where: )" + where + ", how: " + how + ", at: " + (where == "cycle" ? "20" : "0") + R"(, recovers: false}
configurations: {all: [steady, thrower]}
start: all
)");
      ASSERT_TRUE(system.until_started()) << where << how;
      if (where != "cycle") (void)system.signal(where, "thrower");
      const State expected = where == "kill" ? State::kNotCreated : State::kError;
      EXPECT_TRUE(system.until([&] { return system.state("thrower") == expected; })) << where << how;
      EXPECT_NE(system.events("fault").find("thrower: "), std::string::npos) << where << how;
      EXPECT_EQ(system.rtpu("second").segment.block.head().incarnation, 1u) << where << how;
      expect_steady(system);
    }
  }
}

}  // namespace
}  // namespace chimera::manager::deaths_test
