// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/profile.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(Profile, ARecentTimeDecaysByHalvesAndTheLongestStays) {
  Profile profile;
  profile.add_call(Method::kOn, milliseconds(8));
  EXPECT_EQ(profile.of_late(Method::kOn), milliseconds(8));
  for (const int left : {4, 2, 1}) {
    profile.add_call(Method::kOn, microseconds(5));
    EXPECT_EQ(profile.of_late(Method::kOn), milliseconds(left));
  }
  profile.add_call(Method::kOn, milliseconds(3));
  EXPECT_EQ(profile.of_late(Method::kOn), milliseconds(3));
  EXPECT_EQ(profile.execution[static_cast<int>(Method::kOn)].max, milliseconds(8));
}

TEST(Profile, EachMethodIsForgottenByItselfAndOthersNever) {
  Profile profile;
  for (const Method method : {Method::kReinit, Method::kOn, Method::kOff, Method::kKill}) {
    profile.add_call(method, milliseconds(8));
    profile.add_call(Method::kInit, microseconds(1));
    EXPECT_EQ(profile.of_late(method), milliseconds(8));
  }
  profile.add_call(Method::kKill, microseconds(1));
  EXPECT_EQ(profile.of_late(Method::kKill), milliseconds(8));
  profile.add_call(Method::kOff, microseconds(1));
  EXPECT_EQ(profile.of_late(Method::kOff), milliseconds(4));
  EXPECT_EQ(profile.of_late(Method::kOn), milliseconds(8));
}

}  // namespace
}  // namespace chimera
