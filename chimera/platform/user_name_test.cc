// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/user_name.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(UserName, IsThatOfTheFileElseTheNumber) {
  EXPECT_EQ(user_name(0), "root");
  EXPECT_EQ(user_name(4'000'000'000u), "4000000000");
}

}  // namespace
}  // namespace chimera
