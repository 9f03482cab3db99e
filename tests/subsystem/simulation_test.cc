// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/simulation.h"

#include <gtest/gtest.h>

namespace chimera::simulated {
namespace {

constexpr std::uint64_t kSeeds = 300;

TEST(SimulationTest, HoldsItsInvariantsAndMeetsEveryTransitionAndFaultPoint) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Outcome outcome = simulate(seed);
    ASSERT_EQ(outcome.failure, "") << "replay: subsystem_stress --seed " << seed;
    EXPECT_GE(outcome.tasks, 20u);
    tally.add(outcome.tally);
  }
  std::string missing;
  for (const std::string& what : tally.missing()) missing += what + "\n";
  EXPECT_EQ(missing, "");
}

TEST(SimulationTest, TheSameSeedGivesTheSameBytes) {
  for (const std::uint64_t seed : {7u, 77u, 777u}) EXPECT_EQ(simulate(seed).hash, simulate(seed).hash);
  EXPECT_NE(simulate(7).hash, simulate(8).hash);
}

struct Planted {
  Defect defect;
  const char* found_as;  ///< some failure has these words
};

class MutantTest : public ::testing::TestWithParam<Planted> {};

TEST_P(MutantTest, IsFoundWithinTheSeedsOfThePlainRun) {
  std::uint64_t found = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds && found == 0; ++seed) {
    const std::string failure = simulate(seed, GetParam().defect).failure;
    if (failure.find(GetParam().found_as) != std::string::npos) found = seed;
  }
  EXPECT_NE(found, 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Defects, MutantTest,
    ::testing::Values(Planted{Defect::kJudgesNothing, "produces the same and is ON"},
                      Planted{Defect::kForgetsGoals, "is lost: its process died and it did not come back"},
                      Planted{Defect::kBelievesOffEarly, "produces the same and is ON"},
                      Planted{Defect::kIgnoresAbsentDeaths, "is dead and no event says that it is given up"},
                      Planted{Defect::kLeavesOn, "a transaction failed and"},
                      Planted{Defect::kHasNoClock, "no answer from rtpu"}));

}  // namespace
}  // namespace chimera::simulated
