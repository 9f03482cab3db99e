// SPDX-License-Identifier: Apache-2.0
// A proof over many seeds as a program: PROGRAM [--seconds N] [--UNITS N] [--from SEED]
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace chimera::proof {

struct CampaignNames {
  const char* name;   // in the last line
  const char* units;  // the option that says how many are judged: "--sets"
};

/// `judge(seed)` says what is wrong, "" when nothing is; after the last one `tell()` prints the tallies. Returns the
/// exit code. It ends early at 20 faults.
template <class Judge, class Tell>
int campaign(int argc, char** argv, CampaignNames names, Judge judge, Tell tell) {
  double limit = 0;
  std::uint64_t first = 1, most = 0;
  for (int a = 1; a + 1 < argc; a += 2) {
    const std::string key = argv[a];
    if (key == "--seconds") limit = std::strtod(argv[a + 1], nullptr);
    else if (key == names.units) most = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--from") first = std::strtoull(argv[a + 1], nullptr, 10);
    else return 2;
  }
  if (most == 0) most = limit > 0 ? UINT64_MAX : 100'000;
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  std::uint64_t n = 0, faults = 0;
  for (; n < most && faults < 20 && (limit <= 0 || elapsed() < limit); ++n) {
    const std::string wrong = judge(static_cast<std::uint32_t>(first + n));
    if (wrong.empty()) continue;
    ++faults;
    std::printf("%s\n", wrong.c_str());
  }
  tell();
  std::printf("{\"name\": \"%s\", \"n\": %llu, \"faults\": %llu, \"seconds\": %.1f}\n", names.name,
              static_cast<unsigned long long>(n), static_cast<unsigned long long>(faults), elapsed());
  return faults == 0 ? 0 : 1;
}

}  // namespace chimera::proof
