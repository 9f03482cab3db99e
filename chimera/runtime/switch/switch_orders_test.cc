// SPDX-License-Identifier: Apache-2.0
// The decisions about a switch; the test plays the two contexts that carry it out.
#include "chimera/runtime/switch/switch_orders.h"

#include <gtest/gtest.h>

#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::switch_orders_test {
namespace {

struct Source {
  Out<double> u{"u", "1", initial = 0.0};
  void cycle(Cycle) { *u = 1; }
};

struct User {
  In<double> u{"u", "1"};
  Out<double> v{"v", "1", initial = 0.0};
  void cycle(Cycle) { *v = *u; }
};

constexpr TaskId kOne{0u}, kTwo{1u}, kUser{2u};
constexpr Nanoseconds kOrigin = seconds(1), kAsked = seconds(2);

/// Tasks one and user are in context 0, two is in context 1.
struct Contexts final : SwitchMembers, MadeConstants {
  SwitchPage& page() noexcept override { return words; }
  std::uint16_t living() const noexcept override { return 0b11; }
  TaskStatus status(TaskId task) const noexcept override { return {states[task.index], false}; }
  bool is_kept_off(TaskId task) const noexcept override { return task == kept_off; }
  Profile profile(TaskId task) const noexcept override { return profiles[task.index]; }
  bool needs_gaps(TaskId) const noexcept override { return is_executive; }
  const MadeConstants& constants() noexcept override { return *this; }
  bool differ(ConstantId, std::uint32_t, std::uint32_t) const noexcept override { return false; }
  bool is_busy_with(std::uint32_t context, std::uint16_t plan) const noexcept override { return over[context] != plan; }
  bool read_part(std::uint32_t context, std::uint16_t plan, SwitchReceipt& part) const noexcept override {
    part = parts[context];
    return part.number == plan;
  }
  void ring() noexcept override { ++rung; }

  SwitchPage words;
  std::vector<State> states{State::kOn, State::kOff, State::kOn};
  std::vector<Profile> profiles{3};
  std::uint16_t over[kMaxContexts] = {};
  SwitchReceipt parts[kMaxContexts];
  bool is_executive = true;
  TaskId kept_off;
  int rung = 0;
};

struct SwitchOrdersTest : ::testing::Test {
  SwitchOrdersTest() {
    app.rtpus = {{"a", 0, Policy::kEdf}, {"b", 1, Policy::kEdf}};
    app.add("one", testing::component<Source>("source")).rtpu = RtpuId(0u);
    app.add("two", testing::component<Source>("source")).rtpu = RtpuId(1u);
    app.add("user", testing::component<User>("user")).rtpu = RtpuId(0u);
    app.make(first, false);
    app.spec.sets = sets;
    orders.prepare(app.spec, false, memory);
    orders.begin(kOrigin);
    tasks.resize(3);
    variables.resize(app.spec.variables.size());
    reinitialised.resize(3);
  }
  /// Judges a request for the second set.
  PlanAnswer judge(SwitchCause cause = SwitchCause::kScript) {
    TaskBits target = tasks_of(app.spec, 1);
    return orders.judge(target, cause);
  }
  /// To the second set.
  void ask() {
    ASSERT_TRUE(judge());
    present.number = 1;
    present.asked = kAsked;
    orders.make(present, tasks_of(app.spec, 1), kAsked + kSwitchPatience);
    orders.announce(present);
  }
  static std::vector<TaskPart> parts_of(const std::vector<TaskId>& ids) {
    std::vector<TaskPart> parts(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) parts[i].task = ids[i];
    return parts;
  }
  /// Both contexts are over with the plan, which context 1 has aborted for that reason.
  void abort(NoSwitch why) {
    (void)orders.agreement().abort(present.order.number);
    for (std::uint32_t c = 0; c < 2; ++c) {
      contexts.over[c] = present.order.number;
      contexts.parts[c].number = present.order.number;
    }
    contexts.parts[1].why = why;
    contexts.parts[1].task = kTwo;
  }
  const SwitchReceipt& collect(Nanoseconds now) {
    receipt.tasks = tasks;
    receipt.variables = variables;
    receipt.reinitialised = reinitialised;
    orders.collect(present, NoSwitch::kMemberDied, now, receipt);
    return receipt;
  }

  std::vector<TaskId> first{kOne, kUser}, second{kTwo, kUser};
  NamedSet sets[2] = {{"first", first}, {"second", second}};
  testing::TestApplication app;
  HeapMemory memory;
  Contexts contexts;
  SwitchOrders orders{contexts};
  OrderedSwitch present;
  SwitchReceipt receipt;
  std::vector<TaskPart> tasks;
  std::vector<VariablePart> variables;
  std::vector<TaskId> reinitialised;
};

TEST_F(SwitchOrdersTest, OrderNamesTasksMembersDeadlineAndLead) {
  contexts.profiles[kUser.index].execution[static_cast<int>(Method::kCycle)].add(milliseconds(5));
  ask();
  const auto order = orders.agreement().order(orders.agreement().plan(), 2, 3);
  ASSERT_TRUE(order);
  EXPECT_EQ(*order, present.order);
  EXPECT_EQ(order->members, 0b11);
  EXPECT_EQ(order->target, tasks_of(app.spec, 1));
  EXPECT_EQ(order->on, tasks_of(app.spec, 0));
  EXPECT_EQ(order->until, kAsked + kSwitchPatience);
  EXPECT_EQ(order->lead, milliseconds(5) + microseconds(200)) << "a job of 5 ms may be under way";
  EXPECT_EQ(present.before, 0u);
  EXPECT_EQ(contexts.rung, 1);
}

TEST_F(SwitchOrdersTest, ATaskAndAReactionCannotTurnOnWhatAPersonTurnedOff) {
  contexts.kept_off = kTwo;
  for (const SwitchCause cause :
       {SwitchCause::kRequest, SwitchCause::kMiss, SwitchCause::kOverrun, SwitchCause::kFault}) {
    const PlanAnswer answer = judge(cause);
    EXPECT_EQ(answer.why, NoSwitch::kKeptOff);
    EXPECT_EQ(answer.task, kTwo);
  }
  EXPECT_TRUE(judge(SwitchCause::kScript)) << "a person may";
  contexts.kept_off = kOne;
  EXPECT_TRUE(judge(SwitchCause::kRequest)) << "it is to leave";
}

TEST_F(SwitchOrdersTest, ARequestOfATaskKeepsTheStandbyThatTookOver) {
  const StandbySpec standbys[] = {{.primary = kOne, .standby = kTwo}};
  app.spec.standbys = standbys;
  app.spec.sets = std::span(sets).first(1);
  orders.prepare(app.spec, false, memory);
  contexts.states = {State::kOff, State::kOn, State::kOn};
  TaskBits target = tasks_of(app.spec, 0);
  EXPECT_EQ(orders.judge(target, SwitchCause::kRequest).why, NoSwitch::kNothingToDo);
  EXPECT_EQ(target, bits_of(second));
  target = bits_of(std::vector<TaskId>{kOne});
  EXPECT_TRUE(orders.judge(target, SwitchCause::kRequest));
  EXPECT_EQ(target, bits_of(std::vector<TaskId>{kTwo})) << "other tasks leave, and the standby stays";
  target = tasks_of(app.spec, 0);
  EXPECT_TRUE(orders.judge(target, SwitchCause::kScript)) << "a person may go back";
  app.spec.sets = sets;  // a configuration of its own has the standby: it did not take over
  target = tasks_of(app.spec, 0);
  EXPECT_TRUE(orders.judge(target, SwitchCause::kRequest));
  EXPECT_EQ(target, bits_of(first));
}

TEST_F(SwitchOrdersTest, LateSwitchIsTriedFourTimesWithMoreLead) {
  ask();
  const Nanoseconds lead = present.order.lead;
  for (std::uint32_t n = 2; n <= kMostTries; ++n) {
    abort(NoSwitch::kLate);
    ASSERT_TRUE(orders.is_over(present));
    ASSERT_TRUE(orders.make_next_try(present, collect(kAsked + seconds(1)).why, kAsked + seconds(1))) << n;
    orders.announce(present);
    EXPECT_EQ(present.tries, n);
    EXPECT_EQ(present.order.number, n);
    EXPECT_EQ(present.order.lead, lead_of_try(lead, n));
    EXPECT_EQ(present.order.until, kAsked + kSwitchPatience);
    EXPECT_FALSE(orders.is_over(present));
  }
  abort(NoSwitch::kLate);
  EXPECT_FALSE(orders.make_next_try(present, NoSwitch::kLate, kAsked + seconds(1)));
  EXPECT_EQ(collect(kAsked + seconds(1)).tries, kMostTries);
}

TEST_F(SwitchOrdersTest, LateSwitchIsNotTriedAfterItsDeadline) {
  ask();
  abort(NoSwitch::kLate);
  EXPECT_FALSE(orders.make_next_try(present, NoSwitch::kLate, present.order.until));
}

TEST_F(SwitchOrdersTest, ASwitchWithoutAGapIsRepeatedSlowlyOnce) {
  ask();
  abort(NoSwitch::kNoGap);
  const Nanoseconds now = kAsked + kSwitchPatience;
  ASSERT_TRUE(orders.make_next_try(present, NoSwitch::kNoGap, now));
  EXPECT_EQ(present.order.slow, kSlowForGap);
  EXPECT_EQ(present.way.slow, kSlowForGap);
  EXPECT_EQ(present.order.until, now + kSwitchPatience);
  EXPECT_FALSE(orders.make_next_try(present, NoSwitch::kNoGap, now));
}

TEST_F(SwitchOrdersTest, SwitchThatFailedIsNotTriedAgain) {
  ask();
  abort(NoSwitch::kOnFailed);
  EXPECT_FALSE(orders.make_next_try(present, NoSwitch::kOnFailed, kAsked));
}

TEST_F(SwitchOrdersTest, OnlyAnExecutiveNeedsAGapForOn) {
  app.tasks[kTwo.index].budget = milliseconds(3);
  app.tasks[kUser.index].rtpu = RtpuId(1u);
  for (TaskSpec& task : app.tasks) task.on_miss = OnMiss::kAbort;
  orders.prepare(app.spec, false, memory);
  ASSERT_TRUE(judge());
  EXPECT_EQ(orders.way().slow, kSlowForGap);
  EXPECT_EQ(orders.way().gapless, kTwo);
  contexts.is_executive = false;
  ASSERT_TRUE(judge());
  EXPECT_EQ(orders.way().slow, 0);
}

TEST_F(SwitchOrdersTest, PartsBecomeOneReceiptAndWrongOnesAreLeftOut) {
  ask();
  abort(NoSwitch::kLate);
  std::vector<TaskPart> of_first = parts_of({kUser}), of_second = parts_of({kTwo, kOne, TaskId(99u)});
  of_second[0].move = TaskMove::kArrives;
  contexts.parts[0].tasks = of_first;
  contexts.parts[1].tasks = of_second;
  contexts.parts[0].why = NoSwitch::kOnFailed;
  contexts.parts[0].task = TaskId(7u);
  contexts.parts[0].armed = kAsked + seconds(9);
  contexts.parts[1].armed = kAsked + milliseconds(1);
  const SwitchReceipt& all = collect(kAsked + seconds(1));
  EXPECT_EQ(all.end, SwitchEnd::kAborted);
  EXPECT_EQ(all.why, NoSwitch::kOnFailed) << "the other context was only late";
  EXPECT_FALSE(all.task.index == 7u);
  EXPECT_EQ(all.armed, kAsked + milliseconds(1)) << "an instant to come is wrong";
  EXPECT_EQ(all.ended, kAsked + seconds(1));
  ASSERT_EQ(all.tasks.size(), 2u) << "task one is of the other context";
  EXPECT_EQ(all.tasks[0].task, kTwo) << "arriving tasks come first";
  EXPECT_EQ(all.tasks[1].task, kUser);
}

TEST_F(SwitchOrdersTest, PartThatNamesATaskTooOftenOverrunsNothing) {
  ask();
  abort(NoSwitch::kLate);
  std::vector<TaskPart> many = parts_of(std::vector<TaskId>(50, kUser));
  contexts.parts[0].tasks = many;
  EXPECT_EQ(collect(kAsked).tasks.size(), 3u);
}

}  // namespace
}  // namespace chimera::switch_orders_test
