// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/life/illegal_flag.h"

#include <gtest/gtest.h>

#include <array>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

struct Producer {
  Out<double> x{"x", "1", initial = 0.0};
  void cycle(Cycle) {}
};

struct Consumer {
  In<double> x{"x", "1"};
  void cycle(Cycle) {}
};

constexpr TaskId kProducer{0u}, kConsumer{1u};

struct IllegalFlagTest : ::testing::Test {
  IllegalFlagTest() {
    app.add("producer", testing::component<Producer>("producer"));
    app.add("consumer", testing::component<Consumer>("consumer"));
    app.make();
    for (std::size_t t = 0; t < tasks.size(); ++t) tasks[t].id = TaskId(t);
    flag.prepare(app.spec.variables, tasks, heap);
  }
  void turn(TaskId task, bool on) {
    tasks[task.index].state = on ? State::kOn : State::kOff;
    const bool now[] = {tasks[0].state == State::kOn, tasks[1].state == State::kOn};
    flag.follow(now, false, 0);
  }

  testing::TestApplication app;
  std::array<Task, 2> tasks;
  HeapMemory heap;
  IllegalFlag flag;
};

TEST_F(IllegalFlagTest, FollowsFromTheTasksThatAreOn) {
  EXPECT_FALSE(flag.is_up());
  turn(kConsumer, true);
  EXPECT_TRUE(flag.is_up()) << "no task produces what the consumer reads";
  EXPECT_FALSE(flag.is_on_set_legal());
  EXPECT_FALSE(flag.is_raised());
  turn(kProducer, true);
  EXPECT_FALSE(flag.is_up());
}

TEST_F(IllegalFlagTest, StaysUpForATaskUntilThatTaskIsOnNoMore) {
  turn(kProducer, true);
  flag.raise_for(kProducer, State::kOn);
  EXPECT_TRUE(flag.is_up());
  EXPECT_TRUE(flag.raises(kProducer));
  EXPECT_EQ(flag.raised_by(), kProducer);
  turn(kConsumer, true);
  EXPECT_TRUE(flag.is_up());
  turn(kConsumer, false);
  turn(kProducer, false);
  EXPECT_FALSE(flag.is_up());
  EXPECT_FALSE(flag.raised_by().is_valid());
}

TEST_F(IllegalFlagTest, StaysUpForAFaultUntilTheTaskIsInErrorNoMore) {
  tasks[kProducer.index].state = State::kError;
  flag.raise_for(kProducer, State::kError);
  turn(kConsumer, false);
  EXPECT_TRUE(flag.is_up());
  turn(kProducer, false);
  EXPECT_FALSE(flag.is_up());
}

TEST_F(IllegalFlagTest, LoweredByHandItIsAlsoForTasksThatHoldItUp) {
  turn(kProducer, true);
  flag.raise_for(kProducer, State::kOn);
  flag.raise(true);
  flag.raise(false);
  EXPECT_FALSE(flag.is_up());
  EXPECT_FALSE(flag.raises(kProducer));
}

TEST_F(IllegalFlagTest, LoweringDoesNotMakeASetLegal) {
  turn(kConsumer, true);
  flag.raise(true);
  flag.raise(false);
  EXPECT_TRUE(flag.is_up());
}

TEST_F(IllegalFlagTest, IsUpWhileItIsUpInAnotherProcess) {
  std::atomic<std::uint32_t> there{0};
  const std::atomic<std::uint32_t>* const words[] = {&there};
  flag.watch(words);
  EXPECT_FALSE(flag.is_up());
  there = 2;
  EXPECT_TRUE(flag.is_up());
  EXPECT_FALSE(flag.is_raised()) << "not by this context";
  flag.watch({});
  EXPECT_FALSE(flag.is_up());
}

}  // namespace
}  // namespace chimera
