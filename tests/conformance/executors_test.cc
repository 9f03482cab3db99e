// SPDX-License-Identifier: Apache-2.0
// Rules for every executor of one context, in real and in virtual time.
#include <gtest/gtest.h>

#include "chimera/base/hosted/wording.h"
#include "chimera/runtime/hosted/tap_rows.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

ScriptAct signal_at(std::int64_t ms, Signal signal, TaskId task) {
  return {milliseconds(ms), ScriptAct::Kind::kSignal, signal, task};
}
ScriptAct flag_at(std::int64_t ms, bool up) {
  return {milliseconds(ms), up ? ScriptAct::Kind::kRaiseFlag : ScriptAct::Kind::kLowerFlag, Signal::kOn, TaskId()};
}

// "on@0 cycle@0 cycle@10": the calls of one task with their times in ms; init and kill left out.
std::string story(const Application& app, const std::string& task) {
  std::string text;
  for (const Call& call : app.calls) {
    if (call.task != task || call.method == Method::kInit) continue;
    append_joined(text, " ", std::string(method_name(call.method)) + "@" + std::to_string(call.now.count / 1'000'000));
  }
  return text;
}

class Executors : public ::testing::TestWithParam<Kind> {
 protected:
  Application app;
  std::vector<ScriptAct> acts;
  std::unique_ptr<Runner> runner;

  RunEnd go(std::int64_t ms, const std::vector<std::string>& off = {}, Policy policy = Policy::kEdf) {
    runner = std::make_unique<Runner>(app.build(off), GetParam(), policy, acts);
    EXPECT_TRUE(runner->start());
    return runner->run(milliseconds(ms));
  }
  const Profile& profile(const std::string& task) { return app.task(task).profile; }
};

INSTANTIATE_TEST_SUITE_P(All, Executors, kEachExecutor, name_of_kind);

TEST_P(Executors, RunEveryTaskAtItsRateFromItsOffset) {
  app.add("a", milliseconds(10), microseconds(100));
  app.add("b", milliseconds(20), microseconds(100)).offset = milliseconds(5);
  EXPECT_EQ(go(40), RunEnd::kTime);
  EXPECT_EQ(story(app, "a"), "on@0 cycle@0 cycle@10 cycle@20 cycle@30");
  EXPECT_EQ(story(app, "b"), "on@0 cycle@5 cycle@25");
  EXPECT_EQ(profile("a").cycles, 4u);
  EXPECT_EQ(profile("a").execution[CHIMERA_CYCLE].sum, microseconds(400));
  EXPECT_EQ(profile("b").response.max, microseconds(100));
  for (const Call& call : app.calls_of("b", Method::kCycle)) EXPECT_EQ(call.dt, milliseconds(20));
}

TEST_P(Executors, TakeSignalsAtEdgesAndKeepThePhase) {
  app.add("a", milliseconds(10), microseconds(100));
  acts = {signal_at(12, Signal::kOff, app.id("a")), signal_at(24, Signal::kReinit, app.id("a")),
          signal_at(33, Signal::kOn, app.id("a")), signal_at(55, Signal::kKill, app.id("a")),
          signal_at(60, Signal::kSpawn, app.id("a"))};
  EXPECT_EQ(go(70), RunEnd::kNothingLeft);
  EXPECT_EQ(story(app, "a"), "on@0 cycle@0 cycle@10 off@12 reinit@24 on@33 cycle@40 cycle@50 off@55 kill@55");
  EXPECT_EQ(app.calls_of("a", Method::kInit).size(), 2u);
  EXPECT_EQ(app.calls_of("a", Method::kCycle)[2].dt, milliseconds(10));
  EXPECT_EQ(app.task("a").state, chimera::State::kOff);
}

TEST_P(Executors, GiveTheAgeOfAnOutVarAtOn) {
  app.add("a", milliseconds(10), microseconds(100));
  acts = {signal_at(12, Signal::kOff, app.id("a")), signal_at(33, Signal::kOn, app.id("a")),
          signal_at(45, Signal::kOff, app.id("a")), signal_at(45, Signal::kOn, app.id("a"))};
  go(60);
  const std::vector<Call> on = app.calls_of("a", Method::kOn), cycles = app.calls_of("a", Method::kCycle);
  ASSERT_EQ(on.size(), 3u);
  EXPECT_EQ(on[0].inherited, -1) << "no job had published it";
  EXPECT_EQ(on[1].inherited, milliseconds(21).count) << "off published it last";
  EXPECT_EQ(on[2].inherited, 0);
  ASSERT_EQ(cycles.size(), 4u);
  EXPECT_EQ(cycles[2].inherited, milliseconds(21).count) << "the age at on, in every cycle";
}

TEST_P(Executors, RefuseAnIllegalSignalAndChangeNothing) {
  app.add("a", milliseconds(10), microseconds(100));
  acts = {signal_at(12, Signal::kOn, app.id("a")), signal_at(13, Signal::kClear, app.id("a"))};
  go(30);
  EXPECT_EQ(story(app, "a"), "on@0 cycle@0 cycle@10 cycle@20");
  int refused = 0;
  for (const TapRecord& r : runner->records()) {
    if (r.kind == TapKind::kSignal) refused += r.b == 0 ? 1 : 100;
  }
  EXPECT_EQ(refused, 2);
}

TEST_P(Executors, ShowAPublicationToTheNextReaderAndNothingBefore) {
  app.add("writer", milliseconds(10), milliseconds(2)).user_priority = 1;
  app.add("reader", milliseconds(10), milliseconds(1), "writer");
  go(30);
  const auto cycles = app.calls_of("reader", Method::kCycle);
  ASSERT_EQ(cycles.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(cycles[static_cast<std::size_t>(i)].in, i + 1) << "at this release";
}

TEST_P(Executors, PublishAtCompletionSoAReaderBeforeItSeesTheOldValue) {
  app.add("writer", milliseconds(20), milliseconds(6));
  app.add("reader", milliseconds(5), milliseconds(1), "writer").offset = milliseconds(3);
  go(20, {}, Policy::kRm);
  const auto cycles = app.calls_of("reader", Method::kCycle);
  ASSERT_GE(cycles.size(), 2u);
  // Released at 3 while the writer works until 6. With preemption the job reads the old value, otherwise it runs later.
  EXPECT_EQ(cycles[0].in, GetParam() == Kind::kPreemptive ? 0 : 1);
  EXPECT_EQ(cycles[1].in, 1);
}

TEST_P(Executors, TellEveryPublicationOfATappedTaskAndNoneOfOthers) {
  app.add("a", milliseconds(10), microseconds(100));
  app.add("b", milliseconds(10), microseconds(100));
  acts = {signal_at(25, Signal::kOff, app.id("a")), signal_at(35, Signal::kOn, app.id("a"))};
  TaskSet& set = app.build();
  set.tasks()[app.id("a").index].is_tapped = true;
  runner = std::make_unique<Runner>(set, GetParam(), Policy::kEdf, acts);
  ASSERT_TRUE(runner->start());
  runner->run(milliseconds(50));
  const std::uint32_t bytes[] = {8, 8};
  TapRows rows(bytes);
  std::string text;
  for (const TapRecord& r : runner->records()) {
    const TapRow* row = rows.take(r);
    if (row == nullptr) continue;
    EXPECT_EQ(row->task, app.id("a"));
    EXPECT_EQ(row->lost, 0u);
    double value;
    std::memcpy(&value, row->payload.data(), sizeof value);
    text += std::to_string(row->number) + ":" + std::to_string(static_cast<int>(value)) + "@" +
            std::to_string(row->at.count / 100'000) + " ";
  }
  EXPECT_EQ(text, "0:0@0 1:1@1 2:2@101 3:3@201 4:3@250 5:3@350 6:4@401 ");
}

TEST_P(Executors, AskAnAperiodicTaskForAnEventAndRunNoCycleWithoutOne) {
  app.add("a", milliseconds(10)).aperiodic = true;
  app.toy("a").answers[CHIMERA_SYNC] = {CHIMERA_NO_EVENT, CHIMERA_OK, CHIMERA_NO_EVENT};
  go(40);
  EXPECT_EQ(story(app, "a"), "on@0 sync@0 sync@10 cycle@10 sync@20 sync@30 cycle@30");
  EXPECT_EQ(profile("a").cycles, 2u);
  EXPECT_EQ(app.published("a"), 2);
  EXPECT_EQ(app.calls_of("a", Method::kCycle)[1].dt, milliseconds(20));
}

TEST_P(Executors, DropAndCountReleasesAfterAnOverrunAndNeverBurst) {
  app.add("a", milliseconds(10), milliseconds(35));
  go(71);
  EXPECT_EQ(story(app, "a"), "on@0 cycle@0 cycle@30 cycle@70");
  EXPECT_EQ(app.calls_of("a", Method::kCycle)[1].dropped, 2u);
  EXPECT_EQ(app.calls_of("a", Method::kCycle)[2].dropped, 3u);
  EXPECT_EQ(profile("a").dropped, 5u);
}

TEST_P(Executors, DropReleasesThatOtherTasksNeverLetStart) {
  app.add("greedy", milliseconds(10), milliseconds(10)).user_priority = 1;
  app.add("starved", milliseconds(10), milliseconds(1));
  go(50);
  EXPECT_EQ(profile("greedy").missed, 0u);
  EXPECT_EQ(story(app, "starved"), "on@0");
  EXPECT_EQ(profile("starved").dropped, 4u);
  EXPECT_EQ(profile("starved").missed, 4u);
}

TEST_P(Executors, MakeTheFlagVisibleWithinOneCycle) {
  app.add("a", milliseconds(10), microseconds(100));
  acts = {flag_at(15, true), flag_at(35, false)};
  go(60);
  std::string seen;
  for (const Call& call : app.calls_of("a", Method::kCycle)) seen += call.illegal ? 'I' : '.';
  EXPECT_EQ(seen, "..II..");
}

TEST_P(Executors, ActOnASentSignalAfterTheSendersCycle) {
  app.add("a", milliseconds(10), milliseconds(2)).user_priority = 1;
  app.add("b", milliseconds(10), milliseconds(1));
  app.toy("a").sends = {{Signal::kOff, ""}, {Signal::kOff, "b"}, {Signal::kOn, "b"}};
  go(40);
  EXPECT_EQ(story(app, "b"), "on@0 cycle@0 off@12 on@22 cycle@30");
}

TEST_P(Executors, LetATaskTurnItselfOff) {
  app.add("a", milliseconds(10), milliseconds(2));
  app.toy("a").sends = {{Signal::kOff, ""}, {Signal::kOff, "a"}};
  EXPECT_EQ(go(1000), RunEnd::kNothingLeft);
  EXPECT_EQ(story(app, "a"), "on@0 cycle@0 cycle@10 off@12");
}

TEST_P(Executors, KeepAFaultyTaskOutAndGoOnWithTheOthers) {
  app.add("bad", milliseconds(10), microseconds(10));
  app.add("good", milliseconds(10), microseconds(10));
  app.toy("bad").answers[CHIMERA_CYCLE] = {CHIMERA_OK, CHIMERA_FAULT, CHIMERA_FAULT};
  app.toy("bad").answers[CHIMERA_ERROR] = {CHIMERA_OK, CHIMERA_FAULT};
  acts = {signal_at(45, Signal::kClear, app.id("bad")), signal_at(46, Signal::kOn, app.id("bad"))};
  go(60);
  EXPECT_EQ(story(app, "bad"), "on@0 cycle@0 cycle@10 error@10 cycle@20 error@20 clear@45 on@46 cycle@50");
  EXPECT_EQ(profile("good").cycles, 6u);
  EXPECT_EQ(app.published("bad"), 4) << "faulty cycles published nothing, the last one did";
  EXPECT_EQ(profile("bad").cycles, 2u);
}

TEST_P(Executors, PublishNothingOfACycleThatGaveUp) {
  app.add("a", milliseconds(10), microseconds(10));
  app.toy("a").answers[CHIMERA_CYCLE] = {CHIMERA_OK, CHIMERA_ABORTED, CHIMERA_ABORTED};
  go(30);
  EXPECT_EQ(app.published("a"), 1);
  EXPECT_EQ(profile("a").aborted, 2u);
  EXPECT_EQ(app.task("a").state, chimera::State::kOn);
}

TEST_P(Executors, StopOnRequest) {
  app.add("a", milliseconds(10), milliseconds(1));
  std::atomic<bool> stop{true};
  RunOptions options;
  options.stop = &stop;
  VirtualClock clock;
  TwinClock twin(clock);
  TaskSet& set = app.build();
  if (GetParam() == Kind::kExecutiveOnTwin) {
    Executive executive(set, clock, twin, options);
    ASSERT_TRUE(executive.start());
    EXPECT_EQ(executive.run(kNever), RunEnd::kStopped);
  } else {
    VirtualOptions how;
    how.preemptive = GetParam() == Kind::kPreemptive;
    VirtualExecutor executor(set, options, how);
    ASSERT_TRUE(executor.start());
    EXPECT_EQ(executor.run(kNever), RunEnd::kStopped);
  }
  EXPECT_EQ(story(app, "a"), "on@0");
}

TEST_P(Executors, EndWithOffAndKillOfEveryTask) {
  app.add("a", milliseconds(10), milliseconds(1));
  app.add("b", milliseconds(10), milliseconds(1), "a");
  go(15, {"b"});
  runner->shut_down();
  EXPECT_EQ(story(app, "a").substr(story(app, "a").find("off")).substr(0, 3), "off");
  EXPECT_EQ(app.calls_of("a", Method::kKill).size(), 1u);
  EXPECT_EQ(story(app, "b").substr(0, 4), "kill");
}

}  // namespace
}  // namespace chimera::toy
