// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/task_word.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(TaskWord, HoldsATaskAndAMethod) {
  const TaskWord word(TaskId(2u), Method::kOff);
  EXPECT_EQ(word.word(), 3u << 8 | CHIMERA_OFF);  // pinned: docs/formats/processes.md
  const TaskWord found = TaskWord::found(word.word());
  EXPECT_EQ(found.task(), TaskId(2u));
  EXPECT_TRUE(found.has_method());
  EXPECT_EQ(found.method(), Method::kOff);
  EXPECT_FALSE(found.is_none());
}

TEST(TaskWord, TheFirstMethodOfTheFirstTaskIsNotNone) {
  EXPECT_FALSE(TaskWord(TaskId(0u), Method::kInit).is_none());
  EXPECT_TRUE(TaskWord().is_none());
  EXPECT_EQ(TaskWord().word(), 0u);
}

TEST(TaskWord, AWordWithoutATaskNamesNone) {
  EXPECT_FALSE(TaskWord().task().is_valid());
  EXPECT_FALSE(TaskWord::found(CHIMERA_CYCLE).task().is_valid());
  EXPECT_FALSE(TaskWord::found(CHIMERA_CYCLE).has_method());
}

TEST(TaskWord, KnowsThatOpeningAndBackgroundAreNoMethods) {
  EXPECT_FALSE(TaskWord(TaskId(1u), TaskWord::kOpening).has_method());
  EXPECT_FALSE(TaskWord(TaskId(1u), TaskWord::kInBackground).has_method());
  EXPECT_FALSE(TaskWord(TaskId(1u), CHIMERA_METHODS).has_method());
}

}  // namespace
}  // namespace chimera
