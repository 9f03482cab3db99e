// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/ready_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace chimera {
namespace {

TaskSpec spec(std::int64_t period, std::int64_t budget = 1, std::uint32_t criticality = 0, std::uint32_t user = 0) {
  TaskSpec t;
  t.period = t.deadline = milliseconds(period);
  t.budget = milliseconds(budget);
  t.criticality = criticality;
  t.user_priority = user;
  return t;
}

// A queue that owns its memory and records dropped releases.
class Bench {
 public:
  Bench(Policy policy, std::vector<TaskSpec> tasks)
      : tasks_(std::move(tasks)), members_(n()), classes_(n()), of_task_(n()), loose_(n()), class_of_(n()),
        pauses_(n()), runs_(n()),
        queue(policy, tasks_, {{members_, classes_, class_of_}, of_task_, loose_, pauses_, runs_}) {}

  void join_all() {
    for (std::size_t i = 0; i < n(); ++i) queue.join(TaskId(i), Nanoseconds{});
  }
  void release(std::int64_t ms) {
    queue.release_due(milliseconds(ms), [this](const DroppedRelease& d) { dropped.push_back(d); });
  }
  // Pops all jobs; returns the tasks as letters, in order.
  std::string drain() {
    std::string order;
    while (!queue.is_empty()) order += static_cast<char>('A' + queue.pop().task.index);
    return order;
  }

 private:
  std::size_t n() const { return tasks_.size(); }
  std::vector<TaskSpec> tasks_;
  std::vector<ClassMember> members_;
  std::vector<TaskClass> classes_;
  std::vector<QueueTask> of_task_;
  std::vector<LooseJob> loose_;
  std::vector<std::uint32_t> class_of_, pauses_, runs_;

 public:
  ReadyQueue queue;
  std::vector<DroppedRelease> dropped;
};

TEST(ReadyQueue, OrdersByPeriodUnderRm) {
  Bench b(Policy::kRm, {spec(15), spec(6), spec(12), spec(10)});
  b.join_all();
  b.release(0);
  EXPECT_EQ(b.drain(), "BDCA");
  EXPECT_TRUE(b.dropped.empty());
}

TEST(ReadyQueue, OrdersByDeadlineUnderEdfAcrossClasses) {
  Bench b(Policy::kEdf, {spec(30), spec(10), spec(20)});
  b.join_all();
  b.release(0);
  EXPECT_EQ(b.drain(), "BCA");
  b.release(20);  // B again (deadline 30) and C again (40)
  EXPECT_EQ(b.drain(), "BC");
  EXPECT_EQ(b.queue.next_release(), milliseconds(30));
}

TEST(ReadyQueue, PutsCriticalityFirstUnderMuf) {
  Bench b(Policy::kMuf, {spec(5), spec(20, 1, 2), spec(10, 1, 2)});
  b.join_all();
  b.release(0);
  EXPECT_EQ(b.drain(), "CBA");
}

TEST(ReadyQueue, PutsLeastLaxityFirst) {
  Bench b(Policy::kLlf, {spec(10, 1), spec(20, 15), spec(12, 2)});
  b.join_all();
  b.release(0);
  EXPECT_EQ(b.drain(), "BAC");
}

TEST(ReadyQueue, BreaksTiesByUserPriorityThenOrderOfTheTasks) {
  Bench b(Policy::kEdf, {spec(10), spec(10), spec(10, 1, 0, 7), spec(10)});
  b.join_all();
  b.release(0);
  EXPECT_EQ(b.drain(), "CABD");
}

TEST(ReadyQueue, DropsAReleaseThatNeverStartedWhenTheNextOneComes) {
  Bench b(Policy::kEdf, {spec(10), spec(10)});
  b.join_all();
  b.release(0);
  EXPECT_EQ(b.queue.pop().task, TaskId(0u));
  b.release(10);
  ASSERT_EQ(b.dropped.size(), 1u);
  EXPECT_EQ(b.dropped[0].task, TaskId(1u));
  EXPECT_EQ(b.dropped[0].last, Nanoseconds{});
  EXPECT_EQ(b.dropped[0].count, 1u);
  EXPECT_EQ(b.drain(), "AB");
}

TEST(ReadyQueue, RunsOnlyTheNewestOfManyReleasesThatWentBy) {
  Bench b(Policy::kEdf, {spec(10)});
  b.join_all();
  b.release(0);
  (void)b.queue.pop();
  b.release(47);
  ASSERT_EQ(b.dropped.size(), 1u);
  EXPECT_EQ(b.dropped[0].count, 3u);
  EXPECT_EQ(b.queue.pop().release, milliseconds(40));
  EXPECT_TRUE(b.queue.is_empty());
  EXPECT_EQ(b.queue.next_release(), milliseconds(50));
}

TEST(ReadyQueue, KeepsTheGridForATaskThatJoinsLater) {
  TaskSpec late = spec(10);
  late.offset = milliseconds(3);
  Bench b(Policy::kEdf, {spec(10), late});
  b.queue.join(TaskId(1u), milliseconds(14));
  EXPECT_EQ(b.queue.next_release(), milliseconds(23));
  b.queue.leave(TaskId(1u));
  EXPECT_EQ(b.queue.next_release(), kNever);
  b.queue.join(TaskId(1u), milliseconds(23));
  EXPECT_EQ(b.queue.next_release(), milliseconds(23));
}

TEST(ReadyQueue, CountsTheGridFromTheOrigin) {
  Bench b(Policy::kEdf, {spec(10)});
  b.queue.set_origin(microseconds(700));
  b.queue.join(TaskId(0u), milliseconds(1));
  EXPECT_EQ(b.queue.next_release(), microseconds(10'700));
  EXPECT_EQ(b.queue.classes().first_release(0), microseconds(10'700));
}

TEST(ReadyQueue, ReleasesANewMemberWithTheFollowingReleaseOfItsClass) {
  Bench b(Policy::kEdf, {spec(10), spec(10), spec(10)});
  b.queue.join(TaskId(1u), Nanoseconds{});
  b.release(0);
  b.queue.join(TaskId(0u), Nanoseconds{});  // comes before B in the class, whose run has not started
  b.queue.join(TaskId(2u), milliseconds(1));
  EXPECT_EQ(b.drain(), "B");
  b.release(10);
  EXPECT_EQ(b.drain(), "ABC");
  EXPECT_TRUE(b.dropped.empty());
}

TEST(ReadyQueue, ForgetsTheWaitingJobOfATaskThatLeaves) {
  Bench b(Policy::kEdf, {spec(10), spec(10), spec(10)});
  b.join_all();
  b.release(0);
  b.queue.leave(TaskId(0u));
  EXPECT_EQ(b.queue.pop().task, TaskId(1u));
  b.queue.leave(TaskId(1u));
  b.queue.leave(TaskId(2u));
  EXPECT_TRUE(b.queue.is_empty());
}

TEST(ReadyQueue, DefersAReleaseWhileTheTaskIsBusy) {
  Bench b(Policy::kEdf, {spec(10), spec(10)});
  b.join_all();
  b.release(0);
  (void)b.queue.pop();
  b.queue.occupy(TaskId(0u));
  EXPECT_EQ(b.drain(), "B");
  b.release(10);
  EXPECT_EQ(b.drain(), "B");
  b.queue.finish(TaskId(0u));
  EXPECT_EQ(b.queue.pop().release, milliseconds(10));
  EXPECT_TRUE(b.dropped.empty());
}

TEST(ReadyQueue, ReplacesADeferredReleaseByANewerOne) {
  Bench b(Policy::kEdf, {spec(10)});
  b.join_all();
  b.release(0);
  (void)b.queue.pop();
  b.queue.occupy(TaskId(0u));
  b.release(10);
  b.release(20);
  ASSERT_EQ(b.dropped.size(), 1u);
  EXPECT_EQ(b.dropped[0].last, milliseconds(10));
  b.queue.finish(TaskId(0u));
  b.release(30);  // the deferred job of 20 was ready and never started
  ASSERT_EQ(b.dropped.size(), 2u);
  EXPECT_EQ(b.dropped[1].last, milliseconds(20));
  EXPECT_EQ(b.queue.pop().release, milliseconds(30));
  EXPECT_TRUE(b.queue.is_empty());
}

TEST(ReadyQueue, OrdersAPreemptedJobByItsRemainingTime) {
  Bench b(Policy::kLlf, {spec(20, 10), spec(20, 8)});
  b.join_all();
  b.release(0);
  const Job a = b.queue.pop();  // laxity 10 against 12
  b.queue.occupy(a.task);
  b.queue.put_back(a, milliseconds(5));  // now 15 - now
  EXPECT_EQ(b.drain(), "BA");
}

TEST(ReadyQueue, RemovesAWaitingJobWhereverItWaits) {
  Bench b(Policy::kEdf, {spec(10), spec(10), spec(10)});
  b.join_all();
  b.release(0);
  Job job;
  EXPECT_TRUE(b.queue.remove(TaskId(0u), job));  // head of the run
  EXPECT_TRUE(b.queue.remove(TaskId(2u), job));  // further back
  EXPECT_EQ(job.deadline, milliseconds(10));
  EXPECT_FALSE(b.queue.remove(TaskId(2u), job));
  EXPECT_EQ(b.drain(), "B");
  b.release(10);
  EXPECT_TRUE(b.dropped.empty());
  EXPECT_EQ(b.drain(), "ABC");
}

// The same rules without classes, runs or heaps: each task alone, and each choice compares all tasks.
class Plain {
 public:
  Plain(Policy policy, const std::vector<TaskSpec>& tasks) : policy_(policy), tasks_(tasks), of_(tasks.size()) {}
  void join(std::size_t i, Nanoseconds now) {
    const TaskSpec& t = tasks_[i];
    if (of_[i].on) return;
    of_[i] = {true, false, t.offset, {}};
    while (of_[i].next < now || of_[i].next <= released_) of_[i].next += t.period;
  }
  void leave(std::size_t i) { of_[i].on = of_[i].ready = false; }
  void release(Nanoseconds now) {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      for (One& o = of_[i]; o.on && o.next <= now; o.next += tasks_[i].period) {
        if (o.ready) ++n_dropped;
        o.ready = true;
        o.release = o.next;
      }
    }
    released_ = now;
  }
  std::size_t pop() {
    std::size_t best = tasks_.size();
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (of_[i].ready && (best == tasks_.size() || is_more_urgent(policy_, urgency(i), urgency(best)))) best = i;
    }
    if (best < tasks_.size()) of_[best].ready = false;
    return best;
  }
  std::uint64_t n_dropped = 0;

 private:
  struct One {
    bool on = false, ready = false;
    Nanoseconds next, release;
  };
  Urgency urgency(std::size_t i) const {
    const TaskSpec& t = tasks_[i];
    return {t.criticality, t.user_priority, t.period, of_[i].release + t.deadline, t.budget};
  }
  Policy policy_;
  std::vector<TaskSpec> tasks_;
  std::vector<One> of_;
  Nanoseconds released_{-1};
};

// A repeatable random source.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

std::vector<TaskSpec> random_tasks(Dice& random) {
  std::vector<TaskSpec> tasks(1 + random() % 12);
  for (TaskSpec& t : tasks) {
    t = spec(1 + random() % 5, 1 + random() % 3, random() % 3, random() % 2);
    t.offset = milliseconds(random() % 3);
    if (random() % 2) t.deadline = milliseconds(1);
  }
  return tasks;
}

TEST(ReadyQueue, AgreesWithThePlainRulesOnRandomSets) {
  for (std::uint32_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice random(seed);
    const auto policy = static_cast<Policy>(random() % 5);
    const auto tasks = random_tasks(random);
    Bench b(policy, tasks);
    Plain plain(policy, tasks);
    std::uint64_t n_dropped = 0;
    for (std::int64_t now = 0; now < 60; now += 1 + random() % 3) {
      const std::size_t i = random() % tasks.size();
      if (random() % 3 == 0) b.queue.leave(TaskId(i)), plain.leave(i);
      else b.queue.join(TaskId(i), milliseconds(now)), plain.join(i, milliseconds(now));
      b.queue.release_due(milliseconds(now), [&](const DroppedRelease& d) { n_dropped += d.count; });
      plain.release(milliseconds(now));
      ASSERT_EQ(n_dropped, plain.n_dropped) << "at " << now;
      for (std::uint32_t pops = random() % 6; pops > 0; --pops) {
        const std::size_t expected = plain.pop();
        ASSERT_EQ(b.queue.is_empty(), expected == tasks.size()) << "at " << now;
        if (expected == tasks.size()) break;
        ASSERT_EQ(b.queue.pop().task.index, expected) << "at " << now;
      }
    }
  }
}

}  // namespace
}  // namespace chimera
