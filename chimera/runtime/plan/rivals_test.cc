// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/rivals.h"

#include <gtest/gtest.h>

#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/testing/test_application.h"

namespace chimera::rivals_test {
namespace {

struct Tool {
  OutConst<double> mass{"mass", "kg"};
  Resource port{"port"};
  void cycle(Cycle) {}
};
struct User {
  InConst<double> mass{"mass", "kg"};
  OutConst<double> load{"load", "kg"};
  void cycle(Cycle) {}
};
struct Last {
  InConst<double> load{"load", "kg"};
  void cycle(Cycle) {}
};

constexpr TaskId kOne{0u}, kTwo{1u}, kThree{2u}, kUser{3u}, kLast{4u};

/// Three tools, of which `one` starts; `user` reads the mass of the tools, `last` the load of `user`.
struct RivalsTest : ::testing::Test {
  void SetUp() override {
    for (const char* name : {"one", "two", "three"}) app.add(name, testing::component<Tool>("tool"));
    app.add("user", testing::component<User>("user"));
    app.add("last", testing::component<Last>("last"));
    for (const TaskId tool : {kOne, kTwo, kThree}) app.port(tool.index, 1).value = tty;
  }
  void make() {
    sets[0].order = with_one;
    sets[1].order = with_two;
    app.make(with_one, false);
    app.spec.sets = sets;
    rivals.prepare(app.spec, memory);
  }
  std::vector<bool> created() const {
    std::vector<bool> all;
    for (std::size_t t = 0; t < 5; ++t) all.push_back(rivals.is_created_at_start(TaskId(t)));
    return all;
  }
  const std::vector<std::byte> tty = testing::bytes_of("tty0"), other = testing::bytes_of("tty1");
  std::vector<TaskId> with_one{kOne}, with_two{kTwo, kUser, kLast};
  NamedSet sets[2] = {{"one", {}}, {"two", {}}};
  testing::TestApplication app;
  HeapMemory memory;
  Rivals rivals;
};

TEST_F(RivalsTest, TheSameTextMakesRivals) {
  app.port(kThree.index, 1).value = other;
  make();
  EXPECT_TRUE(rivals.is_any());
  EXPECT_TRUE(rivals.are(kOne, kTwo));
  EXPECT_TRUE(rivals.are(kTwo, kOne));
  EXPECT_FALSE(rivals.are(kOne, kThree)) << "another text";
  EXPECT_FALSE(rivals.are(kOne, kOne));
  EXPECT_EQ(rivals.resource(kTwo, kOne).substr(0, 4), "tty0");
  EXPECT_EQ(rivals.resource(kOne, kThree), "");
}

TEST_F(RivalsTest, SharedOrConfiguredTogetherTheyAreNoRivals) {
  app.port(kThree.index, 1).shared = true;
  with_two.push_back(kOne);
  make();
  EXPECT_FALSE(rivals.is_any());
  EXPECT_FALSE(rivals.are(kOne, kTwo)) << "they run together";
  EXPECT_FALSE(rivals.are(kOne, kThree)) << "declared shared";
  EXPECT_EQ(created(), std::vector<bool>(5, true));
  EXPECT_FALSE(rivals.may_be_absent(kTwo));
}

TEST_F(RivalsTest, TheStartLeavesOutRivalsAndUsersOfTheirConstants) {
  make();
  EXPECT_EQ(created(), (std::vector<bool>{true, false, false, false, false}))
      << "user has the mass of its configuration, which two makes";
  for (const TaskId task : {kOne, kTwo, kThree, kUser, kLast}) EXPECT_TRUE(rivals.may_be_absent(task));
}

TEST_F(RivalsTest, CreatesTheFirstOfTheRivalsOutsideTheStartSet) {
  with_one = {};
  make();
  EXPECT_EQ(created(), (std::vector<bool>{true, false, false, false, false}));
}

TEST_F(RivalsTest, AnEmptyTextIsNoResource) {
  for (const TaskId tool : {kOne, kTwo, kThree}) app.port(tool.index, 1).value = {};
  make();
  EXPECT_FALSE(rivals.is_any());
}

}  // namespace
}  // namespace chimera::rivals_test
