// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/task_classes.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace chimera {
namespace {

TaskSpec spec(std::int64_t period, std::int64_t offset = 0, std::uint32_t user = 0) {
  TaskSpec t;
  t.period = t.deadline = milliseconds(period);
  t.offset = milliseconds(offset);
  t.user_priority = user;
  return t;
}

struct TaskClassesTest : ::testing::Test {
  // The active members in their order, as letters.
  std::string active(std::uint32_t index) const {
    std::string order;
    for (std::uint32_t i = 0; i < classes[index].active; ++i)
      order += static_cast<char>('A' + classes.member(classes[index], i).task);
    return order;
  }
  void begin_run(std::uint32_t index) {
    TaskClass& c = classes[index];
    c.release = c.next;
    c.next = c.release + c.period;
    c.cursor = 0;
  }

  std::array<TaskSpec, 5> tasks{spec(10), spec(5), spec(10, 0, 7), spec(10, 2), spec(10)};
  std::array<ClassMember, 5> members;
  std::array<TaskClass, 5> memory;
  std::array<std::uint32_t, 5> class_of{};
  TaskClasses classes{Policy::kRm, tasks, {members, memory, class_of}};
};

TEST_F(TaskClassesTest, AreOfOnePeriodAndOffset) {
  EXPECT_EQ(class_of, (std::array<std::uint32_t, 5>{0, 1, 0, 2, 0}));
  EXPECT_EQ(classes[0].size, 3u);
  EXPECT_EQ(classes[2].offset, milliseconds(2));
  EXPECT_FALSE(classes.is_active(0));
}

TEST_F(TaskClassesTest, KeepTheirActiveMembersInTheOrderOfUrgency) {
  for (const std::uint32_t task : {4u, 0u, 2u}) classes.activate(task, {});
  EXPECT_EQ(active(0), "CAE") << "user priority first, then the order of the tasks";
  classes.deactivate(0);
  EXPECT_EQ(active(0), "CE");
  EXPECT_FALSE(classes.is_active(0));
  EXPECT_TRUE(classes.is_active(4));
  EXPECT_EQ(classes[0].cursor, classes[0].active) << "no run is under way";
}

TEST_F(TaskClassesTest, KeepEqualsInTheOrderOfTheirPlaces) {
  tasks[0].place = 2;
  tasks[2].place = 3;
  tasks[4].place = 1;
  for (const std::uint32_t task : {0u, 4u, 2u}) classes.activate(task, {});
  EXPECT_EQ(active(0), "CEA") << "user priority first, then the place";
}

TEST_F(TaskClassesTest, ReleaseOnTheGridFromTheirOrigin) {
  classes.set_origin(milliseconds(100));
  classes.activate(3, milliseconds(113));
  EXPECT_EQ(classes.member(classes[2], 0).first, milliseconds(122));
  EXPECT_EQ(classes[2].next, milliseconds(122));
  classes.activate(1, milliseconds(105));
  EXPECT_EQ(classes[1].next, milliseconds(105)) << "an instant of the grid itself";
}

TEST_F(TaskClassesTest, LetANewcomerWaitForTheNextRelease) {
  classes.activate(0, {});
  classes.activate(4, {});
  begin_run(0);
  classes[0].cursor = 1;  // A is running
  classes.activate(2, {});
  EXPECT_EQ(active(0), "CAE");
  EXPECT_EQ(classes.task_at_cursor(0), 4u) << "the run goes on where it was";
  EXPECT_EQ(classes.member(classes[0], 0).first, milliseconds(10));
  classes.deactivate(2);
  EXPECT_EQ(classes.task_at_cursor(0), 4u);
}

TEST_F(TaskClassesTest, OrderRunsByTheirHeads) {
  classes.activate(0, {});
  classes.activate(1, {});
  begin_run(0);
  begin_run(1);
  EXPECT_TRUE(classes.run_goes_before(1, 0)) << "the shorter period";
  EXPECT_FALSE(classes.run_goes_before(0, 1));
  EXPECT_EQ(classes.urgency(0).deadline, milliseconds(10));
}

}  // namespace
}  // namespace chimera
