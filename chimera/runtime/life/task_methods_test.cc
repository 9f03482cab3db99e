// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/life/task_methods.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "chimera/runtime/hosted/background_writer.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/making.h"
#include "chimera/runtime/state/context_table.h"
#include "chimera/runtime/task_word.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

std::atomic<std::uint32_t> at_edge{0}, making{0};
std::string story;  // of the component
bool is_checked = false;

struct Device {
  Out<double> x{"x", "1", initial = 0.0};
  Device() {
    if (!is_checked) return;
    const bool is_shown = task_of_making(making, 1) == 0 &&
                          TaskWord::found(making).word() ==
                              TaskWord(TaskId(0u), static_cast<std::uint32_t>(Making::kConstructs)).word();
    story += is_shown ? "constructed; " : "constructed unseen; ";
    if (refuses) throw std::runtime_error("no such device");
  }
  Outcome init(Cycle) {
    story += at_edge == TaskWord(TaskId(0u), Method::kInit).word() ? "init at edge; " : "init; ";
    return fails ? fault("not connected") : ok();
  }
  void cycle(Cycle) {}
  Outcome sync(Cycle) { return ok(); }
  void off(Cycle) { story += "off; "; }
  void kill(Cycle) { story += "kill; "; }
  void background() { story += "background; "; }
  int event_source() const noexcept { return 42; }
  static inline bool refuses = false, fails = false;
};

/// Calls methods itself, and says so.
struct Threads final : JobsInLoop {
  Threads() : JobsInLoop({}, nullptr) {}
  Answer call(Task& task, Method method, Nanoseconds now) noexcept override {
    story += "by threads: ";
    return call_method(task, method, now);
  }
};

struct TaskMethodsTest : ::testing::Test {
  TaskMethodsTest() {
    is_checked = Device::refuses = Device::fails = false;
    app.add("device", testing::component<Device>("device"));
    app.make();
    memories.push_back(*TaskMemory::create(app.tasks[0], *app.components[0], heap));
    EXPECT_TRUE(table.prepare(app.spec, {}, heap));
    table.place_outputs(TaskId(0u), memories[0], heap);
    task.spec = &app.tasks[0];
    task.component = app.components[0];
    task.id = TaskId(0u);
    task.call.fault = &task.said;
    methods.prepare(memories, {&at_edge, &making});
    is_checked = true;
    story.clear();
  }
  ~TaskMethodsTest() override { methods.destroy(task); }

  testing::TestApplication app;
  HeapMemory heap;
  ContextTable table;
  std::vector<TaskMemory> memories;
  Task task;
  TaskMethods methods;
};

TEST_F(TaskMethodsTest, AConstructionIsShownWhileItLasts) {
  EXPECT_EQ(methods.construct(task, milliseconds(1)), Answer::kOk);
  EXPECT_EQ(story, "constructed; ");
  EXPECT_EQ(making, 0u);
  EXPECT_NE(task.instance, nullptr);
  methods.destroy(task);
  EXPECT_EQ(task.instance, nullptr);
}

TEST_F(TaskMethodsTest, AConstructorThatRefusesIsAFaultOfInit) {
  Device::refuses = true;
  EXPECT_EQ(methods.construct(task, milliseconds(1)), Answer::kFault);
  EXPECT_EQ(making, 0u);
  EXPECT_EQ(task.instance, nullptr);
  EXPECT_STREQ(task.faults.last.text, "no such device");
  EXPECT_EQ(task.faults.method, Method::kInit);
  EXPECT_EQ(task.faults.at, milliseconds(1));
}

TEST_F(TaskMethodsTest, AtAnEdgeAMethodIsShownAndCalledByTheJobThreads) {
  Threads threads;
  methods.run_by({nullptr, &threads});
  ASSERT_EQ(methods.construct(task, {}), Answer::kOk);
  story.clear();
  EXPECT_EQ(methods.call_at_edge(task, Method::kInit, {}), Answer::kOk);
  EXPECT_EQ(story, "by threads: init at edge; ");
  EXPECT_EQ(at_edge, 0u);
  story.clear();
  EXPECT_EQ(methods.call(task, Method::kInit, {}), Answer::kOk);
  EXPECT_EQ(story, "init; ") << "the service thread calls in the present thread";
}

TEST_F(TaskMethodsTest, EventsAreAwaitedFromTheEndOfAGoodInitToKill) {
  ASSERT_EQ(methods.construct(task, {}), Answer::kOk);
  Device::fails = true;
  EXPECT_EQ(methods.call(task, Method::kInit, {}), Answer::kFault);
  EXPECT_STREQ(task.faults.last.text, "not connected");
  EXPECT_EQ(task.descriptor, -1);
  EXPECT_EQ(task.background, nullptr);
  Device::fails = false;
  EXPECT_EQ(methods.call(task, Method::kInit, {}), Answer::kOk);
  EXPECT_EQ(task.descriptor, 42);
  EXPECT_EQ(methods.call(task, Method::kOff, {}), Answer::kOk);
  EXPECT_EQ(task.descriptor, 42);
  EXPECT_EQ(methods.call(task, Method::kKill, {}), Answer::kOk);
  EXPECT_EQ(task.descriptor, -1);
}

TEST_F(TaskMethodsTest, WithoutAThreadForItTheBackgroundRunsOnceBeforeKill) {
  ASSERT_EQ(methods.construct(task, {}), Answer::kOk);
  ASSERT_EQ(methods.call(task, Method::kInit, {}), Answer::kOk);
  EXPECT_NE(task.background, nullptr);
  story.clear();
  EXPECT_EQ(methods.call(task, Method::kKill, {}), Answer::kOk);
  EXPECT_EQ(story, "background; kill; ");
  EXPECT_EQ(task.background, nullptr);
}

TEST_F(TaskMethodsTest, ABackgroundWithAThreadEndsBeforeKill) {
  BackgroundWriter writer(milliseconds(1), seconds(60));
  methods.run_by({nullptr, nullptr, &writer});
  ASSERT_EQ(methods.construct(task, {}), Answer::kOk);
  ASSERT_EQ(methods.call(task, Method::kInit, {}), Answer::kOk);
  EXPECT_TRUE(methods.end_background(task, {}));
  EXPECT_EQ(task.background, nullptr);
  story.clear();
  EXPECT_EQ(methods.call(task, Method::kKill, {}), Answer::kOk);
  EXPECT_EQ(story, "kill; ") << "it has ended already";
}

}  // namespace
}  // namespace chimera
