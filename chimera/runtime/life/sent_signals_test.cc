// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/life/sent_signals.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

struct Plain {
  Out<double> x{"x", "1", initial = 0.0};
  void cycle(Cycle) {}
};

/// The other processes: takes posts while it has room.
struct Elsewhere final : PeerView {
  PeerPresence presence(TaskId) const noexcept override { return {true, true, true}; }
  State state(TaskId) const noexcept override { return State::kOn; }
  GroupReader outputs(TaskId) const noexcept override { return {}; }
  GroupReader constants(TaskId) const noexcept override { return {}; }
  GroupReader operator_variable(std::size_t) const noexcept override { return {}; }
  bool post(Signal signal, TaskId target, TaskId from, bool) noexcept override {
    if (!has_room) return false;
    posts.push_back({signal, target});
    EXPECT_EQ(from, TaskId(0u));
    return true;
  }
  bool has_room = true;
  std::vector<SentSignal> posts;
};

constexpr TaskId kSender{0u}, kServed{1u}, kForeign{2u};

/// A sender, a task behind a server, and a task of another context.
struct SentSignalsTest : ::testing::Test {
  SentSignalsTest() {
    specs[1].server.emplace();
    app.add("mine", testing::component<Plain>("plain"));
    app.make();
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      tasks[t].id = TaskId(t);
      tasks[t].spec = &specs[t];
      tasks[t].state = State::kOn;
      if (TaskId(t) == kForeign) memories.emplace_back();
      else memories.push_back(*TaskMemory::create(app.tasks[0], *app.components[0], heap));
    }
    sent.prepare(tasks, memories, &elsewhere);
  }
  void send(Signal signal, TaskId target) { EXPECT_TRUE(tasks[0].outbox.try_push({signal, target})); }

  testing::TestApplication app;
  std::array<TaskSpec, 3> specs;
  std::array<Task, 3> tasks;
  HeapMemory heap;
  std::vector<TaskMemory> memories;
  Elsewhere elsewhere;
  SentSignals sent;
};

TEST_F(SentSignalsTest, ASignalWaitsAtItsTargetInTheOrderOfSending) {
  send(Signal::kOff, kServed);
  send(Signal::kKill, kServed);
  sent.deliver(tasks[0]);
  EXPECT_TRUE(tasks[0].outbox.empty());
  EXPECT_TRUE(sent.has_pending());
  Signal signal{};
  ASSERT_TRUE(sent.take_pending(tasks[1], signal));
  EXPECT_EQ(signal, Signal::kOff);
  ASSERT_TRUE(sent.take_pending(tasks[1], signal));
  EXPECT_EQ(signal, Signal::kKill);
  EXPECT_FALSE(sent.has_pending());
  EXPECT_FALSE(sent.take_pending(tasks[1], signal));
}

TEST_F(SentSignalsTest, ARingOfATaskWithEventsAsksForACycleBoundary) {
  EXPECT_FALSE(sent.ring(TaskId(0u))) << "it has no doorbell";
  EXPECT_EQ(tasks[0].profile.events_lost, 0u);
  specs[0].has_events = true;
  EXPECT_FALSE(sent.ring(TaskId(0u))) << "it polls";
  tasks[0].by_events = true;
  EXPECT_TRUE(sent.ring(TaskId(0u)));
  EXPECT_TRUE(sent.ring(TaskId(0u)));
  EXPECT_EQ(tasks[0].events, 2u);
  EXPECT_TRUE(sent.has_pending());
  sent.had_rings();
  sent.had_rings();
  EXPECT_FALSE(sent.has_pending());
  tasks[0].state = State::kOff;
  EXPECT_FALSE(sent.ring(TaskId(0u)));
  EXPECT_EQ(tasks[0].profile.events_lost, 2u);
  EXPECT_TRUE(sent.ring(kServed));
  EXPECT_FALSE(sent.has_pending()) << "its server looks by itself";
}

TEST_F(SentSignalsTest, TheLastRequestForAConfigurationWaits) {
  EXPECT_FALSE(sent.take_request());
  tasks[0].requested_set = 2;
  sent.deliver(tasks[0]);
  tasks[1].requested_set = 1;
  sent.deliver(tasks[1]);
  EXPECT_FALSE(tasks[1].has_sent());
  EXPECT_TRUE(sent.has_pending());
  const SwitchRequest request = sent.take_request();
  EXPECT_EQ(request.set, 1u);
  EXPECT_EQ(request.cause, SwitchCause::kRequest);
  EXPECT_EQ(request.by, TaskId(1u));
  EXPECT_FALSE(sent.take_request());
  EXPECT_FALSE(sent.has_pending());
}

TEST_F(SentSignalsTest, ARequestForTasksWaitsWithItsLists) {
  EXPECT_EQ(sent.lists_of(tasks[0].id), nullptr);
  std::array<TaskLists, 3> lists;
  sent.allow_requests(lists);
  sent.lists_of(tasks[0].id)->plus.add(TaskId(1u));
  tasks[0].requested_set = kListsRequested;
  sent.deliver(tasks[0]);
  EXPECT_FALSE(tasks[0].has_sent());
  const SwitchRequest request = sent.take_request();
  ASSERT_TRUE(request);
  EXPECT_EQ(request.set, UINT32_MAX);
  EXPECT_TRUE(request.lists.plus.has(TaskId(1u)));
  EXPECT_EQ(request.by, TaskId(0u));
  EXPECT_FALSE(sent.take_request());
}

TEST_F(SentSignalsTest, KillTakesTheLastPlaceOfAFullQueue) {
  for (std::size_t i = 0; i < kOutboxSize + 2; ++i) sent.defer(tasks[1], Signal::kReinit);
  sent.defer(tasks[1], Signal::kKill);
  Signal signal{};
  std::size_t n = 0;
  while (sent.take_pending(tasks[1], signal)) ++n;
  EXPECT_EQ(n, kOutboxSize);
  EXPECT_EQ(signal, Signal::kKill);
  EXPECT_FALSE(sent.has_pending());
}

TEST_F(SentSignalsTest, PostsEveryOnAndSignalsToOtherContexts) {
  send(Signal::kOff, kForeign);
  send(Signal::kOn, kServed);
  sent.deliver(tasks[0]);
  ASSERT_EQ(elsewhere.posts.size(), 2u);
  EXPECT_EQ(elsewhere.posts[0].target, kForeign);
  EXPECT_EQ(elsewhere.posts[1].signal, Signal::kOn) << "only the manager turns tasks ON";
  EXPECT_FALSE(sent.has_pending());
}

TEST_F(SentSignalsTest, ARingThatFindsNoRoomIsCountedAsLost) {
  elsewhere.has_room = false;
  send(Signal::kWakeup, kForeign);
  send(Signal::kOff, kForeign);
  sent.deliver(tasks[0]);
  EXPECT_EQ(tasks[0].profile.events_lost, 1u);
}

TEST_F(SentSignalsTest, ARingIsAnEventForATaskThatIsOnBehindAServer) {
  send(Signal::kWakeup, kServed);
  sent.deliver(tasks[0]);
  EXPECT_EQ(tasks[1].events, 1u);
  EXPECT_FALSE(sent.ring(kSender)) << "no server";
  tasks[1].state = State::kOff;
  EXPECT_FALSE(sent.ring(kServed));
  EXPECT_EQ(tasks[1].profile.events, 1u);
  EXPECT_EQ(tasks[1].profile.events_lost, 1u);
}

}  // namespace
}  // namespace chimera
