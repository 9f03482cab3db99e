// SPDX-License-Identifier: Apache-2.0
#include "library/button/debounce.h"

#include <gtest/gtest.h>

#include <string>

namespace chimera::library {
namespace {

// A letter for each level, one every millisecond: r and f are edges, - is none.
std::string edges(Debounce& contact, const std::string& levels) {
  std::string text;
  for (std::size_t i = 0; i < levels.size(); ++i)
    text += "-rf"[static_cast<int>(contact.follow(levels[i] == '1', milliseconds(static_cast<std::int64_t>(i))))];
  return text;
}

TEST(Debounce, FollowsALevelThatLasted) {
  Debounce contact;
  contact.set_time(milliseconds(3));
  EXPECT_EQ(edges(contact, "0011111110000000"), "-----r------f---");
  EXPECT_FALSE(contact.level());
}

TEST(Debounce, IgnoresALevelThatChangesBackWithinTheTime) {
  Debounce contact;
  contact.set_time(milliseconds(3));
  EXPECT_EQ(edges(contact, "0101101110101111"), "---------------r");
}

TEST(Debounce, WithoutATimeFollowsAtOnce) {
  Debounce contact;
  EXPECT_EQ(edges(contact, "0110"), "-r-f");
}

TEST(Debounce, TakesTheFirstLevelWithoutAnEdge) {
  Debounce contact;
  EXPECT_EQ(edges(contact, "11"), "--");
  EXPECT_TRUE(contact.level());
  contact.forget();
  EXPECT_EQ(edges(contact, "00"), "--");
  EXPECT_FALSE(contact.level());
}

}  // namespace
}  // namespace chimera::library
