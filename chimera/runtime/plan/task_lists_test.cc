// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/task_lists.h"

#include <gtest/gtest.h>

#include <string>

namespace chimera::task_lists_test {
namespace {

using Kind = ListsFault::Kind;

/// Tasks a, b and c.
ListsFault read(std::string_view text, TaskLists& lists) {
  return read_lists(
      text,
      [](std::string_view name) {
        const bool is_one = name.size() == 1 && name[0] >= 'a' && name[0] <= 'c';
        return is_one ? TaskId(static_cast<std::size_t>(name[0] - 'a')) : TaskId{};
      },
      lists);
}

TEST(TaskLists, NameTasksThatAreToBeOnAndTasksThatAreNot) {
  TaskLists lists;
  EXPECT_FALSE(read(" --on a  b --off\tc --on a", lists));
  EXPECT_EQ(lists.plus.words[0], 0b011u);
  EXPECT_EQ(lists.minus.words[0], 0b100u);
  TaskLists off;
  EXPECT_FALSE(read("--off b", off));
  EXPECT_TRUE(off.are_there());
  EXPECT_FALSE(off == lists);
}

TEST(TaskLists, SayWhichWordIsWrong) {
  const auto fault = [](std::string_view text) {
    TaskLists lists;
    const ListsFault found = read(text, lists);
    return std::pair(found.kind, std::string(found.word));
  };
  EXPECT_EQ(fault("--on a d b"), std::pair(Kind::kUnknownTask, std::string("d")));
  EXPECT_EQ(fault("--on a --of b"), std::pair(Kind::kOutOfPlace, std::string("--of")));
  EXPECT_EQ(fault("a --on b"), std::pair(Kind::kOutOfPlace, std::string("a")));
  EXPECT_EQ(fault("--on --off"), std::pair(Kind::kEmpty, std::string()));
  EXPECT_EQ(fault(" "), std::pair(Kind::kEmpty, std::string()));
}

TEST(TaskLists, AreMetByTasksThatAreOnAlready) {
  TaskLists lists;
  ASSERT_FALSE(read("--on a --off c", lists));
  const auto bits = [](std::uint64_t word) {
    TaskBits made;
    made.words[0] = word;
    return made;
  };
  EXPECT_TRUE(lists.are_met_by(bits(0b001)));
  EXPECT_TRUE(lists.are_met_by(bits(0b011)));
  EXPECT_FALSE(lists.are_met_by(bits(0b010)));
  EXPECT_FALSE(lists.are_met_by(bits(0b101)));
}

TEST(TaskLists, BeginAsNoConfigurationDoes) {
  EXPECT_TRUE(has_lists("--on a"));
  EXPECT_FALSE(has_lists("quick"));
  EXPECT_FALSE(has_lists(""));
}

}  // namespace
}  // namespace chimera::task_lists_test
