// SPDX-License-Identifier: Apache-2.0
#include "tests/schedule/transition_proof.h"

#include <gtest/gtest.h>

namespace chimera::proof {
namespace {

TEST(TransitionProof, GuaranteesOfRandomTransitionsHoldAtEveryInstant) {
  TransitionTallies tallies{};
  for (std::uint32_t seed = 1; seed <= 1000; ++seed) {
    const std::string wrong = judge_transition(seed, tallies);
    ASSERT_EQ(wrong, "");
  }
  std::printf("%s", table(tallies).c_str());
  // Least percentage of guaranteed transitions among those between two guaranteed sets.
  constexpr std::uint64_t kLeastShares[] = {80, 85, 65, 75, 40};
  for (std::size_t kind = 0; kind < tallies.size(); ++kind) {
    const TransitionTally& tally = tallies[kind];
    EXPECT_GE(100 * tally.promised, kLeastShares[kind] * tally.promised_alone) << kKindNames[kind];
    EXPECT_GT(tally.transitions - tally.never_missed, 50u) << kKindNames[kind];
  }
  for (const std::size_t kind : {0u, 1u, 3u}) EXPECT_GT(tallies[kind].like_for_like, 20u) << kKindNames[kind];
}

}  // namespace
}  // namespace chimera::proof
