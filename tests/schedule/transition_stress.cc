// SPDX-License-Identifier: Apache-2.0
// The proof of transitions over many seeds: transition_stress [--seconds N] [--transitions N] [--from SEED]
#include "tests/schedule/campaign.h"
#include "tests/schedule/transition_proof.h"

using namespace chimera::proof;  // NOLINT: a main() of this project

int main(int argc, char** argv) {
  TransitionTallies tallies{};
  return campaign(argc, argv, {"schedule_transition", "--transitions"},
                  [&](std::uint32_t seed) { return judge_transition(seed, tallies); },
                  [&] { std::printf("%s", table(tallies).c_str()); });
}
