// SPDX-License-Identifier: Apache-2.0
// The parts of an edge: signals that are carried out, tasks that join and leave, what jobs left for others.
#include "chimera/runtime/cycle/boundary_signals.h"

#include <gtest/gtest.h>

#include "chimera/runtime/cycle/releases.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/test_application.h"
#include "chimera/runtime/virtual/modelled_clock.h"

namespace chimera {
namespace {

struct Sender {  // signals the other task if `turns_off` is set
  Out<double> x{"x", "1", initial = 0.0};
  void cycle(Cycle c) {
    *x = 1;
    if (std::exchange(turns_off, false)) c.signal(Signal::kOff, "reader");
  }
  static inline bool turns_off = false;
};

struct Reader {
  In<double> x{"x", "1"};
  void cycle(Cycle) {}
};

constexpr TaskId kSender{0u}, kReader{1u};

/// A listener at cycle boundaries that records all reports.
struct Guest final : BoundaryListener {
  explicit Guest(const std::atomic<std::uint32_t>& bell) : BoundaryListener(bell) {}
  void take(BoundarySignals& signals, Nanoseconds now) noexcept override {
    listen();
    if (turns_off_sender) (void)signals.signal({&kSender, 1}, Signal::kOff, now);
  }
  void publish() noexcept override {}
  void told(const SignalReport& report, Nanoseconds) noexcept override { reports.push_back(report); }
  void missed(TaskId task, const MissCause::Verdict&, Nanoseconds) noexcept override { misses.push_back(task); }
  void hangs(TaskWord, Nanoseconds, Nanoseconds, Nanoseconds) noexcept override {}
  void gave_way(TaskId, Nanoseconds, Nanoseconds) noexcept override {}
  void show(const Task& task) noexcept override { shown.push_back(task.id); }

  bool turns_off_sender = false;
  std::vector<SignalReport> reports;
  std::vector<TaskId> misses, shown;
};

struct EdgeSignalsTest : ::testing::Test {
  EdgeSignalsTest() {
    Sender::turns_off = false;
    app.add("sender", testing::component<Sender>("sender"));
    app.add("reader", testing::component<Reader>("reader"));
    app.make();
    set = *HeapTaskSet::create(app.spec, app.components);
    options.tap = &tap;
    options.guest = &guest;
  }
  void begin() {
    releases.emplace(*set, clock, options);
    ASSERT_TRUE(set->life().start({}));
    releases->begin({});
    guest.shown.clear();
  }
  void run_job(TaskId task, Nanoseconds at) {
    CycleTime time;
    const Job job{task, at, at + milliseconds(1)};
    ASSERT_TRUE(releases->may_start(job, at));
    const BodyEnd body = releases->jobs().open_and_begin(job, time, false);
    releases->end_job(job, time, body, at, at + microseconds(10), microseconds(10));
  }
  State state(TaskId task) const { return set->tasks()[task.index].state; }
  std::vector<TapKind> recorded() {
    std::vector<TapRecord> all(kTapRecords);
    all.resize(reader.read(all));
    std::vector<TapKind> kinds;
    for (const TapRecord& one : all) kinds.push_back(one.kind);
    return kinds;
  }

  testing::TestApplication app;
  std::unique_ptr<HeapTaskSet> set;
  std::unique_ptr<TapRing> ring = std::make_unique<TapRing>();
  Tap tap{*ring};
  TapReader reader{*ring};
  std::atomic<std::uint32_t> bell{0};
  Guest guest{bell};
  ModelledClock clock;
  RunOptions options;
  std::optional<Releases> releases;
};

TEST_F(EdgeSignalsTest, ActsOfTheScriptAreCarriedOutWhenTheyAreDue) {
  const ScriptAct acts[] = {{milliseconds(3), ScriptAct::Kind::kSignal, Signal::kOff, kReader},
                            {milliseconds(5), ScriptAct::Kind::kSignal, Signal::kOff, kReader}};
  options.script = Script(acts);
  begin();
  EXPECT_EQ(releases->signals().next_act(), milliseconds(3));
  releases->take_edge(milliseconds(2));
  EXPECT_EQ(state(kReader), State::kOn);
  releases->take_edge(milliseconds(3));
  EXPECT_EQ(state(kReader), State::kOff);
  EXPECT_TRUE(releases->signals().refused().empty());
  releases->take_edge(milliseconds(5));
  ASSERT_EQ(releases->signals().refused().size(), 1u) << "it is OFF already";
  EXPECT_EQ(releases->signals().refused()[0].why, Refusal::kState);
  EXPECT_EQ(releases->signals().next_act(), kNever);
  ASSERT_EQ(guest.reports.size(), 2u);
  EXPECT_FALSE(guest.reports[1].is_accepted);
}

TEST_F(EdgeSignalsTest, AnActOnATaskWithAJobUnderWayWaitsForTheJob) {
  const ScriptAct acts[] = {{milliseconds(1), ScriptAct::Kind::kSignal, Signal::kOff, kSender}};
  options.script = Script(acts);
  begin();
  releases->jobs().open(kSender);
  EXPECT_FALSE(releases->signals().may_touch(kSender));
  releases->take_edge(milliseconds(1));
  EXPECT_EQ(state(kSender), State::kOn);
  releases->jobs().close(kSender);
  run_job(kSender, milliseconds(1));
  EXPECT_TRUE(releases->edge_is_due(milliseconds(2)));
  releases->take_edge(milliseconds(2));
  EXPECT_EQ(state(kSender), State::kOff);
}

TEST_F(EdgeSignalsTest, ASignalThatATaskSentIsCarriedOutAtTheNextEdge) {
  begin();
  Sender::turns_off = true;
  run_job(kSender, milliseconds(1));
  EXPECT_EQ(state(kReader), State::kOn);
  EXPECT_TRUE(releases->must_look(milliseconds(1)));
  releases->take_edge(milliseconds(2));
  EXPECT_EQ(state(kReader), State::kOff);
  EXPECT_FALSE(releases->members().is_on(kReader));
  EXPECT_TRUE(releases->members().is_on(kSender));
}

TEST_F(EdgeSignalsTest, TheFlagThatASignalRaisesIsRecordedWithIt) {
  begin();
  (void)recorded();
  guest.turns_off_sender = true;
  releases->take_edge(milliseconds(2));
  const std::vector expected{TapKind::kSignal, TapKind::kFlag, TapKind::kState};
  EXPECT_EQ(recorded(), expected) << "the reader has no producer that is ON";
  EXPECT_TRUE(releases->is_illegal());
  EXPECT_TRUE(guest.reports.empty()) << "its own signal is not reported to it";
}

TEST_F(EdgeSignalsTest, TasksJoinAndLeaveWithTheirStatesAndShowTheirProfiles) {
  begin();
  EXPECT_TRUE(releases->members().is_any_on());
  const TaskId both[] = {kSender, kReader};
  for (const TaskId task : both) (void)releases->signals().signal({&task, 1}, Signal::kOff, milliseconds(1));
  EXPECT_TRUE(releases->members().is_on(kSender)) << "until the members follow";
  releases->members().follow_all(milliseconds(1));
  EXPECT_FALSE(releases->members().is_any_on());
  EXPECT_EQ(guest.shown, std::vector(std::begin(both), std::end(both)));
  EXPECT_EQ(releases->queue().next_release(), kNever);
}

TEST_F(EdgeSignalsTest, AMemberWithAJobUnderWayLeavesAfterIt) {
  begin();
  (void)releases->signals().signal({&kReader, 1}, Signal::kOff, milliseconds(1));
  releases->jobs().open(kReader);
  releases->members().follow_all(milliseconds(1));
  EXPECT_TRUE(releases->members().is_on(kReader));
  releases->jobs().close(kReader);
  releases->members().follow_all(milliseconds(2));
  EXPECT_FALSE(releases->members().is_on(kReader));
}

TEST_F(EdgeSignalsTest, ReactionsOfAJobAreSettledOnce) {
  begin();
  app.tasks[0].on_miss = OnMiss::kStop;
  releases->misses().report_late({kSender, milliseconds(1), milliseconds(2)}, true);
  EXPECT_TRUE(releases->settlement().is_unsettled(kSender));
  releases->settle_job(kSender, milliseconds(3));
  EXPECT_FALSE(releases->settlement().is_unsettled(kSender));
  EXPECT_TRUE(releases->settlement().task_stopped());
  EXPECT_EQ(releases->settlement().stopped_by(), kSender);
  EXPECT_EQ(guest.misses, std::vector{kSender}) << "the cause is reported";
  releases->settlement().forget_stop();
  releases->settle_job(kSender, milliseconds(4));
  EXPECT_FALSE(releases->settlement().task_stopped());
}

TEST_F(EdgeSignalsTest, TheReactionFlagRaisesItForAsLongAsTheTaskIsOn) {
  app.tasks[0].on_miss = OnMiss::kFlag;
  begin();
  releases->misses().report_late({kSender, milliseconds(1), milliseconds(2)}, true);
  releases->settlement().settle_at_once(kSender, milliseconds(3));
  EXPECT_TRUE(releases->is_illegal());
  const TaskId both[] = {kReader, kSender};
  for (const TaskId task : both) (void)releases->signals().signal({&task, 1}, Signal::kOff, milliseconds(4));
  EXPECT_FALSE(releases->is_illegal());
}

TEST_F(EdgeSignalsTest, ATaskThatOthersNeverLetStartIsGivenUp) {
  app.tasks[1].max_consecutive = 2;
  begin();
  releases->misses().drop({kReader, milliseconds(2), 2});
  releases->settlement().give_up_starved(milliseconds(3));
  EXPECT_EQ(state(kReader), State::kError);
  EXPECT_FALSE(releases->members().is_on(kReader));
  EXPECT_FALSE(releases->misses().has_lost_patience());
}

}  // namespace
}  // namespace chimera
