// SPDX-License-Identifier: Apache-2.0
// The preemptive executor without real-time levels, where only the critical section excludes: its guarantees for data,
// states and counts, also under the thread sanitizer.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "chimera/base/testing/await.h"
#include "chimera/platform/clock.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"
#include "tests/conformance/runner.h"
#include "tests/conformance/toy.h"

namespace chimera::toy {
namespace {

std::size_t count(const std::vector<Call>& calls, Method method) {
  return static_cast<std::size_t>(
      std::count_if(calls.begin(), calls.end(), [&](const Call& call) { return call.method == method; }));
}

/// Runs in parts until `holds`.
template <class Holds>
void run_until(PreemptiveExecutor& executor, const Holds& holds) {
  for (Nanoseconds until; !holds();) {
    ASSERT_LT(until, kHangLimit) << "hangs";
    EXPECT_EQ(executor.run(until += milliseconds(20)), RunEnd::kTime);
  }
}

TEST(PreemptiveThreads, RunEveryReleaseOrCountItAndReadOneAnother) {
  Application app;
  app.add("fast", milliseconds(2));
  app.add("slow", milliseconds(10), {}, "fast");
  PreemptiveExecutor executor(app.build_preemptive(), {}, {});
  ASSERT_TRUE(executor.start());
  run_until(executor, [&] { return app.task("fast").profile.cycles > 50 && app.task("slow").profile.cycles > 10; });
  expect_every_release(app.own_calls("fast"), milliseconds(2));
  expect_every_release(app.own_calls("slow"), milliseconds(10));
  double last = 0;
  for (const Call& call : app.own_calls("slow")) {
    if (call.method != Method::kCycle) continue;
    EXPECT_GE(call.in, last) << "values of a producer never go back";
    last = call.in;
  }
  EXPECT_GT(last, 0);
  executor.shut_down();
  EXPECT_EQ(app.task("fast").state, chimera::State::kNotCreated);
}

TEST(PreemptiveThreads, SignalsOfTasksActAfterTheJobAndAllMethodsAreCalled) {
  Application app;
  app.add("one", milliseconds(2));
  app.add("two", milliseconds(3));
  TaskSet& set = app.build_preemptive();
  for (int i = 0; i < 5; ++i) app.toy("one").sends.push_back({Signal::kOff, ""});
  for (int i = 0; i < 5; ++i) app.toy("one").sends.push_back({Signal::kOff, "two"});
  app.toy("one").sends.push_back({Signal::kOn, "two"});
  app.toy("one").sends.push_back({Signal::kReinit, "two"});
  PreemptiveExecutor executor(set, {}, {});
  ASSERT_TRUE(executor.start());
  run_until(executor, [&] { return count(app.own_calls("two"), Method::kReinit) > 0; });
  EXPECT_EQ(app.task("two").state, chimera::State::kOn);
  EXPECT_EQ(count(app.own_calls("two"), Method::kOff), 1u);
  EXPECT_EQ(count(app.own_calls("two"), Method::kOn), 2u);
  EXPECT_EQ(count(app.own_calls("two"), Method::kReinit), 1u);
  EXPECT_EQ(executor.refused().size(), 4u) << "off in state OFF";
}

TEST(PreemptiveThreads, AFaultLeadsToErrorAndTheOthersGoOn) {
  Application app;
  app.add("bad", milliseconds(2));
  app.add("good", milliseconds(2));
  TaskSet& set = app.build_preemptive();
  app.toy("bad").answers[CHIMERA_CYCLE] = {CHIMERA_OK, CHIMERA_FAULT};
  app.toy("bad").answers[CHIMERA_ERROR] = {CHIMERA_FAULT};
  PreemptiveExecutor executor(set, {}, {});
  ASSERT_TRUE(executor.start());
  run_until(executor, [&] {
    return app.task("bad").state == chimera::State::kError && app.task("good").profile.cycles > 25;
  });
  EXPECT_EQ(app.task("bad").profile.cycles, 1u);
}

TEST(PreemptiveThreads, AJobThatSleepsIsChargedForItsComputingTime) {
  Application app;
  app.add("sleeper", milliseconds(20));
  app.toy("sleeper").during = [](const chimera_call&) {
    (void)LinuxClock().wait_until(LinuxClock().now() + milliseconds(5));
    return CHIMERA_OK;
  };
  PreemptiveExecutor executor(app.build_preemptive(), {}, {});
  ASSERT_TRUE(executor.start());
  const Profile& p = app.task("sleeper").profile;
  run_until(executor, [&] { return p.cycles > 2; });
  EXPECT_LE(p.execution[CHIMERA_CYCLE].sum, p.response.sum - milliseconds(5) * static_cast<std::int64_t>(p.cycles));
}

// Holds also for a job that is alone: the executor does not check such a job before its end.
TEST(PreemptiveThreads, EveryJobOverItsBudgetIsRecordedOnce) {
  Application app;
  app.add("over", milliseconds(10), milliseconds(2)).budget = milliseconds(1);
  app.add("within", milliseconds(20)).budget = kHangLimit;
  Listened listened;
  RunOptions options;
  options.tap = listened.tap();
  PreemptiveExecutor executor(app.build_preemptive(), options, {});
  ASSERT_TRUE(executor.start());
  run_until(executor, [&] { return app.task("over").profile.overrun > 5 && app.task("within").profile.cycles > 2; });
  std::uint64_t over = 0, within = 0;
  for (const TapRecord& record : listened.records()) {
    if (record.kind != TapKind::kOverrun) continue;
    ++(record.task == app.task("over").id ? over : within);
  }
  EXPECT_EQ(over, app.task("over").profile.overrun);
  EXPECT_EQ(within, 0u);
}

TEST(PreemptiveThreads, EndWhenNothingIsLeft) {
  Application app;
  app.add("a", milliseconds(2));
  TaskSet& set = app.build_preemptive();
  app.toy("a").sends = {{Signal::kOff, ""}, {Signal::kOff, "a"}};
  PreemptiveExecutor executor(set, {}, {});
  ASSERT_TRUE(executor.start());
  EXPECT_EQ(executor.run(kNever), RunEnd::kNothingLeft);
  EXPECT_GE(app.task("a").profile.cycles, 2u);
  EXPECT_EQ(count(app.own_calls("a"), Method::kOff), 1u);
  EXPECT_EQ(app.own_calls("a").back().method, Method::kOff) << "no job after it";
}

TEST(PreemptiveThreads, AServerAnswersEveryRingAndHaltsJobsThatAreLongerThanItsCapacity) {
  Application app;
  app.add("sender", milliseconds(4));
  TaskSpec& spec = app.add("served", milliseconds(10));
  spec.aperiodic = true;
  spec.server = ServerSpec{ServerKind::kSporadic, milliseconds(2), milliseconds(10)};
  for (int i = 0; i < 10; ++i) app.toy("sender").sends.push_back({Signal::kWakeup, "served"});
  app.toy("served").during = [n = 0](const chimera_call& call) mutable {
    if (++n % 2 == 0) call.host->spend(call.context, milliseconds(20).count);  // five times: one halt is seen
    return CHIMERA_OK;
  };
  PreemptiveExecutor executor(app.build_preemptive(), {}, {});
  ASSERT_TRUE(executor.start());
  const Profile& p = app.task("served").profile;
  run_until(executor, [&] { return p.cycles >= 10; });
  EXPECT_EQ(p.cycles, 10u);
  EXPECT_EQ(p.events, 10u);
  EXPECT_EQ(p.events_lost, 0u);
  EXPECT_GE(p.exhausted, 1u);
  executor.shut_down();
}

TEST(PreemptiveThreads, EventsOfATaskThatIsNotOnAreLostAndCounted) {
  Application app;
  app.add("sender", milliseconds(2));
  TaskSpec& spec = app.add("served", milliseconds(50));
  spec.aperiodic = true;
  spec.server = ServerSpec{ServerKind::kDeferrable, milliseconds(1), milliseconds(50)};
  TaskSet& set = app.build_preemptive({"served"});
  auto& sends = app.toy("sender").sends;
  for (int i = 0; i < 3; ++i) sends.push_back({Signal::kWakeup, "served"});
  sends.push_back({Signal::kOn, "served"});
  PreemptiveExecutor executor(set, {}, {});
  ASSERT_TRUE(executor.start());
  const Profile& p = app.task("served").profile;
  run_until(executor, [&] { return app.task("served").state == chimera::State::kOn; });
  EXPECT_EQ(p.events_lost, 3u) << "those before `on`";
  for (int i = 0; i < 12; ++i) sends.push_back({Signal::kWakeup, "served"});  // an outbox takes 16
  run_until(executor, [&] { return p.events >= 12 && p.cycles >= p.events; });
  EXPECT_EQ(p.events, 12u);
  EXPECT_EQ(p.events_lost, 3u);
  EXPECT_EQ(p.cycles, p.events);
}

struct Pipe {
  Pipe() { EXPECT_EQ(::pipe2(ends, O_NONBLOCK | O_CLOEXEC), 0); }
  ~Pipe() {
    ::close(ends[0]);
    ::close(ends[1]);
  }
  void write(std::size_t bytes) const { EXPECT_EQ(::write(ends[1], "0123456789", bytes), static_cast<long>(bytes)); }
  int ends[2]{};
};

TEST(PreemptiveThreads, AServerAnswersADescriptorForAsLongAsItIsReadable) {
  const Pipe pipe;
  Application app;
  app.add("other", milliseconds(10));
  TaskSpec& spec = app.add("served", milliseconds(20));
  spec.aperiodic = true;
  spec.server = ServerSpec{ServerKind::kDeferrable, milliseconds(10), milliseconds(20)};
  TaskSet& set = app.build_preemptive();
  Task& task = set.tasks()[app.id("served").index];
  app.toy("served").descriptor = pipe.ends[0];
  app.toy("served").during = [&pipe](const chimera_call&) {
    char byte = 0;
    return ::read(pipe.ends[0], &byte, 1) == 1 ? CHIMERA_OK : CHIMERA_FAULT;
  };
  PreemptiveExecutor executor(set, {}, {});
  ASSERT_TRUE(executor.start());
  std::thread writer([&] {
    LinuxClock().wait_until(LinuxClock().now() + milliseconds(20));
    pipe.write(3);
    LinuxClock().wait_until(LinuxClock().now() + milliseconds(20));
    pipe.write(4);
  });
  run_until(executor, [&] { return task.profile.cycles >= 7; });
  writer.join();
  EXPECT_EQ(task.profile.cycles, 7u);
  EXPECT_EQ(task.profile.events, 7u);
  EXPECT_EQ(task.faults.count, 0u);
  executor.shut_down();
  EXPECT_EQ(task.descriptor, -1) << "kill ends it";
}

}  // namespace
}  // namespace chimera::toy
