// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/watch/method_watch.h"

#include <gtest/gtest.h>

namespace chimera::manager {
namespace {

constexpr Nanoseconds kEvery = milliseconds(250);

struct Method : ::testing::Test {
  MethodWatch watch;
  Nanoseconds at = seconds(50);
  int news = 0;

  MethodVerdict after(Nanoseconds time, std::uint32_t word, bool is_busy = false) {
    MethodVerdict last;
    for (Nanoseconds t; t < time; t = t + kEvery) {
      at = at + kEvery;
      if (is_busy) ++progress;
      last = watch.look(word, progress, at);
      if (last.is_news) ++news;
    }
    return last;
  }
  std::uint64_t progress = 0;
};

TEST_F(Method, IsReportedWithinTwoSecondsAndThenSeldom) {
  after(kEvery, 0x100);
  EXPECT_EQ(after(milliseconds(1250), 0x100).word, 0u);
  const MethodVerdict told = after(kEvery, 0x100);
  EXPECT_EQ(told.word, 0x100u);
  EXPECT_EQ(told.since, milliseconds(1500));
  EXPECT_TRUE(told.is_news);
  EXPECT_FALSE(after(seconds(8), 0x100).is_news);
  EXPECT_EQ(news, 1);
  EXPECT_EQ(after(milliseconds(500), 0x100).since, seconds(10));
  EXPECT_EQ(news, 2);
  after(seconds(50), 0x100);
  EXPECT_EQ(news, 3) << "a minute";
}

TEST_F(Method, ItsLateEndIsReportedOnce) {
  after(seconds(3), 0x100);
  const MethodVerdict over = after(kEvery, 0);
  EXPECT_TRUE(over.is_news);
  EXPECT_EQ(over.word, 0u);
  EXPECT_EQ(over.ended, 0x100u);
  EXPECT_EQ(over.since, milliseconds(2750));
  after(seconds(3), 0);
  EXPECT_EQ(news, 2);
}

TEST_F(Method, TheNextMethodBeginsAnew) {
  after(milliseconds(1500), 0x100);
  EXPECT_EQ(after(milliseconds(1500), 0x101).word, 0u);
  EXPECT_EQ(after(kEvery, 0x101).word, 0x101u);
}

TEST_F(Method, AMethodThatIsCalledAgainIsNoHang) {
  EXPECT_EQ(after(seconds(30), 0x100, true).word, 0u);
  EXPECT_EQ(news, 0);
}

TEST_F(Method, IsNotBlamedForTheTimeThatTheWatchWasAway) {
  after(seconds(1), 0x100);
  at = at + seconds(60);
  EXPECT_EQ(watch.look(0x100, 0, at).word, 0u);
  EXPECT_EQ(after(seconds(2), 0x100).word, 0x100u);
}

TEST_F(Method, HasAHeadStartWhenItIsShownLate) {
  MethodWatch background{milliseconds(500), seconds(1)};
  for (int i = 0; i < 2; ++i) EXPECT_EQ(background.look(0x1ff, 0, at = at + kEvery).word, 0u);
  EXPECT_EQ(background.look(0x1ff, 0, at + kEvery).since, milliseconds(1500));
}

}  // namespace
}  // namespace chimera::manager
