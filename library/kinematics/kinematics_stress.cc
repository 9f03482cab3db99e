// SPDX-License-Identifier: Apache-2.0
// Compares kinematics with Orocos KDL over many seeds: kinematics_stress [--seconds N] [--arms N] [--from SEED]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "library/kinematics/testing/kdl_proof.h"

using namespace chimera::library;  // NOLINT: a main() of this project

int main(int argc, char** argv) {
  double limit = 0;
  unsigned first = 1;
  unsigned long long most = 0;
  for (int a = 1; a + 1 < argc; a += 2) {
    const std::string key = argv[a];
    if (key == "--seconds") limit = std::strtod(argv[a + 1], nullptr);
    else if (key == "--arms") most = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--from") first = static_cast<unsigned>(std::strtoul(argv[a + 1], nullptr, 10));
    else return 2;
  }
  if (most == 0) most = limit > 0 ? ~0ull : 10'000;
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  KdlTally tally;
  unsigned long long arms = 0, faults = 0;
  for (; arms < most && faults < 20 && (limit <= 0 || elapsed() < limit); ++arms) {
    const std::string wrong = judge_kinematics(first + static_cast<unsigned>(arms), tally);
    if (wrong.empty()) continue;
    ++faults;
    std::printf("%s\n", wrong.c_str());
  }
  std::printf("%llu arms, %zu poses, %zu solutions of the closed form, %zu of %zu searches found\n", arms, tally.poses,
              tally.inverses, tally.solved, tally.searches);
  std::printf("{\"name\": \"kinematics\", \"n\": %zu, \"faults\": %llu, \"seconds\": %.1f}\n",
              tally.poses + tally.inverses, faults, elapsed());
  return faults == 0 ? 0 : 1;
}
