// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/plan/switch_wish.h"

#include <gtest/gtest.h>

namespace chimera::switch_wish_test {
namespace {

TEST(SwitchWish, ComesBackFromItsWord) {
  const SwitchWish wish{65535, 4095, 255, SwitchCause::kFault};
  EXPECT_EQ(SwitchWish::of(wish.word()), wish);
  EXPECT_EQ(SwitchWish::of(SwitchWish{1, 0, 0, SwitchCause::kRequest}.word()).number, 1);
  EXPECT_FALSE(SwitchWish::of(0).is_there());
}

TEST(SwitchWish, HasANewNumberEachTime) {
  SwitchWish wish;
  wish = wish.next({3, SwitchCause::kMiss, TaskId{7u}});
  EXPECT_EQ(wish, (SwitchWish{1, 3, 7, SwitchCause::kMiss}));
  wish.number = 65535;
  EXPECT_EQ(wish.next({3, SwitchCause::kMiss, TaskId{7u}}).number, 1);  // 0 is none
}

TEST(SwitchWish, TheLastRequestStands) {
  EXPECT_TRUE(is_new_wish(false, false, false));
  EXPECT_FALSE(is_new_wish(false, true, false)) << "it is in force, and no other request is open";
  EXPECT_TRUE(is_new_wish(false, true, true)) << "it takes another one back";
  EXPECT_FALSE(is_new_wish(true, false, true)) << "it is asked for already";
}

TEST(SwitchWish, ARequestOfListsIsReadWhole) {
  SwitchWishWords words;
  EXPECT_FALSE(words.read().wish.is_there());
  SwitchRequest request{UINT32_MAX, SwitchCause::kRequest, TaskId{7u}};
  request.lists.plus.add(TaskId{255u});
  request.lists.minus.add(TaskId{0u});
  words.write(words.wish().next(request), request.lists, milliseconds(5));
  EXPECT_EQ(words.wish().set, SwitchWish::kLists);
  EXPECT_EQ(words.read().at, milliseconds(5));
  EXPECT_TRUE(words.read().request().is_for(request));
  EXPECT_EQ(words.read().request().by, TaskId{7u});
  words.write(words.wish().next({3, SwitchCause::kMiss, TaskId{7u}}), {}, milliseconds(6));
  EXPECT_EQ(words.read().request().set, 3u);
  EXPECT_FALSE(words.read().request().lists.are_there());
  EXPECT_EQ(words.wish().number, 2);
}

TEST(SwitchWish, IsHandledInOneIncarnation) {
  EXPECT_NE(wish_dealt_with(1, 3), wish_dealt_with(2, 3));
  EXPECT_NE(wish_dealt_with(1, 3), wish_dealt_with(1, 4));
  EXPECT_NE(wish_dealt_with(1, 3), 0u);
}

}  // namespace
}  // namespace chimera::switch_wish_test
