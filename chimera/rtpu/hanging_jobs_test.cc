// SPDX-License-Identifier: Apache-2.0
#include "chimera/rtpu/hanging_jobs.h"

#include <gtest/gtest.h>
#include <poll.h>

namespace chimera {
namespace {

bool is_readable(int descriptor) {
  pollfd asked{descriptor, POLLIN, 0};
  return ::poll(&asked, 1, 0) == 1;
}

TEST(HangingJobs, TellTheLastThatWasNotedAndItsAge) {
  HangingJobs jobs(3);
  EXPECT_FALSE(jobs.any());
  const TaskWord job(TaskId(2u), Method::kCycle);
  jobs.note(TaskWord(TaskId(0u), Method::kOn), seconds(1), {});
  jobs.note(job, milliseconds(40), milliseconds(30));
  EXPECT_TRUE(jobs.any());
  EXPECT_EQ(jobs.job(), job.word());
  EXPECT_EQ(jobs.age(), milliseconds(40));
  EXPECT_EQ(jobs.used(), milliseconds(30));
}

TEST(HangingJobs, AreThoseOfTheTasksThatWereNoted) {
  HangingJobs jobs(3);
  jobs.note(TaskWord(TaskId(1u), Method::kCycle), {}, {});
  EXPECT_FALSE(jobs.has(TaskId(0u)));
  EXPECT_TRUE(jobs.has(TaskId(1u)));
}

TEST(HangingJobs, WakeTheSupervisorWhenOneIsNoted) {
  HangingJobs jobs(1);
  jobs.wake_supervisor();  // there is none
  const auto event = WakeEvent::open(Message("test"));
  ASSERT_TRUE(event.has_value());
  jobs.set_supervisor(event->descriptor());
  EXPECT_FALSE(is_readable(event->descriptor()));
  jobs.note(TaskWord(TaskId(0u), Method::kCycle), {}, {});
  EXPECT_TRUE(is_readable(event->descriptor()));
}

}  // namespace
}  // namespace chimera
