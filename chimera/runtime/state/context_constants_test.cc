// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/state/context_constants.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera {
namespace {

struct Maker {
  OutConst<std::int32_t> n{"n", "1"};
  Out<double[]> made{"made", "1", "[n<=4]"};
  void cycle(Cycle) {}
};

struct User {
  InConst<std::int32_t> n{"n", "1"};
  In<double[]> made{"made", "1", "[n<=4]"};
  void cycle(Cycle) {}
};

constexpr TaskId kMaker{0u}, kUser{1u};

/// The other process: shows the constants of the maker.
struct Elsewhere final : PeerView {
  PeerPresence presence(TaskId) const noexcept override { return {true, true, true}; }
  State state(TaskId) const noexcept override { return State::kOn; }
  GroupReader outputs(TaskId) const noexcept override { return {}; }
  GroupReader constants(TaskId) const noexcept override {
    return is_there ? GroupReader(memory.data(), 8) : GroupReader();
  }
  GroupReader operator_variable(std::size_t) const noexcept override { return {}; }
  bool post(Signal, TaskId, TaskId, bool) noexcept override { return true; }
  void make(std::int32_t n) {
    GroupWriter writer(memory.span(), 8);
    std::memcpy(writer.staging(), &n, sizeof n);
    writer.publish({}, 1);
  }
  bool is_there = true;
  AlignedBytes memory{group_bytes(8), kCacheLine};
};

struct ContextConstantsTest : ::testing::Test {
  ContextConstantsTest() {
    app.rtpus = {{"first", 0, Policy::kEdf}, {"second", 1, Policy::kEdf}};
    app.add("maker", testing::component<Maker>("maker")).rtpu = RtpuId(0u);
    app.add("user", testing::component<User>("user")).rtpu = RtpuId(1u);
    app.extend(0, 1, 4, "n");
    app.extend(1, 1, 4, "n");
  }
  /// Tasks of `rtpu`, or of both without one.
  void make(RtpuId rtpu = {}, PeerView* others = nullptr) {
    app.make();
    ContextPlace place;
    place.rtpu = rtpu;
    ASSERT_TRUE(table.prepare(app.spec, place, heap));
    for (std::size_t t = 0; t < 2; ++t) {
      const bool is_mine = !rtpu.is_valid() || app.tasks[t].rtpu == rtpu;
      if (is_mine) memories.push_back(*TaskMemory::create(app.tasks[t], *app.components[t], heap));
      else memories.emplace_back();
    }
    for (std::size_t t = 0; t < 2; ++t) {
      if (!memories[t].is_planned()) continue;
      table.place_outputs(TaskId(t), memories[t], heap);
      tasks[t].id = TaskId(t);
      ASSERT_TRUE(memories[t].construct(tasks[t], {}));
    }
    constants.prepare(app.spec, table, memories, others, heap);
  }
  ~ContextConstantsTest() override {
    for (std::size_t t = 0; t < memories.size(); ++t) memories[t].destroy(tasks[t]);
  }
  /// Does what init of the maker does.
  void makes(std::int32_t n) { std::memcpy(memories[0].constants()[0].local, &n, sizeof n); }
  std::int32_t seen_by_user() const {
    std::int32_t n;
    std::memcpy(&n, memories[1].constants()[0].local, sizeof n);
    return n;
  }

  testing::TestApplication app;
  HeapMemory heap;
  ContextTable table;
  std::array<Task, 2> tasks;
  std::vector<TaskMemory> memories;
  ContextConstants constants;
  FixedString<160> why;
};

TEST_F(ContextConstantsTest, AConstantGoesFromItsMakerToItsUsers) {
  make();
  EXPECT_FALSE(constants.give(kUser, why));
  EXPECT_EQ(why.view(), "constant n has no value: its producer was not initialised");
  makes(3);
  ASSERT_TRUE(constants.collect(kMaker, why)) << why.view();
  ASSERT_TRUE(constants.give(kUser, why)) << why.view();
  EXPECT_EQ(seen_by_user(), 3);
}

TEST_F(ContextConstantsTest, KnowsTheUsersOfAChangedConstant) {
  make();
  makes(3);
  ASSERT_TRUE(constants.collect(kMaker, why));
  EXPECT_TRUE(constants.has_new());
  ASSERT_TRUE(constants.give(kUser, why));
  EXPECT_FALSE(constants.uses_changed(kUser));
  ASSERT_TRUE(constants.collect(kMaker, why));
  EXPECT_FALSE(constants.has_new()) << "made again with an equal value";
  makes(4);
  ASSERT_TRUE(constants.collect(kMaker, why));
  EXPECT_TRUE(constants.has_new());
  EXPECT_TRUE(constants.uses_changed(kUser));
}

TEST_F(ContextConstantsTest, RefusesAnExtentBeyondItsMaximum) {
  make();
  makes(5);
  EXPECT_FALSE(constants.collect(kMaker, why));
  EXPECT_EQ(why.view(), "extent n = 5 of port made is outside 1 to 4");
  EXPECT_FALSE(constants.has_new());
}

TEST_F(ContextConstantsTest, RefusesAListOfAnotherLengthThanTheConstantSays) {
  app.port(1, 1).listed[0] = 2;
  make();
  makes(3);
  ASSERT_TRUE(constants.collect(kMaker, why));
  EXPECT_FALSE(constants.give(kUser, why));
  EXPECT_EQ(why.view(), "made has a list of 2 values, but n is 3");
}

TEST_F(ContextConstantsTest, ReadsConstantsOfOtherContexts) {
  Elsewhere elsewhere;
  elsewhere.make(2);
  elsewhere.is_there = false;
  make(RtpuId(1u), &elsewhere);
  EXPECT_FALSE(constants.give(kUser, why)) << "the other process has shown nothing yet";
  elsewhere.is_there = true;
  ASSERT_TRUE(constants.give(kUser, why)) << why.view();
  EXPECT_EQ(seen_by_user(), 2);
  elsewhere.make(4);
  EXPECT_FALSE(constants.uses_changed(kUser)) << "not before it is read";
  constants.read_foreign();
  EXPECT_TRUE(constants.uses_changed(kUser));
}

TEST_F(ContextConstantsTest, ShowsItsConstantsToOtherContexts) {
  Elsewhere elsewhere;
  make(RtpuId(0u), &elsewhere);
  makes(3);
  EXPECT_EQ(table.constant_writer(kMaker).sequence(), 0u);
  ASSERT_TRUE(constants.collect(kMaker, why)) << why.view();
  const GroupWriter shown = table.constant_writer(kMaker);
  EXPECT_EQ(shown.sequence(), 1u);
  std::int32_t n;
  std::memcpy(&n, shown.published() + 1, sizeof n);
  EXPECT_EQ(n, 3);
}

}  // namespace
}  // namespace chimera
