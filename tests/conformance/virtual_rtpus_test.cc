// SPDX-License-Identifier: Apache-2.0
// Several rtpus in virtual time: the instants at which tasks see values of other rtpus, and the effects of a death.
#include <gtest/gtest.h>

#include "tests/conformance/rtpus_run.h"

namespace chimera::toy {
namespace {

constexpr RtpuId kFirst{0u}, kSecond{1u};

ScriptAct of_kind(Nanoseconds at, ScriptAct::Kind kind) {
  ScriptAct act;
  act.at = at;
  act.kind = kind;
  return act;
}

ScriptAct signal_at(Nanoseconds at, Signal signal, TaskId task) {
  ScriptAct act = of_kind(at, ScriptAct::Kind::kSignal);
  act.signal = signal;
  act.task = task;
  return act;
}

ScriptAct death_at(Nanoseconds at, RtpuId rtpu) {
  ScriptAct act = of_kind(at, ScriptAct::Kind::kDie);
  act.rtpu = rtpu;
  return act;
}

/// Two rtpus, "first" and "second".
struct VirtualRtpusTest : ::testing::Test {
  VirtualRtpusTest() { renew(false); }
  void renew(bool is_first_preemptive) {
    run.reset();
    app = Application();
    app.place_on({{"first", 0, Policy::kEdf, is_first_preemptive}, {"second", 1, Policy::kEdf}});
  }
  TaskSpec& add(const std::string& name, RtpuId rtpu, Nanoseconds period, Nanoseconds spend = {},
                const std::string& reads = "") {
    TaskSpec& spec = app.add(name, period, spend, reads);
    spec.rtpu = rtpu;
    return spec;
  }
  RtpusRun& start(std::vector<ScriptAct> acts = {}, const std::vector<std::string>& off = {}) {
    script = std::move(acts);
    peers = &app.build_rtpus(off);
    run = std::make_unique<RtpusRun>(*peers, script);
    EXPECT_TRUE(run->start());
    return *run;
  }
  chimera::State state(const std::string& name) { return peers->state(app.id(name)); }
  /// Value that the task read in the cycle of this release.
  double read_at(const std::string& name, Nanoseconds release) {
    for (const Call& call : app.calls_of(name, Method::kCycle))
      if (call.now == release) return call.in;
    ADD_FAILURE() << name << " had no cycle at " << release.count;
    return -1;
  }
  bool is_illegal_at(const std::string& name, Nanoseconds release) {
    for (const Call& call : app.calls_of(name, Method::kCycle))
      if (call.now == release) return call.illegal;
    ADD_FAILURE() << name << " had no cycle at " << release.count;
    return false;
  }
  std::vector<std::string> records_of(TapKind kind) {
    std::vector<std::string> found;
    for (const TapRecord& r : run->records())
      if (r.kind == kind) found.push_back("rtpu " + std::to_string(r.rtpu) + " at " + std::to_string(r.at.count) + " " +
                                          std::to_string(r.a));
    return found;
  }

  Application app;
  std::vector<ScriptAct> script;
  VirtualPeers* peers = nullptr;
  std::unique_ptr<RtpusRun> run;
};

TEST_F(VirtualRtpusTest, AJobReadsAtItsStartTheLatestPublications) {
  for (const bool preemptive : {false, true}) {
    SCOPED_TRACE(preemptive ? "preemptive" : "executive");
    renew(preemptive);
    add("slow", kFirst, milliseconds(10), milliseconds(4));
    add("fast", kSecond, milliseconds(1), {}, "slow");
    start().run(milliseconds(20));
    EXPECT_EQ(read_at("fast", milliseconds(3)), 0) << "the job of slow ends at 4 ms";
    EXPECT_EQ(read_at("fast", milliseconds(4)), 1) << "ends come before starts";
    EXPECT_EQ(read_at("fast", milliseconds(13)), 1);
    EXPECT_EQ(read_at("fast", milliseconds(14)), 2);
  }
}

TEST_F(VirtualRtpusTest, JobsThatNeedNoTimeDoNotSeeEachOtherAtOneInstant) {
  for (const bool preemptive : {false, true}) {
    SCOPED_TRACE(preemptive ? "preemptive" : "executive");
    renew(preemptive);
    add("a", kFirst, milliseconds(1), {}, "b");
    add("b", kSecond, milliseconds(1), {}, "a");
    start().run(milliseconds(5));
    for (const char* name : {"a", "b"})
      for (int ms = 0; ms < 5; ++ms) EXPECT_EQ(read_at(name, milliseconds(ms)), ms) << name;
  }
}

TEST_F(VirtualRtpusTest, ProcessorsRunBesideEachOther) {
  add("a", kFirst, milliseconds(2), microseconds(1500));
  add("b", kSecond, milliseconds(2), microseconds(1500));
  start().run(milliseconds(20));
  EXPECT_EQ(app.task("a").profile.cycles, 10u);
  EXPECT_EQ(app.task("b").profile.cycles, 10u);
  EXPECT_EQ(app.task("a").profile.missed + app.task("b").profile.missed, 0u) << "one processor could not do both";
}

TEST_F(VirtualRtpusTest, ASignalIsCarriedOutOnTheOtherRtpuWhenTheSenderEnds) {
  add("a", kFirst, milliseconds(10), milliseconds(2));
  add("b", kSecond, milliseconds(1));
  app.toy("a").sends = {{Signal::kOff, "b"}, {Signal::kOn, "b"}};
  start().run(milliseconds(20));
  EXPECT_EQ(app.calls_of("b", Method::kOff).front().now, milliseconds(2));
  EXPECT_EQ(app.calls_of("b", Method::kOn).back().now, milliseconds(12));
  EXPECT_EQ(app.task("b").profile.cycles, 2u + 8u);
  EXPECT_EQ(state("b"), chimera::State::kOn);
}

TEST_F(VirtualRtpusTest, OnIsJudgedOverAllRtpus) {
  add("producer", kFirst, milliseconds(1));
  add("consumer", kSecond, milliseconds(1), {}, "producer");
  const TaskId producer(0u), consumer(1u);
  start({signal_at(milliseconds(2), Signal::kOn, consumer), signal_at(milliseconds(3), Signal::kOn, producer),
         signal_at(milliseconds(3), Signal::kOn, consumer)},
        {"producer", "consumer"})
      .run(milliseconds(5));
  EXPECT_EQ(state("consumer"), chimera::State::kOn) << "acts of one instant come in the order of the script";
  ASSERT_EQ(run->refused().size(), 1u);
  EXPECT_EQ(run->refused()[0].why, Refusal::kIllegalSet);
  EXPECT_EQ(run->refused()[0].at, milliseconds(2));
}

TEST_F(VirtualRtpusTest, TheFlagFollowsFromTheTasksThatAreOnOverAllRtpus) {
  add("producer", kFirst, milliseconds(1));
  add("consumer", kSecond, milliseconds(1), {}, "producer");
  const TaskId producer(0u);
  start({signal_at(microseconds(2500), Signal::kOff, producer), signal_at(microseconds(4500), Signal::kOn, producer)})
      .run(milliseconds(7));
  for (int ms = 0; ms < 7; ++ms) EXPECT_EQ(is_illegal_at("consumer", milliseconds(ms)), ms == 3 || ms == 4) << ms;
  EXPECT_FALSE(peers->is_flag_up());
  const std::vector<std::string> both = {"rtpu 0 at 2500000 1", "rtpu 1 at 2500000 1", "rtpu 0 at 4500000 0",
                                         "rtpu 1 at 4500000 0"};
  EXPECT_EQ(records_of(TapKind::kFlag), both);
}

TEST_F(VirtualRtpusTest, TheOperatorRaisesTheFlagOfAll) {
  add("a", kFirst, milliseconds(1));
  add("b", kSecond, milliseconds(1));
  app.spec("a").on_overrun = OnMiss::kFlag;
  app.spec("a").budget = microseconds(100);
  app.toy("a").during = [](const chimera_call& call) {
    if (call.cycle == 4) call.host->spend(call.context, 200'000);
    return CHIMERA_OK;
  };
  start({of_kind(microseconds(1500), ScriptAct::Kind::kRaiseFlag),
         of_kind(microseconds(2500), ScriptAct::Kind::kLowerFlag),
         of_kind(microseconds(5500), ScriptAct::Kind::kLowerFlag)})
      .run(milliseconds(7));
  for (int ms = 0; ms < 7; ++ms) {
    const bool up = ms == 2 || ms == 5;
    EXPECT_EQ(is_illegal_at("b", milliseconds(ms)), up) << ms;
    EXPECT_EQ(is_illegal_at("a", milliseconds(ms)), up) << ms;
  }
}

TEST_F(VirtualRtpusTest, ATaskThatStopsItsRtpuStopsNoOther) {
  add("a", kFirst, milliseconds(1));
  add("a2", kFirst, milliseconds(1));
  add("b", kSecond, milliseconds(1));
  app.spec("a").on_overrun = OnMiss::kStop;
  app.spec("a").budget = microseconds(100);
  app.toy("a").during = [](const chimera_call& call) {
    if (call.cycle == 3) call.host->spend(call.context, 200'000);
    return CHIMERA_OK;
  };
  EXPECT_EQ(start().run(milliseconds(10)), RunEnd::kTime);
  EXPECT_EQ(state("a"), chimera::State::kOff);
  EXPECT_EQ(state("a2"), chimera::State::kOff);
  EXPECT_EQ(state("b"), chimera::State::kOn);
  EXPECT_EQ(app.task("b").profile.cycles, 10u);
}

TEST_F(VirtualRtpusTest, TheLastValuesOfADeadRtpuStayAndItsTasksAreInError) {
  for (const bool preemptive : {false, true}) {
    SCOPED_TRACE(preemptive ? "preemptive" : "executive");
    renew(preemptive);
    add("producer", kFirst, milliseconds(2), milliseconds(1));
    add("consumer", kSecond, milliseconds(1), {}, "producer");
    start({death_at(microseconds(4500), kFirst), signal_at(milliseconds(6), Signal::kOff, TaskId(0u))})
        .run(milliseconds(8));
    EXPECT_EQ(state("producer"), chimera::State::kError);
    EXPECT_EQ(app.task("producer").profile.cycles, 2u) << "the third job was under way";
    EXPECT_EQ(read_at("consumer", milliseconds(7)), 2);
    EXPECT_FALSE(is_illegal_at("consumer", milliseconds(4)));
    EXPECT_TRUE(is_illegal_at("consumer", milliseconds(5)));
    EXPECT_TRUE(peers->is_flag_up());
    ASSERT_EQ(run->refused().size(), 1u);
    EXPECT_EQ(run->refused()[0].state, chimera::State::kError);
    const auto states = records_of(TapKind::kState);
    EXPECT_EQ(states.back(), "rtpu 0 at 4500000 " + std::to_string(static_cast<int>(chimera::State::kError)));
    run->shut_down();
    EXPECT_TRUE(app.calls_of("producer", Method::kOff).empty()) << "its rtpu is dead";
    EXPECT_EQ(app.calls_of("consumer", Method::kOff).size(), 1u);
  }
}

TEST_F(VirtualRtpusTest, ADeathComesBeforeTheSignalsOfItsInstantAndAfterTheEndsOfJobs) {
  add("producer", kFirst, milliseconds(4), milliseconds(1));
  add("consumer", kSecond, milliseconds(1), {}, "producer");
  start({death_at(milliseconds(1), kFirst)}).run(milliseconds(4));
  EXPECT_EQ(app.task("producer").profile.cycles, 1u);
  EXPECT_EQ(read_at("consumer", milliseconds(1)), 1);
  EXPECT_TRUE(is_illegal_at("consumer", milliseconds(1)));
}

TEST_F(VirtualRtpusTest, AProducerThatIsSpawnedAnewIsReadAgain) {
  add("producer", kFirst, milliseconds(1));
  add("consumer", kSecond, milliseconds(1), {}, "producer");
  const TaskId producer(0u);
  start({signal_at(microseconds(2500), Signal::kOff, producer), signal_at(microseconds(2600), Signal::kKill, producer),
         signal_at(microseconds(4500), Signal::kSpawn, producer), signal_at(microseconds(4600), Signal::kOn, producer)})
      .run(milliseconds(8));
  EXPECT_EQ(read_at("consumer", milliseconds(4)), 3) << "the last value stands";
  EXPECT_EQ(read_at("consumer", milliseconds(7)), 5) << "two more by 6 ms";
}

TEST_F(VirtualRtpusTest, OtherRtpusSeeAJobThatCannotStartAtItsInstant) {
  add("consumer", kFirst, milliseconds(1), {}, "late");
  add("blocker", kSecond, milliseconds(5), milliseconds(3));
  TaskSpec& late = add("late", kSecond, milliseconds(5));
  late.deadline = milliseconds(4);
  late.min_time = milliseconds(2);
  late.on_miss = OnMiss::kError;
  late.criticality = 0;
  app.toy("late").answers[CHIMERA_ERROR] = {CHIMERA_FAULT};
  app.spec("blocker").deadline = milliseconds(3);
  start().run(milliseconds(5));
  EXPECT_EQ(state("late"), chimera::State::kError);
  const auto flags = records_of(TapKind::kFlag);
  ASSERT_FALSE(flags.empty());
  EXPECT_EQ(flags[0], "rtpu 0 at 3000000 1");
}

TEST_F(VirtualRtpusTest, EndsWhenNothingIsLeftOnAnyRtpu) {
  add("a", kFirst, milliseconds(1));
  add("b", kSecond, milliseconds(1));
  start({signal_at(milliseconds(2), Signal::kOff, TaskId(0u)), signal_at(milliseconds(4), Signal::kOff, TaskId(1u))});
  EXPECT_EQ(run->run(milliseconds(10)), RunEnd::kNothingLeft);
  EXPECT_EQ(run->now(), milliseconds(4));
}

TEST_F(VirtualRtpusTest, AJobUnderWayAtTheEndIsFinishedByAnExecutiveAndCutByAPreemptiveProcessor) {
  renew(true);
  add("cut", kFirst, milliseconds(10), milliseconds(4));
  add("finished", kSecond, milliseconds(10), milliseconds(4));
  EXPECT_EQ(start().run(milliseconds(2)), RunEnd::kTime);
  EXPECT_EQ(app.task("cut").profile.cycles, 0u);
  EXPECT_EQ(app.task("finished").profile.cycles, 1u);
  EXPECT_EQ(run->now(), milliseconds(4));
}

TEST_F(VirtualRtpusTest, AnIllegalStartIsRefusedAndAFailedOneIsTakenBack) {
  add("producer", kFirst, milliseconds(1));
  add("consumer", kSecond, milliseconds(1), {}, "producer");
  peers = &app.build_rtpus({"producer"});
  EXPECT_FALSE(RtpusRun(*peers, {}).start());

  renew(false);
  add("producer", kFirst, milliseconds(1));
  add("consumer", kSecond, milliseconds(1), {}, "producer");
  app.toy("consumer").answers[CHIMERA_ON] = {CHIMERA_FAULT};
  app.toy("consumer").answers[CHIMERA_ERROR] = {CHIMERA_FAULT};
  peers = &app.build_rtpus();
  const auto refused = RtpusRun(*peers, {}).start();
  ASSERT_FALSE(refused);
  EXPECT_EQ(state("producer"), chimera::State::kOff);
  EXPECT_NE(refused.error().message.view().find("consumer"), std::string_view::npos);
}

}  // namespace
}  // namespace chimera::toy
