// SPDX-License-Identifier: Apache-2.0
// Events and servers, exact in virtual time. The examples are those of Buttazzo, Hard Real-Time Computing Systems: the
// deferrable server of 5.3, both sporadic servers of 5.5, the dynamic sporadic server of chapter 6 (Spuri & Buttazzo
// 1996). Where the book leaves periodic tasks or requests open they are stated here, and the schedule is worked out by
// hand from the definition of the server.
#include <gtest/gtest.h>

#include <deque>
#include <memory>

#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

struct Periodic {
  char name;
  int work, period;
  std::uint32_t criticality = 0;
};

struct Request {
  int at, work;
};

/// Two periodic tasks and the server S with its requests.
struct Example {
  Policy policy;
  Periodic periodic[2];
  ServerKind kind;
  int capacity, period;
  std::uint32_t criticality;
  std::vector<Request> requests;
  std::string timeline;
};

// The deferrable server's own period is its deadline, the sporadic one's is its replenishment.
constexpr ServerKind kDeferrable = ServerKind::kDeferrable, kSporadic = ServerKind::kSporadic;
const std::vector<Request> kFour = {{2, 2}, {8, 1}, {12, 2}, {19, 1}};
const Example kExamples[] = {
    // 5.3: the request at 2 is served at once and at 4 only the task of period 4 goes before the server.
    {Policy::kRm, {{'A', 1, 4}, {'B', 2, 6}}, kDeferrable, 2, 5, 0, kFour, "ABSSABBBAS..ASSBABBSAB.."},
    {Policy::kEdf, {{'A', 1, 4}, {'B', 2, 6}}, kDeferrable, 2, 5, 0, kFour, "ABSSBABBSA..SSABBABSAB.."},
    {Policy::kMuf, {{'A', 1, 4}, {'B', 2, 6}}, kDeferrable, 2, 5, 0, kFour, "ABSSBABBSA..SSABBABSAB.."},
    // 5.5, medium priority.
    {Policy::kRm, {{'A', 1, 5}, {'B', 4, 15}}, kSporadic, 5, 10, 0, {{4, 2}, {8, 2}}, "ABBBSASBSSA....ABBBBA..."},
    // 5.5, highest priority: the request at 6 waits for what the one at 2 has used.
    {Policy::kRm, {{'A', 3, 10}, {'B', 4, 15}}, kSporadic, 2, 8, 0, {{2, 2}, {6, 2}}, "AASSABBBB.SSAAABBBB.AAA."},
    // Dynamic: due at 9 by the request at 3, at 12 by that at 6, and at 15 by what comes back at 9.
    {Policy::kEdf, {{'A', 2, 8}, {'B', 3, 12}}, kSporadic, 3, 6, 0, {{3, 2}, {6, 2}}, "AABSSBBSASA.BBB.AA......"},
    // The example under maximum urgency: A is more critical than the server, B less.
    {Policy::kMuf, {{'A', 2, 8, 2}, {'B', 3, 12, 0}}, kSporadic, 3, 6, 1, {{3, 2}, {6, 2}},
     "AABSSBSBAAS.BBB.AA......"},
};

constexpr std::size_t kExampleUnits = 24;

ScriptAct ring(int at, TaskId task) {
  return {milliseconds(at), ScriptAct::Kind::kSignal, Signal::kWakeup, task};
}

TaskSpec& add_served(Application& app, const char* name, ServerKind kind, int capacity, int period) {
  TaskSpec& spec = app.add(name, milliseconds(period));
  spec.aperiodic = true;
  spec.server = ServerSpec{kind, milliseconds(capacity), milliseconds(period)};
  return spec;
}

/// Every cycle of the task takes the next of `works`.
void take_in_turn(Toy& toy, std::deque<Nanoseconds> works) {
  auto left = std::make_shared<std::deque<Nanoseconds>>(std::move(works));
  toy.during = [left](const chimera_call& call) {
    call.host->spend(call.context, left->front().count);
    left->pop_front();
    return CHIMERA_OK;
  };
}

/// The tasks of `example`, a millisecond for each unit. Returns the rings.
std::vector<ScriptAct> add_example(Application& app, const Example& example) {
  for (const Periodic& p : example.periodic)
    app.add(std::string(1, p.name), milliseconds(p.period), milliseconds(p.work)).criticality = p.criticality;
  add_served(app, "S", example.kind, example.capacity, example.period).criticality = example.criticality;
  std::vector<ScriptAct> acts;
  std::deque<Nanoseconds> works;
  for (const Request& request : example.requests) {
    acts.push_back(ring(request.at, app.id("S")));
    works.push_back(milliseconds(request.work));
  }
  take_in_turn(app.toy("S"), works);
  return acts;
}

/// Task that had each millisecond: a letter of `names`, '.' if none.
std::string timeline(const std::vector<TapRecord>& records, const std::string& names, std::size_t length) {
  std::string line(length, '.');
  for (const TapRecord& r : records) {
    if (r.kind != TapKind::kRun) continue;
    EXPECT_TRUE(r.at.count % 1'000'000 == 0 && r.b % 1'000'000 == 0);
    for (std::int64_t t = r.at.count; t < r.at.count + r.b; t += 1'000'000)
      if (const auto at = static_cast<std::size_t>(t / 1'000'000); at < length) line[at] = names[r.task.index];
  }
  return line;
}

TEST(Servers, TheTextbookExamplesComeOutToTheLetter) {
  for (const Example& example : kExamples) {
    Application app;
    const std::vector<ScriptAct> acts = add_example(app, example);
    Runner run(app.build(), Kind::kPreemptive, example.policy, acts);
    ASSERT_TRUE(run.start());
    EXPECT_EQ(run.run(milliseconds(24)), RunEnd::kTime);
    const std::vector<TapRecord> records = run.records();
    EXPECT_EQ(timeline(records, "ABS", kExampleUnits), example.timeline);
    EXPECT_EQ(app.task("S").profile.cycles, example.requests.size());
    EXPECT_EQ(app.task("S").profile.events, example.requests.size());
    EXPECT_EQ(app.task("S").profile.missed + app.task("S").profile.dropped + app.task("S").profile.events_lost, 0u);
  }
}

TEST(Servers, AJobLongerThanTheCapacityContinuesWhenCapacityReturns) {
  for (const ServerKind kind : {kDeferrable, kSporadic}) {
    Application app;
    add_served(app, "S", kind, 2, 5);
    take_in_turn(app.toy("S"), {milliseconds(5)});
    const std::vector<ScriptAct> acts = {ring(3, app.id("S"))};
    Runner run(app.build(), Kind::kPreemptive, Policy::kEdf, acts);
    ASSERT_TRUE(run.start());
    run.run(milliseconds(16));
    EXPECT_EQ(timeline(run.records(), "S", 16), kind == kDeferrable ? "...SSSS...S....." : "...SS...SS...S..");
    EXPECT_EQ(app.task("S").profile.response.max, milliseconds(kind == kDeferrable ? 8 : 11));
    EXPECT_EQ(app.task("S").profile.exhausted, kind == kDeferrable ? 1u : 2u);
  }
}

TEST(Servers, EveryRingOfAnotherTaskIsAnsweredByOneJob) {
  Application app;
  app.add("A", milliseconds(4), milliseconds(1));
  app.add("B", milliseconds(4), milliseconds(1));
  add_served(app, "S", kDeferrable, 1, 6);
  for (const char* name : {"A", "B"})
    for (int i = 0; i < 3; ++i) app.toy(name).sends.emplace_back(Signal::kWakeup, "S");
  app.toy("S").spend = milliseconds(1);
  Runner run(app.build(), Kind::kPreemptive, Policy::kRm);
  ASSERT_TRUE(run.start());
  run.run(milliseconds(12));
  EXPECT_EQ(timeline(run.records(), "ABS", 12), "ABS.ABS.AB..");
  EXPECT_EQ(app.task("S").events, 3u);
  run.run(milliseconds(48));
  EXPECT_EQ(app.task("S").profile.cycles, 6u);
  EXPECT_EQ(app.task("S").events, 0u);
}

TEST(Servers, RefusesARingForATaskWithoutAServer) {
  Application app;
  app.add("A", milliseconds(4), milliseconds(1));
  add_served(app, "S", kDeferrable, 1, 6);
  std::vector<int> answers;
  app.toy("A").during = [&answers](const chimera_call& call) {
    for (const char* target : {"A", "S", "absent"})
      answers.push_back(call.host->signal(call.context, CHIMERA_SIGNAL_WAKEUP, target));
    return CHIMERA_OK;
  };
  const std::vector<ScriptAct> acts = {ring(2, app.id("S")), ring(3, app.id("A"))};
  Runner run(app.build({"S"}), Kind::kPreemptive, Policy::kRm, acts);
  ASSERT_TRUE(run.start());
  run.run(milliseconds(4));
  EXPECT_EQ(answers, (std::vector<int>{CHIMERA_FAULT, CHIMERA_OK, CHIMERA_FAULT}));
  EXPECT_EQ(app.task("S").events, 0u);  // OFF
  std::vector<int> accepted;
  for (const TapRecord& r : run.records())
    if (r.kind == TapKind::kSignal && r.a == CHIMERA_SIGNAL_WAKEUP) accepted.push_back(static_cast<int>(r.b));
  EXPECT_EQ(accepted, (std::vector<int>{0, 0}));
}

TEST(Servers, AnEventWithoutAnythingBehindItCostsNoCycle) {
  Application app;
  add_served(app, "S", kSporadic, 2, 6).budget = milliseconds(1);
  app.toy("S").answers[CHIMERA_SYNC] = {CHIMERA_NO_EVENT, CHIMERA_OK};
  const std::vector<ScriptAct> acts = {ring(1, app.id("S")), ring(1, app.id("S"))};
  Runner run(app.build(), Kind::kPreemptive, Policy::kEdf, acts);
  ASSERT_TRUE(run.start());
  run.run(milliseconds(6));
  EXPECT_EQ(timeline(run.records(), "S", 6), ".S....");
  EXPECT_EQ(app.task("S").profile.cycles, 1u);
}

TEST(Servers, EventsThatWaitAreDroppedWhenTheTaskGoesOff) {
  Application app;
  add_served(app, "S", kDeferrable, 1, 6);
  app.toy("S").spend = milliseconds(1);
  const TaskId s = app.id("S");
  const std::vector<ScriptAct> acts = {ring(0, s), ring(0, s), ring(0, s),
                                       {milliseconds(3), ScriptAct::Kind::kSignal, Signal::kOff, s},
                                       {milliseconds(4), ScriptAct::Kind::kSignal, Signal::kOn, s},
                                       ring(9, s)};
  Runner run(app.build(), Kind::kPreemptive, Policy::kEdf, acts);
  ASSERT_TRUE(run.start());
  run.run(milliseconds(12));
  EXPECT_EQ(timeline(run.records(), "S", 12), "S........S..");
  EXPECT_EQ(app.task("S").profile.events, 4u);
  EXPECT_EQ(app.task("S").profile.events_lost, 2u);
}

/// Another rtpu that has no room for a post.
struct Deaf final : PeerView {
  PeerPresence presence(TaskId) const noexcept override { return {true, true, true}; }
  chimera::State state(TaskId) const noexcept override { return chimera::State::kOn; }
  GroupReader outputs(TaskId) const noexcept override { return {}; }
  GroupReader constants(TaskId) const noexcept override { return {}; }
  GroupReader operator_variable(std::size_t) const noexcept override { return {}; }
  bool post(Signal, TaskId, TaskId, bool) noexcept override {
    ++posts;
    return posts % 2 == 0;
  }
  int posts = 0;
};

TEST(Servers, ARingThatFindsNoRoomOnItsWayIsLostAndCounted) {
  Application app;
  app.add("A", milliseconds(4));
  add_served(app, "S", kDeferrable, 1, 6).rtpu = RtpuId(1u);
  Deaf others;
  ContextPlace place;
  place.rtpu = RtpuId(0u);
  place.others = &others;
  TaskSet& set = app.build({}, place);
  Task& a = set.tasks()[0];
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(a.outbox.try_push({Signal::kWakeup, app.id("S")}));
  EXPECT_TRUE(a.outbox.try_push({Signal::kReinit, app.id("S")}));
  set.sent().deliver(a);
  EXPECT_EQ(others.posts, 6);
  EXPECT_EQ(app.task("A").profile.events_lost, 3u);
}

// Three tasks at 47 % and, above them, a server of 1 ms in 8 ms that gets eight times the work of its capacity.
TEST(Servers, StormOfEventsCostsTheOthersNoDeadline) {
  for (const Policy policy : {Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity}) {
    for (const ServerKind kind : {kDeferrable, kSporadic}) {
      Application app;
      app.add("a", milliseconds(10), milliseconds(2));
      app.add("b", milliseconds(12), milliseconds(2));
      app.add("c", milliseconds(20), milliseconds(2));
      app.add("sender", milliseconds(3)).criticality = 2;
      add_served(app, "S", kind, 1, 8).criticality = 2;
      app.toy("S").spend = microseconds(200);
      app.toy("sender").during = [](const chimera_call& call) {
        for (int i = 0; i < 16; ++i) EXPECT_EQ(call.host->signal(call.context, CHIMERA_SIGNAL_WAKEUP, "S"), CHIMERA_OK);
        return CHIMERA_OK;
      };
      Runner run(app.build(), Kind::kPreemptive, policy);
      ASSERT_TRUE(run.start());
      run.run(milliseconds(400));
      for (const char* name : {"a", "b", "c", "sender"})
        EXPECT_EQ(app.task(name).profile.missed + app.task(name).profile.dropped, 0u) << name;
      const Profile& served = app.task("S").profile;
      EXPECT_EQ(served.events, 134u * 16u) << "every one is counted";
      EXPECT_LE(served.execution[CHIMERA_CYCLE].sum, milliseconds(1) * (400 / 8 + 1));
      EXPECT_GT(served.cycles, 2u * (400 / 8 + 1));
    }
  }
}

}  // namespace
}  // namespace chimera::toy
