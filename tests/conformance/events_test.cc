// SPDX-License-Identifier: Apache-2.0
// Events in the loop without preemption: rings, and lines that an interrupt handler counts.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>

#include "chimera/runtime/hosted/descriptor_events.h"
#include "tests/conformance/random_toys.h"
#include "tests/conformance/runner.h"

namespace chimera::toy::events_test {
namespace {

constexpr Nanoseconds kPeriod = milliseconds(1);

ScriptAct ring_at(Nanoseconds at, TaskId task) { return {at, ScriptAct::Kind::kSignal, Signal::kWakeup, task}; }

/// A task "lamp" with events, and a periodic one beside it.
struct EventsTest : ::testing::TestWithParam<Kind> {
  EventsTest() {
    TaskSpec& spec = app.add("lamp", kPeriod);
    spec.aperiodic = spec.has_events = true;
    app.add("beside", milliseconds(3));
  }
  std::vector<Nanoseconds> releases() const {
    std::vector<Nanoseconds> found;
    for (const Call& call : app.calls_of("lamp", Method::kCycle)) found.push_back(call.now);
    return found;
  }
  const Profile& profile() const { return app.task("lamp").profile; }

  Application app;
  const TaskId lamp{0u};
};

INSTANTIATE_TEST_SUITE_P(EachLoop, EventsTest, ::testing::Values(Kind::kExecutiveOnTwin, Kind::kVirtual), name_of_kind);

// Releases of a sporadic task: at the event, or one period after the release before.
std::vector<Nanoseconds> sporadic(const std::vector<ScriptAct>& acts) {
  std::vector<Nanoseconds> expected;
  Nanoseconds last = Nanoseconds{} - kPeriod;
  for (const ScriptAct& act : acts) expected.push_back(last = std::max(act.at, last + kPeriod));
  return expected;
}

TEST_P(EventsTest, TenThousandRingsInBurstsReleaseOneJobEachAtTheExactInstant) {
  Dice dice(30);
  std::vector<ScriptAct> acts;
  for (Nanoseconds at; acts.size() < 10'000; at += microseconds(dice.below(40'000))) {
    const std::size_t burst = std::min<std::size_t>(1 + dice.below(40), 10'000 - acts.size());
    for (std::size_t i = 0; i < burst; ++i) acts.push_back(ring_at(at, lamp));
  }
  Runner runner(app.build(), GetParam(), Policy::kEdf, acts);
  ASSERT_TRUE(runner.start());
  EXPECT_EQ(runner.run(seconds(20)), RunEnd::kTime);
  EXPECT_EQ(releases(), sporadic(acts));
  EXPECT_EQ(profile().events, 10'000u);
  EXPECT_EQ(profile().events_lost + profile().dropped + profile().missed, 0u);
  EXPECT_EQ(app.task("lamp").events, 0u);
}

// Long jobs of another task delay the answers, so that events come while an earlier one still waits.
TEST_P(EventsTest, UnderOverloadNoEventIsLostAndReleasesKeepTheirDistance) {
  app.toy("beside").spend = microseconds(2800);
  Dice dice(7);
  std::vector<ScriptAct> acts;
  for (Nanoseconds at; acts.size() < 500; at += microseconds(dice.below(6'000))) acts.push_back(ring_at(at, lamp));
  Runner runner(app.build(), GetParam(), Policy::kRm, acts);
  ASSERT_TRUE(runner.start());
  runner.run(seconds(10));
  const std::vector<Nanoseconds> found = releases(), earliest = sporadic(acts);
  ASSERT_EQ(found.size(), acts.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_GE(found[i], earliest[i]) << "no job is released before its event";
    if (i > 0) { EXPECT_GE(found[i] - found[i - 1], kPeriod); }
  }
}

TEST_P(EventsTest, ATaskWakesAnotherAtTheEndOfItsJob) {
  app.toy("beside").spend = microseconds(200);
  app.toy("beside").sends = {{Signal::kWakeup, "lamp"}, {Signal::kWakeup, "lamp"}};
  Runner runner(app.build(), GetParam());
  ASSERT_TRUE(runner.start());
  runner.run(milliseconds(9));
  EXPECT_EQ(releases(), (std::vector{microseconds(200), microseconds(3200)}));
}

TEST_P(EventsTest, EventsWaitingOrComingWhileTheTaskIsNotOnAreCountedAsLost) {
  std::vector<ScriptAct> acts(5, ring_at(milliseconds(1), lamp));
  acts.push_back({microseconds(2500), ScriptAct::Kind::kSignal, Signal::kOff, lamp});
  acts.push_back(ring_at(milliseconds(4), lamp));
  acts.push_back({milliseconds(5), ScriptAct::Kind::kSignal, Signal::kOn, lamp});
  acts.push_back(ring_at(milliseconds(5), lamp));
  Runner runner(app.build(), GetParam(), Policy::kEdf, acts);
  ASSERT_TRUE(runner.start());
  runner.run(milliseconds(9));
  EXPECT_EQ(releases(), (std::vector{milliseconds(1), milliseconds(2), milliseconds(5)}));
  EXPECT_EQ(profile().events, 6u);
  EXPECT_EQ(profile().events_lost, 4u);
  ASSERT_EQ(runner.refused().size(), 1u);
  EXPECT_EQ(runner.refused()[0].at, milliseconds(4));
}

// As an interrupt handler does, but from a job.
TEST(Events, ALineIsReadAtEachTick) {
  Application app;
  TaskSpec& spec = app.add("lamp", milliseconds(2));
  spec.aperiodic = spec.has_events = true;
  app.add("device", microseconds(700));
  InterruptLine line(TaskId(0u));
  std::uint32_t n = 0;
  app.toy("device").during = [&](const chimera_call& call) {
    if (call.now_ns == 1'400'000 || call.now_ns == 2'100'000) line.count(), line.count(), n += 2;
    return CHIMERA_OK;
  };
  InterruptLines lines({&line, 1});
  RunOptions options;
  options.events = &lines;
  VirtualExecutor executor(app.build(), options, {});
  ASSERT_TRUE(executor.start());
  executor.run(milliseconds(20));
  std::vector<Nanoseconds> releases;
  for (const Call& call : app.calls_of("lamp", Method::kCycle)) releases.push_back(call.now);
  EXPECT_EQ(releases, (std::vector{milliseconds(2), milliseconds(4), milliseconds(6), milliseconds(8)}));
  EXPECT_EQ(app.task("lamp").profile.events, n);
}

// A level, which is one event until `sync` has read it.
TEST(Events, AReadableDescriptorIsLookedAtEachTick) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  Application app;
  TaskSpec& spec = app.add("lamp", milliseconds(2));
  spec.aperiodic = spec.has_events = true;
  app.toy("lamp").descriptor = pipe[0];
  app.toy("lamp").during = [&](const chimera_call&) {
    char byte = 0;
    return ::read(pipe[0], &byte, 1) == 1 ? CHIMERA_OK : CHIMERA_FAULT;
  };
  app.add("device", microseconds(700));
  app.toy("device").during = [&](const chimera_call& call) {
    const bool writes = call.now_ns == 1'400'000;
    return !writes || ::write(pipe[1], "abc", 3) == 3 ? CHIMERA_OK : CHIMERA_FAULT;
  };
  DescriptorEvents events;
  RunOptions options;
  options.events = &events;
  VirtualExecutor executor(app.build(), options, {});
  ASSERT_TRUE(executor.start());
  executor.run(milliseconds(20));
  std::vector<Nanoseconds> releases;
  for (const Call& call : app.calls_of("lamp", Method::kCycle)) releases.push_back(call.now);
  EXPECT_EQ(releases, (std::vector{milliseconds(2), milliseconds(4), milliseconds(6)}));
  EXPECT_EQ(app.task("lamp").profile.events, 3u);
  EXPECT_EQ(app.task("lamp").faults.count, 0u);
  for (const int end : pipe) ::close(end);
}

TEST(Events, TheOldestEventWithoutAnAnswerIsKnown) {
  Application app;
  TaskSpec& spec = app.add("lamp", milliseconds(2));
  spec.aperiodic = spec.has_events = true;
  const TaskId lamp(0u);
  const std::vector acts(3, ring_at(milliseconds(1), lamp));
  VirtualClock clock;
  TwinClock twin(clock);
  RunOptions options;
  options.script = Script(acts);
  Executive executive(app.build(), clock, twin, options);
  ASSERT_TRUE(executive.start());
  const auto oldest = [&] { return executive.releases().members().events().oldest(lamp); };
  executive.run(milliseconds(1));
  EXPECT_EQ(oldest(), kNever);
  for (const std::int64_t at : {3, 5}) {
    executive.run(milliseconds(at));
    EXPECT_EQ(oldest(), milliseconds(at));
  }
  executive.run(milliseconds(6));
  EXPECT_EQ(oldest(), kNever);
}

TEST(Events, WithoutInputsATaskWithADescriptorPolls) {
  Application app;
  TaskSpec& spec = app.add("lamp", milliseconds(2));
  spec.aperiodic = spec.has_events = true;
  app.toy("lamp").descriptor = 0;
  Runner runner(app.build(), Kind::kVirtual);
  ASSERT_TRUE(runner.start());
  runner.run(milliseconds(6));
  EXPECT_EQ(app.calls_of("lamp", Method::kSync).size(), 3u);
}

TEST(Events, APreemptiveProcessorPollsATaskWithEvents) {
  Application app;
  TaskSpec& spec = app.add("lamp", milliseconds(2));
  spec.aperiodic = spec.has_events = true;
  const std::vector acts{ring_at(milliseconds(1), TaskId(0u))};
  Runner runner(app.build(), Kind::kPreemptive, Policy::kEdf, acts);
  ASSERT_TRUE(runner.start());
  runner.run(milliseconds(6));
  EXPECT_EQ(app.calls_of("lamp", Method::kSync).size(), 3u);
  EXPECT_EQ(app.task("lamp").profile.events_lost, 1u);
}

}  // namespace
}  // namespace chimera::toy::events_test
