// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/switch_wish.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(SwitchWish, ComesBackFromItsWord) {
  const SwitchWish wish{65535, 4095, 255, SwitchCause::kFault};
  EXPECT_EQ(SwitchWish::of(wish.word()), wish);
  EXPECT_EQ(SwitchWish::of(SwitchWish{1, 0, 0, SwitchCause::kRequest}.word()).number, 1);
  EXPECT_FALSE(SwitchWish::of(0).is_there());
}

TEST(SwitchWish, HasAnotherNumberThanTheOneBefore) {
  SwitchWish wish;
  wish = wish.next({3, SwitchCause::kMiss, TaskId{7u}});
  EXPECT_EQ(wish, (SwitchWish{1, 3, 7, SwitchCause::kMiss}));
  wish.number = 65535;
  EXPECT_EQ(wish.next({3, SwitchCause::kMiss, TaskId{7u}}).number, 1);  // 0 is none
}

TEST(SwitchWish, TheLastRequestStands) {
  EXPECT_TRUE(is_new_wish(1, false, false, 0));
  EXPECT_FALSE(is_new_wish(1, true, false, 0)) << "it is in force, and nothing else is asked for";
  EXPECT_TRUE(is_new_wish(1, true, true, 2)) << "it takes another one back";
  EXPECT_FALSE(is_new_wish(1, false, true, 1)) << "it is asked for already";
}

TEST(SwitchWish, IsDealtWithInOneIncarnation) {
  EXPECT_NE(wish_dealt_with(1, 3), wish_dealt_with(2, 3));
  EXPECT_NE(wish_dealt_with(1, 3), wish_dealt_with(1, 4));
  EXPECT_NE(wish_dealt_with(1, 3), 0u);
}

}  // namespace
}  // namespace chimera
