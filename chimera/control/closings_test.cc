// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/closings.h"

#include <gtest/gtest.h>

#include <vector>

namespace chimera::control {
namespace {

TEST(Closings, ReportsAFewOneByOneAndManyInOneSentence) {
  std::vector<std::string> told;
  Closings closings;
  closings.report_to([&](const std::string& text) { told.push_back(text); });
  Nanoseconds now = seconds(100);
  for (int i = 0; i < 16; ++i) closings.add(7, "number " + std::to_string(i), now);
  EXPECT_EQ(told.size(), 16u);
  EXPECT_EQ(told[15], "number 15");
  EXPECT_EQ(closings.next_due(), kNever);
  for (int i = 0; i < 5000; ++i) closings.add(7, "more", now);
  EXPECT_EQ(told.size(), 16u);
  EXPECT_EQ(closings.next_due(), now + seconds(10));
  closings.add(8, "another's", now);
  EXPECT_EQ(told.back(), "another's") << "the closings of one user hide none of another user";
  told.pop_back();
  closings.report_due(now += seconds(9));
  EXPECT_EQ(told.size(), 16u);
  closings.report_due(now += seconds(1));
  ASSERT_EQ(told.size(), 17u);
  EXPECT_EQ(told[16], "5000 connections were closed; the last: more");
  EXPECT_EQ(closings.next_due(), kNever);
}

}  // namespace
}  // namespace chimera::control
