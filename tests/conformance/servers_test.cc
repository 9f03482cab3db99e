// SPDX-License-Identifier: Apache-2.0
// What events and servers promise, exact in virtual time.
#include <gtest/gtest.h>

#include "tests/conformance/server_examples.h"

namespace chimera::toy {
namespace {

ScriptAct ring(int at, TaskId task) { return toy::ring(milliseconds(at), task); }

std::string timeline(const std::vector<TapRecord>& records, const std::string& names, std::size_t length) {
  return toy::timeline(records, {}, milliseconds(1), names, length);
}

TaskSpec& add_served(Application& app, const char* name, ServerKind kind, int capacity, int period) {
  return toy::add_served(app, name, kind, milliseconds(capacity), milliseconds(period));
}

TEST(Servers, TheTextbookExamplesComeOutToTheLetter) {
  for (const Example& example : kExamples) {
    Application app;
    const std::vector<ScriptAct> acts = add_example(app, example, milliseconds(1), 1);
    Runner run(app.build(), Kind::kPreemptive, example.policy, acts);
    ASSERT_TRUE(run.start());
    EXPECT_EQ(run.run(milliseconds(24)), RunEnd::kTime);
    const std::vector<TapRecord> records = run.records();
    for (const TapRecord& r : records)
      EXPECT_TRUE(r.kind != TapKind::kRun || (r.at.count % 1'000'000 == 0 && r.b % 1'000'000 == 0));
    EXPECT_EQ(timeline(records, "ABS", kExampleUnits), example.timeline);
    EXPECT_EQ(app.task("S").profile.cycles, example.requests.size());
    EXPECT_EQ(app.task("S").profile.events, example.requests.size());
    EXPECT_EQ(app.task("S").profile.missed + app.task("S").profile.dropped + app.task("S").profile.events_lost, 0u);
  }
}

TEST(Servers, AJobLongerThanTheCapacityGoesOnWheneverSomeIsBack) {
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

TEST(Servers, ARingIsRefusedWhereNobodyWouldAnswerIt) {
  Application app;
  app.add("A", milliseconds(4), milliseconds(1));
  add_served(app, "S", kDeferrable, 1, 6);
  std::vector<int> answers;
  app.toy("A").during = [&answers](const chimera_call& call) {
    for (const char* target : {"A", "S", "nobody"})
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

TEST(Servers, WhatWaitsWhenTheTaskGoesOffIsForgotten) {
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

}  // namespace
}  // namespace chimera::toy
