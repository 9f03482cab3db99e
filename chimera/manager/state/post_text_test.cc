// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/state/post_text.h"

#include <gtest/gtest.h>

#include "chimera/manager/state/cause.h"

namespace chimera::manager {
namespace {

const TaskId kLaw(0u), kLog(1u);

/// Two tasks, of which `law` has a budget of 300 us.
struct PostText : ::testing::Test {
  PostText() {
    tasks[0].name = "law";
    tasks[0].budget = microseconds(300);
    tasks[1].name = "log";
    tasks[1].period = milliseconds(100);
    spec.tasks = tasks;
  }

  std::string text(EventKind happening, TaskId task, TaskId from, Nanoseconds detail) const {
    Post post;
    post.happening = happening;
    post.task = task;
    post.from = from;
    post.detail = static_cast<std::uint64_t>(detail.count);
    return event_text(spec, post, "");
  }

  TaskSpec tasks[2];
  ApplicationSpec spec;
};

TEST_F(PostText, AMissNamesItsCauseWithTimeAndBudget) {
  EXPECT_EQ(text(EventKind::kMissed, kLaw, kLaw, milliseconds(26)),
            "missed its deadline: it used 26 ms (budget 300 us)");
  EXPECT_EQ(text(EventKind::kMissed, kLog, kLaw, Nanoseconds{853}),
            "missed its deadline: law used 853 ns (budget 300 us)");
  EXPECT_EQ(text(EventKind::kMissed, kLaw, kLog, microseconds(40)),
            "missed its deadline: log used 40 us (no budget stated)");
}

TEST_F(PostText, AMissWithoutATaskOfTheRtpuNamesOtherUsersOfTheCpu) {
  EXPECT_EQ(text(EventKind::kMissed, kLaw, TaskId{}, microseconds(2270)),
            "missed its deadline: no task of its rtpu ran for 2.27 ms: the CPU was taken by the kernel, RT "
            "throttling or another process");
}

TEST_F(PostText, AJobThatWaitsHangsOrIsDemotedSaysItsTime) {
  EXPECT_EQ(text(EventKind::kBlocked, kLaw, TaskId{}, microseconds(20)),
            "missed its deadline: it waits in a system call (it used 20 us)");
  EXPECT_EQ(text(EventKind::kHang, kLaw, TaskId{}, seconds(3)),
            "its job has not ended 3 s after its release: this rtpu ends");
  Post overuse;
  overuse.happening = EventKind::kHang;
  overuse.task = kLaw;
  overuse.used = overuse.detail = 3'100'000;
  EXPECT_EQ(event_text(spec, overuse, ""), "this rtpu ends: its job used 3.1 ms, 10 x its budget of 300 us: raise "
                                           "budget, or say on_overrun: abort and heed expired()");
  EXPECT_EQ(overuse_text(spec.tasks[kLog.index], seconds(1)).substr(0, 14), "used 1 s, 10 x") << "without a budget";
  EXPECT_EQ(text(EventKind::kHang, kLaw, TaskId{}, {}), "its thread ended in a cycle: this rtpu ends");
  EXPECT_EQ(text(EventKind::kGaveWay, kLaw, TaskId{}, milliseconds(930)),
            "demoted below all other threads: the tasks of its rtpu used 930 ms lately, nearly all that the "
            "kernel leaves to real-time threads");
}

TEST_F(PostText, ATakeoverSaysFromWhomAndHowSoon) {
  EXPECT_EQ(text(EventKind::kTakeover, kLaw, kLog, microseconds(37)),
            "is ON in place of log, 37 us after its rtpu found that one lost");
  EXPECT_EQ(text(EventKind::kTakeover, kLaw, TaskId{}, microseconds(37)), "is ON in place of another task");
}

TEST_F(PostText, ARefusedListSaysThatAnotherTaskWasRefused) {
  EXPECT_EQ(text(EventKind::kRefused, kLaw, kLog, {}), "on sent by log: another task of the list was refused");
}

}  // namespace
}  // namespace chimera::manager
