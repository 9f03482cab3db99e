// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/rtpu_control.h"

#include <gtest/gtest.h>

#include <utility>

#include "chimera/rtpu/testing/test_rtpus.h"
#include "chimera/runtime/hosted/heap_memory.h"

namespace chimera {
namespace {

using testing::component;
using testing::TestApplication;
using testing::TestRtpus;

struct Source {
  Out<double> x{"x", "1", initial = 0.0};
  OutConst<std::int32_t> scale{"scale", "1"};
  void init(Cycle) { *scale = wanted; }
  void reinit(Cycle) { *scale = wanted; }
  void on(Cycle) {
    n_ = *x;
    inherited = x.inherited();
  }
  void cycle(Cycle) { *x = ++n_; }
  double n_ = 0;
  static inline Nanoseconds inherited;
  static inline std::int32_t wanted = 1;
};

struct Follower {
  In<double> x{"x", "1"};
  InConst<std::int32_t> scale{"scale", "1"};
  Out<double> y{"y", "1", initial = 0.0};
  void reinit(Cycle) { ++reinits; }
  Outcome cycle(Cycle c) {
    illegal = c.illegal();
    if (*x == fail_at) return fault("as told", 7);
    if (*x == note_at) c.note("as asked");
    *y = *x * static_cast<double>(*scale);
    return ok();
  }
  static inline bool illegal = false;
  static inline int reinits = 0;
  static inline double fail_at = -1, note_at = -1;
};

struct Killer {  // kills the follower when `now` is set
  In<double> y{"y", "1"};
  void cycle(Cycle c) {
    if (now && c.signal(Signal::kKill, "follower")) now = false;
    if (on && c.signal(Signal::kOn, "spare")) on = false;
  }
  static inline bool now = false, on = false;
};

constexpr TaskId kSource{0u}, kFollower{1u}, kKiller{2u}, kSpare{3u};

struct EdgeTest : ::testing::Test {
  EdgeTest() {
    Follower::illegal = false;
    Follower::reinits = 0;
    Follower::fail_at = -1;
    Source::wanted = 1;
    Killer::now = Killer::on = false;
    app.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app.add("source", component<Source>("source")).rtpu = RtpuId(0u);
    app.add("follower", component<Follower>("follower")).rtpu = RtpuId(1u);
    app.add("killer", component<Killer>("killer")).rtpu = RtpuId(0u);
    app.add("spare", component<Source>("source")).rtpu = RtpuId(1u);
    app.link(3, 1, "spare_scale");
    app.make({kSource, kFollower, kKiller}, false);
    rtpus = std::make_unique<TestRtpus>(app);
    rtpus->run(milliseconds(1));
  }
  void all_on() { rtpus->bring_up({kSource, kFollower, kKiller}); }
  testing::TestRtpu& first() { return *rtpus->rtpus[0]; }
  testing::TestRtpu& second() { return *rtpus->rtpus[1]; }
  /// The fault group of the follower, as other processes read it.
  FaultRecord shown_of_follower() {
    HeapMemory heap;
    const auto layout = PeerLayout::of(app.spec, 1, heap);
    const GroupPlace& place = layout->place(layout->fault(kFollower));
    const std::byte* at = second().segment.region.bytes().data() + sizeof(SegmentHeader) + place.offset;
    FaultRecord record;
    chimera_slot slot;
    EXPECT_TRUE(GroupReader(at, place.payload_bytes).try_read(slot, reinterpret_cast<std::byte*>(&record)));
    return record;
  }

  TestApplication app;
  std::unique_ptr<TestRtpus> rtpus;
};

TEST_F(EdgeTest, ValuesAndConstantsCrossFromRtpuToRtpu) {
  Source::wanted = 3;
  all_on();
  rtpus->run(milliseconds(10));
  EXPECT_EQ(first().state(kSource), State::kOn);
  EXPECT_EQ(second().state(kFollower), State::kOn);
  EXPECT_GT(first().output(kSource), 8);
  EXPECT_NEAR(second().output(kFollower), 3 * first().output(kSource), 3.1);
  EXPECT_FALSE(rtpus->flag_is_up());
}

TEST_F(EdgeTest, EverySignalWithACommandIsReported) {
  rtpus->send(Signal::kSpawn, {kSource}, 11);
  rtpus->run(milliseconds(1));
  rtpus->send(Signal::kOn, {kSource}, 12);
  rtpus->run(milliseconds(1));
  rtpus->send(Signal::kOn, {kSource}, 13);
  rtpus->run(milliseconds(1));
  const auto reports = rtpus->take(PostKind::kReport);
  ASSERT_EQ(reports.size(), 3u);
  EXPECT_EQ(reports[0].command, 11u);
  EXPECT_EQ(reports[0].detail, 1u);
  EXPECT_EQ(reports[0].after, State::kOff);
  EXPECT_EQ(reports[1].detail, 1u);
  EXPECT_EQ(reports[2].detail, 0u);
  EXPECT_EQ(static_cast<Refusal>(reports[2].why), Refusal::kState);
  EXPECT_EQ(first().state(kSource), State::kOn);
}

TEST_F(EdgeTest, TheManagerDecidesWhichGroupsGoToTheTap) {
  all_on();
  EXPECT_FALSE(first().tasks->tasks()[kSource.index].is_tapped);
  rtpus->manager->block.set_tapped(kSource, true);
  rtpus->manager->block.set_tapped(kFollower, true);
  rtpus->change();
  rtpus->run(milliseconds(1));
  EXPECT_TRUE(first().tasks->tasks()[kSource.index].is_tapped);
  EXPECT_FALSE(first().tasks->tasks()[kFollower.index].is_tapped);  // a task of the other rtpu
  EXPECT_TRUE(second().tasks->tasks()[kFollower.index].is_tapped);
  rtpus->manager->block.set_tapped(kSource, false);
  rtpus->change();
  rtpus->run(milliseconds(1));
  EXPECT_FALSE(first().tasks->tasks()[kSource.index].is_tapped);
}

TEST_F(EdgeTest, SignalsForATaskInServiceWaitTheirTurn) {
  rtpus->send(Signal::kSpawn, {kSource}, 1);
  rtpus->send(Signal::kOn, {kSource}, 2);
  rtpus->send(Signal::kOff, {kSource}, 3);
  rtpus->run(milliseconds(1));
  const auto reports = rtpus->take(PostKind::kReport);
  ASSERT_EQ(reports.size(), 3u);
  for (const Post& report : reports) EXPECT_EQ(report.detail, 1u) << report.command;
  EXPECT_EQ(first().state(kSource), State::kOff);
}

TEST_F(EdgeTest, AStepWithAnIllegalSignalChangesNothing) {
  rtpus->send(Signal::kSpawn, {kSource}, 1);
  rtpus->run(milliseconds(1));
  rtpus->take(PostKind::kReport);
  rtpus->send(Signal::kOn, {kSource, kKiller}, 2);
  rtpus->run(milliseconds(1));
  const auto reports = rtpus->take(PostKind::kReport);
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_EQ(static_cast<Refusal>(reports[0].why), Refusal::kNone);
  EXPECT_EQ(static_cast<Refusal>(reports[1].why), Refusal::kState);
  EXPECT_EQ(first().state(kSource), State::kOff);
}

TEST_F(EdgeTest, TheFlagGoesUpEverywhereWhenAProducerLeaves) {
  all_on();
  rtpus->send(Signal::kOff, {kSource});
  rtpus->run(milliseconds(3));
  EXPECT_TRUE(rtpus->flag_is_up());
  EXPECT_TRUE(Follower::illegal) << "the consumer in another rtpu sees the flag";
  rtpus->send(Signal::kOn, {kSource});
  rtpus->run(milliseconds(3));
  EXPECT_FALSE(rtpus->flag_is_up());
  EXPECT_FALSE(Follower::illegal);
}

TEST_F(EdgeTest, ATaskKillsATaskOfAnotherRtpuWithoutAManager) {
  all_on();
  rtpus->keeper.alive[2] = 0;
  Killer::now = true;
  rtpus->run(milliseconds(3));
  EXPECT_FALSE(Killer::now);
  EXPECT_EQ(second().state(kFollower), State::kNotCreated);
}

TEST_F(EdgeTest, OnFromATaskIsAskedOfTheManager) {
  all_on();
  rtpus->take(PostKind::kRequest);
  Killer::on = true;
  rtpus->run(milliseconds(3));
  const auto requests = rtpus->take(PostKind::kRequest);
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].task, kSpare);
  EXPECT_EQ(requests[0].from, kKiller);
}

TEST_F(EdgeTest, AConsumerFollowsAProducerThatTakesOverInAnotherRtpu) {
  all_on();
  EXPECT_EQ(Source::inherited, kNever);
  rtpus->send(Signal::kSpawn, {kSpare});
  rtpus->run(milliseconds(10));
  const double before = first().output(kSource);
  rtpus->send(Signal::kOff, {kSource});
  rtpus->run(milliseconds(1));
  rtpus->send(Signal::kOn, {kSpare});
  rtpus->run(milliseconds(5));
  EXPECT_FALSE(rtpus->flag_is_up());
  EXPECT_GT(second().output(kSpare), before) << "it began where its predecessor in the other rtpu stood";
  EXPECT_LT(second().output(kSpare), before + 7);
  EXPECT_GE(Source::inherited, microseconds(500)) << "off in the other rtpu, 1 ms before";
  EXPECT_LE(Source::inherited, milliseconds(2));
  EXPECT_NEAR(second().output(kFollower), second().output(kSpare), 1.1);
}

TEST_F(EdgeTest, ADeadRtpuRaisesTheFlagAndItsSuccessorIsFollowed) {
  all_on();
  rtpus->run(milliseconds(5));
  const double last = second().output(kFollower);
  rtpus->die(0);
  rtpus->run(milliseconds(2));
  EXPECT_TRUE(Follower::illegal);
  EXPECT_NEAR(second().output(kFollower), last, 1.1) << "the last good value stands";
  rtpus->start(0, 2);
  rtpus->run(milliseconds(2));
  EXPECT_TRUE(Follower::illegal);
  EXPECT_NEAR(second().output(kFollower), last, 1.1) << "not the empty group of the new process";
  rtpus->bring_up({kSource, kKiller});
  rtpus->run(milliseconds(5));
  EXPECT_FALSE(Follower::illegal);
  EXPECT_NEAR(second().output(kFollower), first().output(kSource), 1.1);
  EXPECT_EQ(second().tasks->tasks()[kFollower.index].state, State::kOn);
}

TEST_F(EdgeTest, AChangedConstantReinitialisesItsUsersInOtherRtpusAndOnlyThen) {
  all_on();
  rtpus->send(Signal::kReinit, {kSource}, 1);
  rtpus->run(milliseconds(2));
  EXPECT_EQ(Follower::reinits, 0) << "the value has not changed";
  Source::wanted = 5;
  rtpus->send(Signal::kReinit, {kSource}, 2);
  rtpus->run(milliseconds(3));
  EXPECT_EQ(Follower::reinits, 1);
  EXPECT_NEAR(second().output(kFollower), 5 * first().output(kSource), 5.1);
}

TEST_F(EdgeTest, ANoteIsReportedAtOnceAndTheTaskStaysOn) {
  all_on();
  rtpus->take(PostKind::kEvent);
  Follower::note_at = first().output(kSource) + 2;
  rtpus->run(milliseconds(5));
  Follower::note_at = -1;
  EXPECT_EQ(second().state(kFollower), State::kOn);
  const auto events = rtpus->take(PostKind::kEvent);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].happening, EventKind::kNote);
  EXPECT_EQ(events[0].task, kFollower);
  EXPECT_STREQ(shown_of_follower().note, "as asked");
}

TEST_F(EdgeTest, AFaultIsReportedWithItsTextInTheFaultGroup) {
  all_on();
  rtpus->take(PostKind::kEvent);
  Follower::fail_at = first().output(kSource) + 2;
  rtpus->run(milliseconds(5));
  EXPECT_EQ(second().state(kFollower), State::kError);
  EXPECT_TRUE(rtpus->flag_is_up()) << "the killer reads y";
  const auto events = rtpus->take(PostKind::kEvent);
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events[0].happening, EventKind::kFault);
  EXPECT_EQ(events[0].task, kFollower);
  EXPECT_EQ(events[0].detail, static_cast<std::uint64_t>(Method::kCycle));
  const FaultRecord fault = shown_of_follower();
  EXPECT_STREQ(fault.last.text, "as told");
  EXPECT_EQ(fault.last.code, 7);
}

TEST_F(EdgeTest, AManagerThatIsReplacedIsServedAndItsPredecessorsSignalsAreNot) {
  all_on();
  rtpus->start_manager(2);
  rtpus->run(milliseconds(1));
  rtpus->send(Signal::kOff, {kKiller}, 77);
  rtpus->run(milliseconds(1));
  EXPECT_EQ(first().state(kKiller), State::kOff);
  const auto reports = rtpus->take(PostKind::kReport);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].command, 77u);
}

TEST_F(EdgeTest, TheEndTurnsConsumersOffBeforeTheirProducersOverAllRtpus) {
  all_on();
  first().edge->rtpu_end().tell(false);
  rtpus->change();
  rtpus->run(milliseconds(3));
  EXPECT_EQ(first().state(kKiller), State::kOff) << "no task goes OFF before it";
  EXPECT_EQ(first().state(kSource), State::kOn) << "the follower in the other rtpu is still ON";
  second().edge->rtpu_end().tell(false);
  rtpus->change();
  rtpus->run(milliseconds(10));
  EXPECT_EQ(second().state(kFollower), State::kNotCreated);
  EXPECT_EQ(first().state(kSource), State::kNotCreated);
  EXPECT_TRUE(first().edge->rtpu_end().is_over());
  EXPECT_TRUE(second().edge->rtpu_end().is_over());
}

TEST_F(EdgeTest, AnInitThatEndsWhileItsRtpuEndsAloneIsNotReportedForItsSuccessorDoesItAgain) {
  for (const bool is_alone : {true, false}) {
    SCOPED_TRACE(is_alone ? "alone" : "with everything");
    rtpus = std::make_unique<TestRtpus>(app);
    rtpus->run(milliseconds(1));
    rtpus->send(Signal::kSpawn, {kSource}, 11);
    rtpus->run(microseconds(100));
    const auto in_init = std::exchange(first().service.asked, {});
    ASSERT_EQ(in_init.size(), 1u);
    first().edge->rtpu_end().tell(is_alone);
    rtpus->change();
    rtpus->run(milliseconds(1));
    first().service.asked = in_init;
    rtpus->run(milliseconds(3));
    EXPECT_TRUE(first().edge->rtpu_end().is_over());
    EXPECT_EQ(first().state(kSource), State::kNotCreated);
    EXPECT_EQ(rtpus->take(PostKind::kReport).size(), is_alone ? 0u : 1u);
  }
}

TEST_F(EdgeTest, TheEndDoesNotWaitForEverForAnotherRtpu) {
  all_on();
  first().edge->rtpu_end().tell(false);
  rtpus->change();
  rtpus->run(milliseconds(1100));
  EXPECT_TRUE(first().edge->rtpu_end().is_over());
}

}  // namespace
}  // namespace chimera
