// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/utilisation.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

TEST(Utilisation, ASumAtTheLimitFitsThoughItsSharesAreRounded) {
  double sum = 0;
  for (int i = 0; i < 93; ++i) sum += 0.01;
  EXPECT_GT(sum, kMaxUtilisation) << "as floating numbers add up";
  EXPECT_FALSE(is_beyond(sum));
  EXPECT_TRUE(is_beyond(sum + 1e-6));
  EXPECT_TRUE(is_beyond(0.91, 0.9));
}

}  // namespace
}  // namespace chimera
