// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/preemptive/label_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>

namespace chimera {
namespace {

constexpr std::int32_t kBase = 61, kCeiling = 80;

LabelledJob job(std::uint32_t task, std::int64_t deadline_ms, std::uint32_t criticality = 0) {
  LabelledJob made;
  made.task = TaskId(task);
  made.tie = task;
  made.urgency.deadline = milliseconds(deadline_ms);
  made.urgency.criticality = criticality;
  return made;
}

// Carries the changes out as the kernel would and checks every invariant after each step.
class Kernel {
 public:
  explicit Kernel(Policy policy, std::size_t capacity) : list(policy, capacity, kBase, kCeiling) {}

  void insert(const LabelledJob& job) {
    level_[job.task.index] = kCeiling;
    const auto changes = list.insert(job);
    ASSERT_FALSE(changes.empty());
    EXPECT_EQ(changes.back().task, job.task) << "its own change ends the section";
    moves += changes.size();
    apply(changes);
  }
  void remove(std::uint32_t task) {
    const auto changes = list.remove(TaskId(task));
    level_.erase(task);
    moves += changes.size();
    apply(changes);
  }
  void rekey(std::uint32_t task, const Urgency& urgency) { apply(list.rekey(TaskId(task), urgency)); }

  // Job that the kernel would run: the one at the highest level; "?" if two share it.
  std::string runs() const {
    std::int32_t top = 0;
    std::string who;
    for (const auto& [task, level] : level_) {
      if (level == top) who = "?";
      if (level > top) {
        top = level;
        who = std::to_string(task);
      }
    }
    return who;
  }

  LabelList list;
  std::size_t moves = 0;

 private:
  void apply(std::span<const LevelChange> changes) {
    for (const LevelChange& change : changes) level_.at(change.task.index) = change.level;
    const auto jobs = list.jobs();
    ASSERT_EQ(jobs.size(), level_.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      EXPECT_EQ(level_.at(jobs[i].task.index), jobs[i].level) << "the kernel has the level of the list";
      EXPECT_LT(jobs[i].level, kCeiling);
      if (i < list.parked()) {
        EXPECT_EQ(jobs[i].level, kBase);
      } else {
        EXPECT_GT(jobs[i].level, i == 0 ? kBase : jobs[i - 1].level);
      }
      if (i > 0) {
        EXPECT_FALSE(is_more_urgent(list.policy(), jobs[i - 1].urgency, jobs[i].urgency)) << "ascending urgency";
      }
    }
    if (list.size() > 1) {
      EXPECT_LE(list.parked(), list.size() - 1) << "the running job has a level of its own";
    }
  }

  std::map<std::uint32_t, std::int32_t> level_;
};

TEST(LabelList, TheMostUrgentJobHasTheHighestLevel) {
  Kernel k(Policy::kEdf, 4);
  k.insert(job(0, 20));
  k.insert(job(1, 10));
  k.insert(job(2, 30));
  EXPECT_EQ(k.runs(), "1");
  k.remove(1);
  EXPECT_EQ(k.runs(), "0");
  k.remove(0);
  EXPECT_EQ(k.runs(), "2");
}

TEST(LabelList, AFullTieKeepsTheRunningJobOrFollowsTheOrderOfTheTasks) {
  Kernel k(Policy::kEdf, 4);
  k.insert(job(2, 10));
  k.insert(job(1, 10));
  EXPECT_EQ(k.runs(), "1");
  k.list.dispatch(TaskId(1u));
  k.insert(job(0, 10));
  EXPECT_EQ(k.runs(), "1");
  k.remove(1);
  EXPECT_EQ(k.runs(), "0");
}

TEST(LabelList, CriticalityComesBeforeTheDeadlineUnderMuf) {
  Kernel k(Policy::kMuf, 2);
  k.insert(job(0, 10, 0));
  k.insert(job(1, 90, 2));
  EXPECT_EQ(k.runs(), "1");
}

TEST(LabelList, AJobWhoseUrgencyFallsGoesDown) {
  Kernel k(Policy::kEdf, 3);
  k.insert(job(0, 10));
  k.insert(job(1, 20));
  k.rekey(0, job(0, 40).urgency);
  EXPECT_EQ(k.runs(), "1");
  k.rekey(5, job(5, 1).urgency);  // has no job
  EXPECT_EQ(k.list.size(), 2u);
}

TEST(LabelList, TwoHundredJobsAtOnceCostAFewMovesEachAndComeOutInOrder) {
  Kernel k(Policy::kEdf, 200);
  std::vector<std::uint32_t> order(200);
  for (std::uint32_t i = 0; i < 200; ++i) order[i] = i;
  std::mt19937 random(1);
  std::shuffle(order.begin(), order.end(), random);
  for (const std::uint32_t task : order) k.insert(job(task, task + 1));
  for (std::uint32_t task = 0; task < 200; ++task) {
    ASSERT_EQ(k.runs(), std::to_string(task));
    k.remove(task);
  }
  EXPECT_LE(k.moves, 200u * 4);
}

TEST(LabelList, KeepsItsInvariantsOverRandomEntries) {
  for (const Policy policy : {Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity}) {
    std::mt19937 source(static_cast<unsigned>(policy) + 1);
    const auto random = [&source] { return static_cast<std::uint32_t>(source()); };
    Kernel k(policy, 60);
    std::vector<bool> ready(60);
    for (int step = 0; step < 20'000 && !::testing::Test::HasFailure(); ++step) {
      const std::uint32_t task = random() % 60;
      const auto fresh = [&] {
        LabelledJob made = job(task, random() % 40, random() % 3);
        made.urgency.period = milliseconds(random() % 10 + 1);
        made.urgency.user_priority = random() % 2;
        return made;
      };
      if (!ready[task]) k.insert(fresh());
      else if (random() % 4 == 0) k.rekey(task, fresh().urgency);
      else k.remove(task);
      if (ready[task] && k.list.jobs().size() > 0) k.list.dispatch(k.list.jobs().back().task);
      const auto jobs = k.list.jobs();
      ready[task] = std::any_of(jobs.begin(), jobs.end(), [&](const auto& j) { return j.task.index == task; });
    }
  }
}

}  // namespace
}  // namespace chimera
