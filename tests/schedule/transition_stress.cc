// SPDX-License-Identifier: Apache-2.0
// The proof over many seeds: transition_stress [--seconds N] [--transitions N] [--from SEED]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/schedule/transition_proof.h"

using namespace chimera::proof;  // NOLINT: a main() of this project

int main(int argc, char** argv) {
  double limit = 0;
  std::uint64_t first = 1, most = 0;
  for (int a = 1; a + 1 < argc; a += 2) {
    const std::string key = argv[a];
    if (key == "--seconds") limit = std::strtod(argv[a + 1], nullptr);
    else if (key == "--transitions") most = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--from") first = std::strtoull(argv[a + 1], nullptr, 10);
    else return 2;
  }
  if (most == 0) most = limit > 0 ? UINT64_MAX : 100'000;
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  TransitionTallies tallies{};
  std::uint64_t n = 0, faults = 0;
  for (; n < most && faults < 20 && (limit <= 0 || elapsed() < limit); ++n) {
    const std::string wrong = judge_transition(static_cast<std::uint32_t>(first + n), tallies);
    if (wrong.empty()) continue;
    ++faults;
    std::printf("%s\n", wrong.c_str());
  }
  std::printf("%s", table(tallies).c_str());
  std::printf("{\"name\": \"schedule_transition\", \"n\": %llu, \"faults\": %llu, \"seconds\": %.1f}\n",
              static_cast<unsigned long long>(n), static_cast<unsigned long long>(faults), elapsed());
  return faults == 0 ? 0 : 1;
}
