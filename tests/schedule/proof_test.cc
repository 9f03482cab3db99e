// SPDX-License-Identifier: Apache-2.0
#include "tests/schedule/proof.h"

#include <gtest/gtest.h>

namespace chimera::proof {
namespace {

TEST(ScheduleProof, GuaranteesOfRandomSetsHoldTickByTick) {
  Tallies tallies{};
  for (std::uint32_t seed = 1; seed <= 1500; ++seed) {
    const std::string wrong = judge(seed, tallies);
    ASSERT_EQ(wrong, "");
  }
  for (std::size_t kind = 0; kind < tallies.size(); ++kind) {
    EXPECT_GT(tallies[kind].fit, 20u) << kKindNames[kind];
    EXPECT_GT(tallies[kind].sets - tallies[kind].fit, 20u) << kKindNames[kind];
  }
  EXPECT_GT(tallies[0].exact, 500u);
  EXPECT_GT(tallies[1].failing_demands, 100u);
}

}  // namespace
}  // namespace chimera::proof
