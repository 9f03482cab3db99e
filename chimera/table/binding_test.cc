// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/binding.h"

#include <gtest/gtest.h>

#include <array>

namespace chimera {
namespace {

const std::array kRows{Binding{TaskId(0u), 0, {0, 16, 64}}, Binding{TaskId(2u), 0, {0, 16, 64}},
                       Binding{TaskId(2u), 3, {1, 80, 128}}};

TEST(BindingTable, GivesTheRowsOfAConsumerInOrder) {
  const BindingTable table(7, kRows);
  EXPECT_EQ(table.generation(), 7u);
  ASSERT_EQ(table.of(TaskId(2u)).size(), 2u);
  EXPECT_EQ(table.of(TaskId(2u))[1].source, (Link{1, 80, 128}));
  EXPECT_EQ(table.of(TaskId(0u)).size(), 1u);
  EXPECT_TRUE(table.of(TaskId(1u)).empty());
  EXPECT_TRUE(table.of(TaskId(3u)).empty());
}

TEST(BindingTable, KnowsWhetherAGroupIsRead) {
  const BindingTable table(1, kRows);
  EXPECT_TRUE(table.names({1, 80, 128}));
  EXPECT_FALSE(table.names({1, 80, 64}));
  EXPECT_FALSE(BindingTable().names({0, 16, 64}));
}

TEST(BindingTableDeath, RefusesRowsOutOfOrderOrTwice) {
  std::array twice = kRows;
  twice[1] = twice[0];
  EXPECT_DEATH(BindingTable(1, twice), "a.consumer < b.consumer");
  EXPECT_DEATH(BindingTable(0, kRows), "generation > 0");
}

}  // namespace
}  // namespace chimera
