// SPDX-License-Identifier: Apache-2.0
// The proof over many seeds: schedule_stress [--seconds N] [--sets N] [--from SEED]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/schedule/proof.h"

using namespace chimera::proof;  // NOLINT: a main() of this project

int main(int argc, char** argv) {
  double limit = 0;
  std::uint64_t first = 1, most = 0;
  for (int a = 1; a + 1 < argc; a += 2) {
    const std::string key = argv[a];
    if (key == "--seconds") limit = std::strtod(argv[a + 1], nullptr);
    else if (key == "--sets") most = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--from") first = std::strtoull(argv[a + 1], nullptr, 10);
    else return 2;
  }
  if (most == 0) most = limit > 0 ? UINT64_MAX : 100'000;
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  Tallies tallies{};
  std::uint64_t n = 0, faults = 0;
  for (; n < most && faults < 20 && (limit <= 0 || elapsed() < limit); ++n) {
    const std::string wrong = judge(static_cast<std::uint32_t>(first + n), tallies);
    if (wrong.empty()) continue;
    ++faults;
    std::printf("%s\n", wrong.c_str());
  }
  std::printf("%-18s %9s %9s %12s %9s %9s %9s %11s\n", "kind", "sets", "fit", "called bad", "not seen", "exact",
              "demands", "bound/seen");
  for (std::size_t k = 0; k < tallies.size(); ++k) {
    const Tally& t = tallies[k];
    std::printf("%-18s %9llu %9llu %12llu %9llu %9llu %9llu %11.3f\n", kKindNames[k],
                static_cast<unsigned long long>(t.sets), static_cast<unsigned long long>(t.fit),
                static_cast<unsigned long long>(t.sets - t.fit), static_cast<unsigned long long>(t.not_seen_to_miss),
                static_cast<unsigned long long>(t.exact), static_cast<unsigned long long>(t.failing_demands),
                t.bounds == 0 ? 0 : t.bound_over_seen / static_cast<double>(t.bounds));
  }
  std::printf("{\"name\": \"schedule_analysis\", \"n\": %llu, \"faults\": %llu, \"seconds\": %.1f}\n",
              static_cast<unsigned long long>(n), static_cast<unsigned long long>(faults), elapsed());
  return faults == 0 ? 0 : 1;
}
