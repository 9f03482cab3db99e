// SPDX-License-Identifier: Apache-2.0
// Jobs at real-time levels: the kernel runs the most urgent one, and takes the processor from a job that used its
// budget or its capacity; a late job is reported while it runs. Each test ends with an event: a job computes until it
// sees something that only another job can do. What the executor decides is proved on a stepped clock
// (chimera/runtime/preemptive/).
#include <gtest/gtest.h>

#include <atomic>
#include <string>

#include "chimera/base/testing/await.h"
#include "tests/conformance/by_threads.h"
#include "tests/conformance/listener.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

constexpr int kEnough = 5;  // jobs of a task that must run while another task is in their way

class Levels : public ::testing::TestWithParam<Policy> {
 protected:
  void SetUp() override {
    if (!may_be_realtime(kCeiling)) GTEST_SKIP() << "no real-time rights: the kernel does not order the jobs";
  }
  TaskSpec& add(const std::string& name, Nanoseconds period, std::uint32_t criticality) {
    TaskSpec& spec = app_.add(name, period);
    spec.criticality = criticality;
    return spec;
  }
  /// Runs `act` in each job of the task, before the job ends.
  void each_job(const std::string& task, std::function<void()> act) {
    app_.toy(task).during = [act](const chimera_call&) { return act(), CHIMERA_OK; };
  }
  void first_job(const std::string& task, std::function<void()> act) {
    each_job(task, [act, n = 0]() mutable {
      if (n++ == 0) act();
    });
  }
  /// Runs until end().
  void run(ProcessorPlace place = checked_place(), std::span<const ScriptAct> acts = {}) {
    place.bell = &bell_;
    RunOptions options;
    options.policy = GetParam();
    options.guest = &listener_;
    options.stop = &ends_;
    options.script = Script(acts);
    PreemptiveExecutor executor(app_.build_preemptive(), options, place);
    at_the_ceiling([&] {
      ASSERT_TRUE(executor.start());
      EXPECT_EQ(executor.run(kHangLimit), RunEnd::kStopped);
    });
    EXPECT_EQ(executor.counts().wrong_levels, 0u);
    EXPECT_EQ(executor.counts().section_taken, 0u) << "the order of the levels excludes";
    EXPECT_GT(executor.counts().checked, 0u);
  }
  void end() {
    ends_ = true;
    Doorbell(bell_).ring();
  }
  template <class Holds>
  static void compute_until(Holds holds) {
    const Nanoseconds limit = LinuxClock().now() + kHangLimit;
    while (!holds())
      if (LinuxClock().now() > limit) return ADD_FAILURE() << "no other job ran";
  }
  const Profile& profile(const char* task) { return app_.task(task).profile; }

  Application app_;
  std::atomic<std::uint32_t> bell_{0};
  Listener listener_{bell_};
  std::atomic<bool> ends_{false};
  std::atomic<int> jobs_{0};  // of the other task
};

INSTANTIATE_TEST_SUITE_P(Of, Levels, ::testing::Values(Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity),
                         name_of);

TEST_P(Levels, MoreUrgentJobPreemptsAndLessUrgentOneWaits) {
  std::atomic<int> ticks{0};
  add("urgent", milliseconds(2), 1);
  add("slow", kHangLimit, 0);
  app_.toy("urgent").during = [&](const chimera_call& call) {
    const int before = ticks;
    call.host->spend(call.context, microseconds(100).count);
    EXPECT_EQ(ticks, before) << "one job at a time";
    ++jobs_;
    return CHIMERA_OK;
  };
  each_job("slow", [&] {
    compute_until([&, from = jobs_.load()] { return ++ticks, jobs_ >= from + kEnough; });
    end();
  });
  run();
  EXPECT_GT(profile("slow").preempted, 0u);
  EXPECT_EQ(profile("urgent").preempted, 0u);
  expect_every_release(app_.own_calls("urgent"), milliseconds(2));
}

TEST_P(Levels, JobOverItsBudgetRunsBelowTheOthers) {
  TaskSpec& bad = add("bad", milliseconds(5), 1);
  bad.budget = milliseconds(20);  // ten times as much, and the job is given up
  bad.on_overrun = OnMiss::kDemote;
  add("good", milliseconds(10), 0);
  each_job("good", [&] { ++jobs_; });
  first_job("bad", [&] {
    compute_until([&, from = jobs_.load()] { return jobs_ >= from + kEnough; });
    end();
  });
  run();
  EXPECT_GE(profile("bad").demoted, 1u);
  EXPECT_GE(profile("bad").overrun, 1u);
}

// Five jobs of the other task take longer than the budget: execution time counts, elapsed time does not.
TEST_P(Levels, JobThatWaitsLetsTheOthersRun) {
  TaskSpec& bad = add("bad", milliseconds(5), 1);
  bad.budget = milliseconds(20);
  bad.on_overrun = OnMiss::kDemote;
  add("good", milliseconds(10), 0);
  std::atomic<std::uint32_t> word{0};
  each_job("good", [&] {
    if (++jobs_ == kEnough + 1) Doorbell(word).ring();
  });
  first_job("bad", [&] {
    while (Doorbell(word).read() == 0) (void)Doorbell(word).wait_until(0, kNever);
    end();
  });
  run();
  EXPECT_EQ(profile("bad").demoted, 0u);
}

TEST_P(Levels, ServedJobIsHaltedWithoutCapacityAndGoesOnWithNewOne) {
  TaskSpec& served = add("served", milliseconds(10), 1);
  served.aperiodic = true;
  served.server = ServerSpec{ServerKind::kDeferrable, milliseconds(2), milliseconds(10)};
  add("other", milliseconds(20), 0);
  each_job("other", [&] { ++jobs_; });
  each_job("served", [&] {
    compute_until([&, from = jobs_.load()] { return jobs_ >= from + 2; });
    end();
  });
  const ScriptAct ring[] = {{milliseconds(3), ScriptAct::Kind::kSignal, Signal::kWakeup, app_.id("served")}};
  run(checked_place(), ring);
  EXPECT_EQ(profile("served").cycles, 1u);
  EXPECT_GE(profile("served").exhausted, 1u);
}

TEST_P(Levels, LateJobIsReportedWhileItComputes) {
  std::atomic<bool> is_reported{false};
  Nanoseconds deadline;
  add("bad", milliseconds(25), 1).deadline = milliseconds(5);
  listener_.on_miss = [&](TaskId, const MissCause::Verdict&) { is_reported = true; };
  app_.toy("bad").during = [&](const chimera_call& call) {
    if (deadline == Nanoseconds{}) deadline = Nanoseconds{call.deadline_ns};
    compute_until([&] { return is_reported.load(); });
    end();
    return CHIMERA_OK;
  };
  run();
  ASSERT_FALSE(listener_.misses.empty());
  record_duration("from_deadline_to_report", listener_.misses[0].told - deadline);
}

TEST_P(Levels, JobThatNeverRanIsReportedWhileAnotherComputes) {
  std::atomic<bool> is_reported{false};
  add("starves", milliseconds(50), 0).deadline = milliseconds(2);
  add("long", milliseconds(10), 1).deadline = milliseconds(1);
  listener_.on_miss = [&](TaskId task, const MissCause::Verdict&) {
    if (task == app_.id("starves")) is_reported = true;
  };
  first_job("long", [&] {
    compute_until([&] { return is_reported.load(); });
    end();
  });
  run();
}

class LevelsByCriticality : public Levels {};
INSTANTIATE_TEST_SUITE_P(Of, LevelsByCriticality, ::testing::Values(Policy::kMuf), name_of);

// The important task may use more than the share, so the other one, which waits for it, is demoted. A signal ends the
// job that waits, and the next job of that task runs at a level again.
TEST_P(LevelsByCriticality, JobDemotedForTheShareLeavesTheNextOneItsLevel) {
  std::atomic<bool> has_given_way{false};
  TaskSpec& important = add("important", milliseconds(10), 1);
  important.budget = milliseconds(9);
  TaskSpec& other = add("other", milliseconds(20), 0);
  other.budget = milliseconds(1);
  other.offset = milliseconds(5);
  listener_.on_gave_way = [&](TaskId task) {
    if (task == app_.id("other")) has_given_way = true;
  };
  first_job("important", [&] { compute_until([&] { return has_given_way.load(); }); });
  app_.toy("important").sends = {{Signal::kOff, "other"}, {Signal::kOn, "other"}};
  each_job("other", [&] {
    if (++jobs_ == kEnough) end();
  });
  ProcessorPlace place = checked_place();
  place.share = milliseconds(60);
  place.window = milliseconds(100);
  run(place);
  EXPECT_GE(profile("other").demoted, 1u);
}

}  // namespace
}  // namespace chimera::toy
