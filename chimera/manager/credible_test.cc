// SPDX-License-Identifier: Apache-2.0
#include "chimera/manager/credible.h"

#include <gtest/gtest.h>

namespace chimera::manager {
namespace {

TEST(Credible, IsWhatCanHaveBeenCounted) {
  Profile counted;
  EXPECT_TRUE(is_credible(counted, {}));
  counted.missed = counted.overrun = 900'000;
  counted.stale = 64 * 900'000;
  EXPECT_TRUE(is_credible(counted, {})) << "a second of the highest rate";
  counted.overrun = 6'510'615'555'426'900'570u;
  EXPECT_FALSE(is_credible(counted, seconds(86'400)));
}

}  // namespace
}  // namespace chimera::manager
