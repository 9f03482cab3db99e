// SPDX-License-Identifier: Apache-2.0
// The simulation over many seeds: subsystem_stress [--seconds N] [--seeds N] [--from SEED] | --seed SEED
// With --defect N the N-th of Defect is planted.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/subsystem/simulation.h"

namespace {

using chimera::simulated::Defect;
using chimera::simulated::Outcome;
using chimera::simulated::simulate;

int replay(std::uint64_t seed, Defect planted) {
  const Outcome outcome = simulate(seed, planted, true);
  std::printf("seed %llu: %llu signals, %llu deaths, trace %016llx: %s\n", static_cast<unsigned long long>(seed),
              static_cast<unsigned long long>(outcome.signals), static_cast<unsigned long long>(outcome.deaths),
              static_cast<unsigned long long>(outcome.hash),
              outcome.failure.empty() ? "everything held" : outcome.failure.c_str());
  return outcome.failure.empty() ? 0 : 1;
}

int campaign(double limit, std::uint64_t first, std::uint64_t most, Defect planted) {
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  chimera::simulated::Tally tally;
  std::uint64_t n = 0, faults = 0, signals = 0, deaths = 0, trace = 0;
  for (; n < most && (limit <= 0 || elapsed() < limit); ++n) {
    const Outcome outcome = simulate(first + n, planted);
    signals += outcome.signals;
    deaths += outcome.deaths;
    trace = trace * 31 + outcome.hash;
    tally.add(outcome.tally);
    if (outcome.failure.empty()) continue;
    ++faults;
    std::printf("%s; replay: subsystem_stress --seed %llu\n", outcome.failure.c_str(),
                static_cast<unsigned long long>(first + n));
  }
  for (const auto& [what, count] : tally.all())
    std::printf("%10llu %s\n", static_cast<unsigned long long>(count), what.c_str());
  const auto missing = tally.missing();
  for (const std::string& what : missing) std::printf("never: %s\n", what.c_str());
  if (n >= 100) faults += missing.size();
  std::printf("{\"name\": \"subsystem_stress\", \"n\": %llu, \"faults\": %llu, \"signals\": %llu, \"deaths\": %llu, "
              "\"seconds\": %.1f, \"trace\": \"%016llx\"}\n",
              static_cast<unsigned long long>(n), static_cast<unsigned long long>(faults),
              static_cast<unsigned long long>(signals), static_cast<unsigned long long>(deaths), elapsed(),
              static_cast<unsigned long long>(trace));
  return faults == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  double limit = 0;
  std::uint64_t seed = 0, first = 1, most = 0;
  Defect planted = Defect::kNone;
  for (int a = 1; a + 1 < argc; a += 2) {
    const std::string key = argv[a];
    if (key == "--seed") seed = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--seconds") limit = std::strtod(argv[a + 1], nullptr);
    else if (key == "--seeds") most = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--from") first = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--defect") planted = static_cast<Defect>(std::strtoull(argv[a + 1], nullptr, 10));
    else return 2;
  }
  if (most == 0) most = limit > 0 ? UINT64_MAX : 10'000;
  if (seed != 0) return replay(seed, planted);
  return campaign(limit, first, most, planted);
}
