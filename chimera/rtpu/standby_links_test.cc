// SPDX-License-Identifier: Apache-2.0
// A standby in another rtpu takes over, using only status words and the keeper's page, without a manager.
#include <gtest/gtest.h>

#include <vector>

#include "chimera/rtpu/testing/test_rtpus.h"

namespace chimera::standby_links_test {
namespace {

using testing::TestApplication;
using testing::TestRtpus;

struct Primary {
  Out<double> u{"u", "1", initial = 0.0};
  static inline bool fails = false;
  Outcome cycle(Cycle c) {
    *u = static_cast<double>(c.count()) + 1;
    return fails ? fault("no current") : ok();
  }
};

struct Standby {
  Out<double> u{"u", "1", initial = 0.0};
  static inline bool fails = false;
  static inline double inherited = -1;
  static inline int ons = 0;
  Outcome on(Cycle) {
    ++ons;
    inherited = *u;
    return fails ? fault("no voltage") : ok();
  }
  void cycle(Cycle) { *u = *u + 1000; }
};

struct User {
  In<double> u{"u", "1"};
  Out<double> seen{"seen", "1", initial = 0.0};
  static inline int illegal = 0;
  void cycle(Cycle c) {
    *seen = *u;
    illegal += c.illegal() ? 1 : 0;
  }
};

constexpr TaskId kPrimary{0u}, kUser{1u}, kSpare{2u}, kLast{3u};

/// The primary, its reader, and its two standbys, each in its own rtpu.
struct StandbyLinksTest : ::testing::Test {
  StandbyLinksTest() { begin(); }
  void begin() {
    rtpus.reset();
    app = TestApplication();
    Primary::fails = Standby::fails = false;
    app.rtpus = {{"a", 0, Policy::kEdf}, {"b", 1, Policy::kEdf}, {"c", 2, Policy::kEdf}, {"d", 3, Policy::kEdf}};
    app.add("primary", testing::component<Primary>("primary")).rtpu = RtpuId(0u);
    app.add("user", testing::component<User>("user")).rtpu = RtpuId(1u);
    app.add("spare", testing::component<Standby>("standby")).rtpu = RtpuId(2u);
    app.add("last", testing::component<Standby>("standby")).rtpu = RtpuId(3u);
    app.make({kPrimary, kUser}, false);
    app.spec.standbys = pairs;
    rtpus = std::make_unique<TestRtpus>(app);
    rtpus->run(milliseconds(1));
    for (std::uint32_t t = 0; t <= kLast.index; ++t) rtpus->send(Signal::kSpawn, {TaskId(t)});
    rtpus->run(milliseconds(2));
    rtpus->send(Signal::kOn, {kPrimary});
    rtpus->run(milliseconds(1));
    rtpus->send(Signal::kOn, {kUser});
    rtpus->run(milliseconds(5));
    User::illegal = 0;
  }
  State state(TaskId task) const { return rtpus->rtpus[app.tasks[task.index].rtpu.index]->state(task); }
  /// The last published takeover of the task's rtpu; `is_alive`: read as from a live process.
  Takeover told_by(TaskId task, std::uint32_t number, bool is_alive = true) const {
    Takeover takeover;
    const BlockView block = rtpus->rtpus[app.tasks[task.index].rtpu.index]->segment.block.view();
    EXPECT_TRUE(block.takeovers().read(number, is_alive, takeover)) << number;
    return takeover;
  }
  std::uint64_t claim() const { return rtpus->decision.claims[0].load(); }

  std::vector<StandbySpec> pairs{{kPrimary, kSpare}, {kPrimary, kLast}};
  TestApplication app;
  std::unique_ptr<TestRtpus> rtpus;
};

TEST_F(StandbyLinksTest, TakesOverFromATaskThatFails) {
  Primary::fails = true;
  rtpus->run(milliseconds(5));
  EXPECT_EQ(state(kPrimary), State::kError);
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_EQ(state(kLast), State::kOff);
  EXPECT_GT(Standby::inherited, 0);
  EXPECT_GE(rtpus->rtpus[1]->output(kUser), 1000) << "the reader follows";
  EXPECT_FALSE(rtpus->flag_is_up());
  EXPECT_EQ(User::illegal, 0);
  EXPECT_EQ(claim(), 0u);
}

TEST_F(StandbyLinksTest, TakesOverFromAProcessThatDiesWithTheManager) {
  rtpus->keeper.alive[4] = 0;
  rtpus->die(0);
  rtpus->run(milliseconds(5));
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_GE(rtpus->rtpus[1]->output(kUser), 1000);
  EXPECT_EQ(User::illegal, 0);
  const Takeover takeover = told_by(kSpare, 1);
  EXPECT_EQ(takeover.from, kPrimary);
  EXPECT_EQ(takeover.standby.task, kSpare);
  EXPECT_TRUE(takeover.was_death);
  EXPECT_EQ(takeover.end, SwitchEnd::kDone);
  EXPECT_GE(takeover.at, takeover.lost);
  EXPECT_GE(takeover.ended, takeover.at);
  ASSERT_EQ(takeover.n_variables, 1u);
  EXPECT_EQ(takeover.variables[0].step_of_cycle.size, 1000);
}

TEST_F(StandbyLinksTest, TheNextOneTakesOverWhenTheFirstIsDeadOrCannot) {
  rtpus->die(2);
  rtpus->run(milliseconds(2));
  rtpus->die(0);
  rtpus->run(milliseconds(5));
  EXPECT_EQ(state(kLast), State::kOn);
  EXPECT_EQ(User::illegal, 0);
}

TEST_F(StandbyLinksTest, ReportsTheCompletedStepsOfATakeoverWhenItsRtpuDies) {
  rtpus->run(microseconds(500));  // between two releases
  rtpus->die(0);
  while (state(kSpare) != State::kOn) rtpus->run(microseconds(10));
  Takeover takeover;
  EXPECT_FALSE(rtpus->rtpus[2]->segment.block.view().takeovers().read(1, true, takeover)) << "it is not over";
  takeover = told_by(kSpare, 1, false);
  EXPECT_EQ(takeover.end, SwitchEnd::kDone);
  EXPECT_EQ(takeover.ended, kNever);
  EXPECT_NE(takeover.at, kNever);
}

TEST_F(StandbyLinksTest, AStandbyWhoseOnFailsMakesPlace) {
  Standby::fails = true;
  rtpus->die(0);
  rtpus->run(milliseconds(1));
  EXPECT_EQ(state(kSpare), State::kError);
  EXPECT_EQ(state(kLast), State::kError);
  rtpus->run(milliseconds(3));
  EXPECT_TRUE(rtpus->flag_is_up());
}

TEST_F(StandbyLinksTest, AnotherRtpuWithTheClaimIsWaitedForUnlessItIsDead) {
  rtpus->decision.claims[0] = std::uint64_t{4} << 32 | 1;  // the rtpu of `last`
  Primary::fails = true;
  rtpus->run(milliseconds(3));
  EXPECT_EQ(state(kSpare), State::kOff);
  EXPECT_TRUE(rtpus->flag_is_up()) << "a period is over";
  rtpus->die(3);
  rtpus->run(milliseconds(3));
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_FALSE(rtpus->flag_is_up());
}

TEST_F(StandbyLinksTest, AHotOneCyclesUnreadAndIsReadWithoutAnotherOn) {
  pairs[0].hot = true;
  Standby::ons = 0;
  begin();
  EXPECT_EQ(Standby::ons, 1);
  EXPECT_EQ(state(kSpare), State::kOff);
  const double before = rtpus->rtpus[2]->output(kSpare);
  EXPECT_GE(before, 4000) << "it cycles";
  EXPECT_LT(rtpus->rtpus[1]->output(kUser), 1000) << "unread";
  EXPECT_FALSE(rtpus->flag_is_up());
  rtpus->die(0);
  rtpus->run(milliseconds(3));
  EXPECT_EQ(state(kSpare), State::kOn);
  EXPECT_EQ(Standby::ons, 1);
  EXPECT_GE(rtpus->rtpus[1]->output(kUser), before + 2000);
  EXPECT_EQ(User::illegal, 0);
}

TEST_F(StandbyLinksTest, AProcessThatEndsWithTheRunIsNotReplaced) {
  rtpus->keeper.ending = 1;
  rtpus->die(0);
  rtpus->run(milliseconds(5));
  EXPECT_EQ(state(kSpare), State::kOff);
}

TEST_F(StandbyLinksTest, ASecondOnOfTheGroupIsRefusedByTheRtpuItself) {
  rtpus->send(Signal::kOn, {kSpare});  // the manager does not know of the takeover
  rtpus->run(milliseconds(2));
  EXPECT_EQ(state(kSpare), State::kOff);
  EXPECT_EQ(claim(), 0u);
}

/// Its `on` is not ready at first.
struct Slow {
  Out<double> w{"w", "1", initial = 0.0};
  static inline int asked = 0;
  Outcome on(Cycle) { return ++asked < 4 ? not_yet() : ok(); }
  void cycle(Cycle) { *w = *w + 1; }
};
struct Other {
  Out<double> w{"w", "1", initial = 0.0};
  void cycle(Cycle) { *w = 1; }
};

/// Two groups fail in the first rtpu and are replaced in the second, in the first group later than in the other.
TEST(StandbyLinks, ReportsTakeoversOfTwoGroupsInTheOrderOfTheirResults) {
  constexpr TaskId kOther{0u}, kFirst{1u}, kSlow{2u}, kQuick{3u};
  const std::vector<StandbySpec> two{{kOther, kSlow}, {kFirst, kQuick}};
  TestApplication app;
  Primary::fails = Standby::fails = false;
  Slow::asked = 0;
  app.rtpus = {{"a", 0, Policy::kEdf}, {"b", 1, Policy::kEdf}};
  app.add("other", testing::component<Other>("other")).rtpu = RtpuId(0u);
  app.add("first", testing::component<Primary>("primary")).rtpu = RtpuId(0u);
  app.add("slow", testing::component<Slow>("slow")).rtpu = RtpuId(1u);
  app.add("quick", testing::component<Standby>("standby")).rtpu = RtpuId(1u);
  app.make({kOther, kFirst}, false);
  app.spec.standbys = two;
  TestRtpus rtpus(app);
  rtpus.run(milliseconds(1));
  for (const TaskId task : {kOther, kFirst, kSlow, kQuick}) rtpus.send(Signal::kSpawn, {task});
  rtpus.run(milliseconds(2));
  rtpus.send(Signal::kOn, {kOther, kFirst});
  rtpus.run(milliseconds(3));
  rtpus.die(0);
  rtpus.run(milliseconds(2));
  const TakeoverRing& ring = rtpus.rtpus[1]->segment.block.view().takeovers();
  Takeover takeover;
  ASSERT_TRUE(ring.read(1, true, takeover)) << "the other one is waited for";
  EXPECT_EQ(takeover.standby.task, kQuick);
  rtpus.run(milliseconds(8));
  EXPECT_EQ(Slow::asked, 4);
  ASSERT_TRUE(ring.read(2, true, takeover));
  EXPECT_EQ(takeover.standby.task, kSlow);
  EXPECT_GE(takeover.at - takeover.lost, milliseconds(3));
  EXPECT_TRUE(ring.read(1, true, takeover));
}

}  // namespace
}  // namespace chimera::standby_links_test
