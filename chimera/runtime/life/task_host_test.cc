// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/life/task_host.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera {
namespace {

struct Asking {
  In<double> in{"in", "U"};
  InConst<double> limit{"limit", "m", initial = 3.0};
  Out<double> y{"y", "1", initial = 0.0};
  void cycle(Cycle) {}
};

struct Served {
  Out<double> z{"z", "1", initial = 0.0};
  void cycle(Cycle) {}
};

constexpr std::uint32_t kOff = CHIMERA_SIGNAL_OFF, kWakeup = CHIMERA_SIGNAL_WAKEUP;

struct TaskHostTest : ::testing::Test {
  TaskHostTest() {
    app.add("asking", testing::component<Asking>("asking"));
    app.add("served", testing::component<Served>("served")).server.emplace();
    app.link(0, 0, "q");
    app.port(0, 0).unit = "rad";
    app.link(0, 1, {});
    app.give(app.operators, "q", CHIMERA_FLOAT64, testing::bytes_of(0.5));
    set = *HeapTaskSet::create(app.make(), app.components);
    set->methods().run_by({&clock});
    EXPECT_TRUE(set->life().start({}));
    task().has_news = false;
  }
  Task& task() { return set->tasks()[0]; }
  const chimera_host& host() { return *task().call.host; }
  void* context() { return task().call.context; }
  std::int32_t send(std::uint32_t signal, const char* name) { return host().signal(context(), signal, name); }
  static std::string_view view(chimera_text text) { return {text.at, text.size}; }
  /// The port number `index` of the asking task.
  const chimera_port* port(std::size_t index) {
    const std::uint32_t at = task().component->ports[index].live_offset;
    return reinterpret_cast<const chimera_port*>(static_cast<const std::byte*>(task().instance) + at);
  }

  testing::TestApplication app;
  std::unique_ptr<HeapTaskSet> set;
  ModelledClock clock;
};

/// Records the arguments of keep().
TEST_F(TaskHostTest, KnowsTheIncarnationOfItsProcess) {
  EXPECT_EQ(host().incarnation(context()), 1u);
  ContextPlace place;
  place.incarnation = 3;
  set = *HeapTaskSet::create(app.spec, app.components, place);
  set->methods().run_by({&clock});
  ASSERT_TRUE(set->life().start({}));
  EXPECT_EQ(host().incarnation(context()), 3u);
}

struct KeptFrames final : SafeFrames {
  std::span<SafeFrame, kSafeFrames> of(TaskId task) noexcept override {
    return std::span<SafeFrame, kSafeFrames>(frames[task.index], kSafeFrames);
  }
  bool keep(TaskId task, std::uint32_t index, int descriptor, Nanoseconds pause) noexcept override {
    kept = std::to_string(task.index) + "." + std::to_string(index) + " to " + std::to_string(descriptor) + " after " +
           std::to_string(pause.count);
    return true;
  }
  SafeFrame frames[2][kSafeFrames]{};
  std::string kept;
};

TEST_F(TaskHostTest, RefusesSafeFramesInAContextWithoutAGuard) {
  EXPECT_EQ(host().safe_frame(context(), 0, 1, 0), CHIMERA_FAULT);
  EXPECT_EQ(host().safe_bytes(context(), 0, "x", 1), CHIMERA_OK);
}

TEST_F(TaskHostTest, SafeFramesStandUntilOffOrKillHasEndedWell) {
  KeptFrames frames;
  ContextPlace place;
  place.safe_frames = &frames;
  set = *HeapTaskSet::create(app.spec, app.components, place);
  set->methods().run_by({&clock});
  ASSERT_TRUE(set->life().start({}));
  EXPECT_EQ(host().safe_frame(context(), 3, 7, 2000), CHIMERA_OK);
  EXPECT_EQ(frames.kept, "0.3 to 7 after 2000");
  EXPECT_EQ(host().safe_frame(context(), 4, 7, 0), CHIMERA_FAULT);
  const std::string most(kSafeBytes + 1, 'x');
  EXPECT_EQ(host().safe_bytes(context(), 3, most.data(), kSafeBytes + 1), CHIMERA_FAULT);
  EXPECT_EQ(host().safe_bytes(context(), 4, most.data(), 1), CHIMERA_FAULT);
  EXPECT_TRUE(frames.frames[0][3].last_words().empty());
  for (const Signal ends : {Signal::kOff, Signal::kKill}) {
    EXPECT_EQ(host().safe_bytes(context(), 3, most.data(), kSafeBytes), CHIMERA_OK);
    EXPECT_EQ(frames.frames[0][3].last_words().size(), kSafeBytes);
    const TaskId asking(std::size_t{0});
    EXPECT_TRUE(set->life().signal({&asking, 1}, ends, {}));
    EXPECT_TRUE(frames.frames[0][3].last_words().empty()) << signal_name(ends);
  }
}

TEST_F(TaskHostTest, AJobIsExpiredPastItsDeadlineOrOnGiveUp) {
  task().call.deadline_ns = milliseconds(5).count;
  clock.set(milliseconds(5));
  EXPECT_EQ(host().expired(context()), 0) << "at the deadline itself";
  clock.set(milliseconds(5) + Nanoseconds{1});
  EXPECT_EQ(host().expired(context()), 1);
  clock.set(milliseconds(1));
  task().give_up.store(true, std::memory_order_relaxed);
  EXPECT_EQ(host().expired(context()), 1);
}

TEST_F(TaskHostTest, AMethodSeesTheClockOfTheThreadThatRunsIt) {
  ModelledClock other;
  TaskHost mine{set.get(), &task(), &other};
  task().call.deadline_ns = milliseconds(5).count;
  other.set(milliseconds(6));
  EXPECT_EQ(TaskHost::kCalls.expired(&mine), 1);
  TaskHost::kCalls.spend(&mine, 1'000);
  EXPECT_EQ(other.spent(), microseconds(1));
  EXPECT_EQ(clock.spent(), Nanoseconds{});
  host().spend(context(), 2'000);
  EXPECT_EQ(clock.spent(), microseconds(2));
}

TEST_F(TaskHostTest, ASignalGoesToTheTaskOfThatNameOrToTheOwnTask) {
  EXPECT_EQ(send(kOff, nullptr), CHIMERA_OK);
  EXPECT_EQ(send(kOff, "served"), CHIMERA_OK);
  ASSERT_EQ(task().outbox.size(), 2u);
  EXPECT_EQ(task().outbox[0].target, TaskId(0u));
  EXPECT_EQ(task().outbox[1].target, TaskId(1u));
  EXPECT_EQ(task().outbox[1].signal, Signal::kOff);
  EXPECT_TRUE(task().has_news);
}

TEST_F(TaskHostTest, RefusesASignalWithoutAReceiver) {
  EXPECT_EQ(send(kOff, "absent"), CHIMERA_FAULT);
  EXPECT_EQ(send(kOff, ""), CHIMERA_FAULT);
  EXPECT_EQ(send(kWakeup + 1, "served"), CHIMERA_FAULT);
  EXPECT_TRUE(task().outbox.empty());
  EXPECT_FALSE(task().has_news);
  for (std::size_t i = 0; i < kOutboxSize; ++i) EXPECT_EQ(send(kOff, "served"), CHIMERA_OK);
  EXPECT_EQ(send(kOff, "served"), CHIMERA_FAULT) << "the outbox is full";
}

TEST_F(TaskHostTest, OnlyATaskBehindAServerHasADoorbell) {
  EXPECT_EQ(send(kWakeup, "served"), CHIMERA_OK);
  EXPECT_EQ(send(kWakeup, "asking"), CHIMERA_FAULT);
  EXPECT_EQ(send(kWakeup, nullptr), CHIMERA_FAULT);
}

TEST_F(TaskHostTest, ANoteIsCutAndCounted) {
  host().note(context(), "without its fan");
  EXPECT_STREQ(task().faults.note, "without its fan");
  host().note(context(), std::string(400, 'x').c_str());
  EXPECT_EQ(std::string(task().faults.note), std::string(CHIMERA_FAULT_TEXT - 1, 'x'));
  EXPECT_EQ(task().faults.notes, 2u);
  EXPECT_EQ(task().faults.told, 2u);
  EXPECT_EQ(task().faults.count, 0u);
  EXPECT_TRUE(task().has_news);
}

TEST_F(TaskHostTest, KeepsARequestForAConfigurationIfRequestsAreAllowed) {
  const NamedSet sets[] = {{"near", {}}, {"far", {}}};
  const_cast<ApplicationSpec&>(set->spec()).sets = sets;
  EXPECT_EQ(host().request(context(), "far"), CHIMERA_FAULT);
  EXPECT_STREQ(task().faults.note, "asks for the configuration 'far': requests are not taken here");
  EXPECT_EQ(task().requested_set, kNoRequest);
  set->sent().allow_requests({});
  task().has_news = false;
  EXPECT_EQ(host().request(context(), "far"), CHIMERA_OK);
  EXPECT_EQ(task().requested_set, 1u);
  EXPECT_TRUE(task().has_news);
  EXPECT_EQ(host().request(context(), "near"), CHIMERA_OK);
  EXPECT_EQ(task().requested_set, 0u);
  EXPECT_EQ(host().request(context(), "fa"), CHIMERA_FAULT);
  EXPECT_EQ(task().faults.notes, 1u) << "reported once";
  EXPECT_EQ(task().requests_refused, 2u);
}

TEST_F(TaskHostTest, KeepsARequestForTasksIfListsAreAllowed) {
  const std::string mine(task().spec->name);
  const std::string on = "--on " + mine;
  set->sent().allow_requests({});
  EXPECT_EQ(host().request(context(), on.c_str()), CHIMERA_FAULT);
  EXPECT_EQ(task().faults.note, "asks for '" + on + "': requests are not taken here");
  std::vector<TaskLists> lists(set->tasks().size());
  set->sent().allow_requests(lists);
  const auto refusal = [&](const char* text) {
    task().requests_refused = 0;
    EXPECT_EQ(host().request(context(), text), CHIMERA_FAULT);
    return std::string(task().faults.note);
  };
  EXPECT_EQ(refusal("--on absent"), "asks for '--on absent': there is no task 'absent'");
  EXPECT_EQ(refusal("--off"), "asks for '--off': expected '--on TASK... --off TASK...'");
  EXPECT_EQ(refusal("-x"), "asks for '-x': expected '--on TASK... --off TASK...'");
  EXPECT_EQ(task().requested_set, kNoRequest);
  EXPECT_FALSE(lists[task().id.index].are_there());
  EXPECT_EQ(host().request(context(), on.c_str()), CHIMERA_OK);
  EXPECT_EQ(task().requested_set, kListsRequested);
  EXPECT_TRUE(lists[task().id.index].plus.has(task().id));
}

TEST_F(TaskHostTest, APortKnowsItsVariableAndTheRtpu) {
  EXPECT_EQ(view(host().variable(context(), port(0))), "q");
  EXPECT_EQ(view(host().unit(context(), port(0))), "rad");
  EXPECT_EQ(view(host().variable(context(), port(1))), "") << "not linked";
  EXPECT_EQ(view(host().variable(context(), port(2))), "y");
  const chimera_port stranger{};
  EXPECT_EQ(view(host().variable(context(), &stranger)), "");
  EXPECT_EQ(view(host().unit(context(), &stranger)), "");
}

}  // namespace
}  // namespace chimera
