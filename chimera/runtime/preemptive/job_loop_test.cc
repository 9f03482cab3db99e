// SPDX-License-Identifier: Apache-2.0
// The loop ends itself out of the body of a job, or is asked to end by the test. Periods are many seconds long, so that
// the number of releases does not depend on the speed of the machine.
#include "chimera/runtime/preemptive/job_loop.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "chimera/runtime/testing/preemptive_parts.h"

namespace chimera {
namespace {

struct JobLoopTest : testing::PreemptiveParts, ::testing::Test {
  ~JobLoopTest() override { testing::Idle::during_cycle = nullptr; }
  void make_loop(ProcessorPlace where = {}) {
    make(Policy::kEdf, where);
    loop = std::make_unique<JobLoop>(*set, releases(), ready(), checks(), processor(), supervisor(), thread_clock,
                                     &parts->guest);
  }
  /// Outside the section, as the body is.
  void in_section(const std::function<void()>& act) {
    processor().enter();
    act();
    processor().leave();
  }
  void quit() {
    in_section([this] { loop->quit(); });
  }
  /// The loop of the task runs in this thread; `body` in each of its jobs, and after `n_jobs` it ends.
  void run(std::uint32_t task, int n_jobs, std::function<void()> body = {}) {
    testing::Idle::during_cycle = [=, this, n = 0]() mutable {
      if (body) body();
      if (++n == n_jobs) quit();
    };
    loop->run(job(task), n_attached);
  }
  /// The loop of the task has its own thread, which sleeps now.
  void start_and_await_sleep(std::uint32_t task) {
    job(task).start([this, task] { loop->run(job(task), n_attached); });
    while (n_attached.load() == 0 || !is_asleep(job(task).thread())) std::this_thread::yield();
  }
  void end_thread(std::uint32_t task) {
    quit();
    job(task).wake();
    job(task).join();
  }
  std::uint64_t cycles(std::uint32_t task) { return job(task).task.profile.cycles; }
  static Nanoseconds now() { return LinuxClock().now(); }

  ThreadClock thread_clock;
  std::unique_ptr<JobLoop> loop;
  std::atomic<std::size_t> n_attached{0};
};

TEST_F(JobLoopTest, RunsAJobFromItsReleaseToItsEnd) {
  add("one", seconds(100));
  make_loop();
  const Nanoseconds due = job(0).next_release = now() - seconds(1);
  bool was_ready = false;
  run(0, 1, [&] {
    in_section([&] { was_ready = ready().most_urgent() == &job(0) && job(0).phase.is_running(); });
  });
  EXPECT_TRUE(was_ready);
  EXPECT_EQ(n_attached, 1u);
  EXPECT_EQ(cycles(0), 1u);
  EXPECT_EQ(job(0).job.release, due);
  EXPECT_EQ(job(0).job.deadline, due + seconds(100));
  EXPECT_EQ(job(0).next_release, due + seconds(100));
  EXPECT_TRUE(job(0).phase.is_idle());
  EXPECT_FALSE(job(0).task.is_busy);
  EXPECT_EQ(ready().size(), 0u);
  EXPECT_EQ(checks().due(job(0)), kNever);
  EXPECT_EQ(processor().seen().jobs, 1u);
  EXPECT_EQ(processor().seen().ended_unseen, 0u);
}

TEST_F(JobLoopTest, TakesTheNewestReleaseAndDropsTheOthers) {
  add("one", seconds(100));
  make_loop();
  const Nanoseconds first = job(0).next_release = now() - seconds(350);
  run(0, 1);
  EXPECT_EQ(job(0).job.release, first + seconds(300));
  EXPECT_EQ(job(0).next_release, first + seconds(400));
  EXPECT_EQ(job(0).task.profile.dropped, 3u);
}

TEST_F(JobLoopTest, ForgetsTheStateOfTheJobBefore) {
  add("one", seconds(100));
  make_loop();
  job(0).next_release = now() - seconds(1);
  job(0).is_demoted = true;
  job(0).task.give_up.store(true, std::memory_order_relaxed);
  run(0, 1, [&] {
    EXPECT_FALSE(job(0).is_demoted);
    EXPECT_FALSE(job(0).task.give_up.load(std::memory_order_relaxed));
  });
}

TEST_F(JobLoopTest, ATaskThatAnEdgeAwaitsIsHeldAtTheEndOfItsJob) {
  add("one", seconds(100));
  make_loop();
  job(0).next_release = now() - seconds(1);
  const std::uint32_t rung = processor().edge_bell().read();
  run(0, 1, [&] { in_section([&] { job(0).is_awaited = true; }); });
  EXPECT_TRUE(job(0).is_held);
  EXPECT_FALSE(job(0).is_awaited);
  EXPECT_NE(processor().edge_bell().read(), rung);
}

TEST_F(JobLoopTest, AnEdgeThatAwaitsNothingIsNotAskedFor) {
  add("one", seconds(100));
  make_loop();
  job(0).next_release = now() - seconds(1);
  const std::uint32_t rung = processor().edge_bell().read();
  run(0, 1);
  EXPECT_FALSE(job(0).is_held);
  EXPECT_EQ(processor().edge_bell().read(), rung);
}

TEST_F(JobLoopTest, CountsAJobThatEndedWhenAMoreUrgentOneWasThere) {
  add("one", seconds(100));
  add("urgent", seconds(10));
  make_loop();
  job(0).next_release = now() - seconds(1);
  run(0, 1, [&] { in_section([&] { release(1, now()); }); });
  EXPECT_EQ(processor().seen().ended_unseen, 1u);
  EXPECT_EQ(ready().most_urgent(), &job(1));
}

TEST_F(JobLoopTest, BeginsNothingWhileItsTaskIsOffOrHeldOrEverythingIsPaused) {
  add("one", seconds(100));
  ProcessorPlace counting;
  counting.checks = true;
  make_loop(counting);
  job(0).next_release = now() - seconds(1);
  job(0).is_on = false;
  start_and_await_sleep(0);
  const auto waits_when = [this](bool is_on, bool is_held, bool is_paused) {
    std::uint64_t entries = 0, mine = 0;  // to the section: once more than mine, and the thread has looked
    in_section([&] {
      job(0).is_on = is_on;
      job(0).is_held = is_held;
      is_paused ? processor().pause() : processor().go_on();
      entries = processor().counts().checked;
    });
    job(0).wake();
    for (bool has_looked = false, is_idle = false;;) {
      ++mine;
      in_section([&] {
        has_looked = processor().counts().checked > entries + mine;
        is_idle = job(0).phase.is_idle();
      });
      if (has_looked) return is_idle;
      std::this_thread::yield();
    }
  };
  EXPECT_TRUE(waits_when(true, true, false));
  EXPECT_TRUE(waits_when(true, false, true));
  in_section([this] { job(0).release_end = job(0).next_release; });
  EXPECT_TRUE(waits_when(true, false, false)) << "the run ends with that release";
  end_thread(0);
  EXPECT_EQ(cycles(0), 0u);
}

TEST_F(JobLoopTest, HoldsATaskThatOthersNeverLetStart) {
  add("one", seconds(100)).max_consecutive = 2;
  make_loop();
  job(0).next_release = now() - seconds(350);
  const std::uint32_t rung = processor().edge_bell().read();
  start_and_await_sleep(0);
  EXPECT_TRUE(job(0).is_held);
  EXPECT_NE(processor().edge_bell().read(), rung);
  end_thread(0);
  EXPECT_EQ(cycles(0), 0u);
  EXPECT_EQ(job(0).task.profile.dropped, 3u);
}

TEST_F(JobLoopTest, ShowsTheProfileOfATaskWhichNoJobIsWriting) {
  add("one", seconds(100));
  make_loop();
  job(0).is_shown = false;
  const int before = parts->guest.shown;
  loop->show(job(0), seconds(3));
  EXPECT_TRUE(job(0).is_shown);
  EXPECT_EQ(job(0).shown_at, seconds(3));
  EXPECT_EQ(parts->guest.shown, before + 1);
  JobLoop unseen(*set, releases(), ready(), checks(), processor(), supervisor(), thread_clock, nullptr);
  unseen.show(job(0), seconds(4));
  EXPECT_EQ(job(0).shown_at, seconds(4));
  EXPECT_EQ(parts->guest.shown, before + 1);
}

}  // namespace
}  // namespace chimera
