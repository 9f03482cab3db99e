// SPDX-License-Identifier: Apache-2.0
// The trials over many seeds: switching_stress [--seconds N] [--trials N] [--from SEED] | --seed SEED
// With --record the events of that seed's run, for the model: `tests/models/run.py`.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/switching/trial.h"

namespace {

using chimera::switching_trial::Kind;
using chimera::switching_trial::run_loop_trial;
using chimera::switching_trial::run_on_trial;
using chimera::switching_trial::run_trial;
using chimera::switching_trial::run_virtual_trial;
using chimera::switching_trial::Tally;

constexpr std::uint32_t kSwitches = 40, kOfModel = 3;

Tally run(std::uint64_t seed) {
  switch (seed % 5) {
    case 0: return run_virtual_trial(seed, kSwitches);
    case 1: return run_loop_trial(seed, kSwitches);
    case 2: return run_on_trial(seed, kSwitches);
    default: return run_trial(seed, kSwitches);
  }
}

unsigned long long number(std::uint64_t n) { return n; }

int replay(std::uint64_t seed, bool records) {
  const Tally tally = records ? run_trial(seed, kOfModel, Kind::kOfModel) : run(seed);
  for (const std::string& event : tally.events) std::printf("%s\n", event.c_str());
  if (!records || !tally.failure.empty())
    std::fprintf(stderr, "seed %llu: %s\n", number(seed), tally.failure.empty() ? "all held" : tally.failure.c_str());
  return tally.failure.empty() ? 0 : 1;
}

int campaign(double limit, std::uint64_t first, std::uint64_t most) {
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  Tally sum;
  std::uint64_t faults = 0;
  for (std::uint64_t n = 0; n < most && (limit <= 0 || elapsed() < limit); ++n) {
    const std::uint64_t seed = first + n;
    const Tally one = run(seed);
    sum.switches += one.switches;
    sum.done += one.done;
    sum.aborted += one.aborted;
    sum.rtpu_deaths += one.rtpu_deaths;
    sum.manager_deaths += one.manager_deaths;
    sum.hold_ups += one.hold_ups;
    sum.signals += one.signals;
    sum.looks += one.looks;
    if (one.failure.empty()) continue;
    ++faults;
    std::printf("%s; replay: switching_stress --seed %llu\n", one.failure.c_str(), number(seed));
  }
  std::printf("{\"name\": \"switching\", \"n\": %llu, \"faults\": %llu, \"counted\": \"switches\", \"done\": %llu, "
              "\"aborted\": %llu, \"rtpu_deaths\": %llu, \"manager_deaths\": %llu, \"hold_ups\": %llu, "
              "\"signals\": %llu, \"cycles\": %llu}\n",
              number(sum.switches), number(faults), number(sum.done), number(sum.aborted), number(sum.rtpu_deaths),
              number(sum.manager_deaths), number(sum.hold_ups), number(sum.signals), number(sum.looks));
  return faults == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  double limit = 0;
  std::uint64_t seed = 0, first = 1, most = 0;
  bool records = false;
  for (int a = 1; a < argc; ++a) {
    const std::string key = argv[a];
    if (key == "--record") {
      records = true;
      continue;
    }
    if (++a == argc) return 2;
    if (key == "--seed") seed = std::strtoull(argv[a], nullptr, 10);
    else if (key == "--seconds") limit = std::strtod(argv[a], nullptr);
    else if (key == "--trials") most = std::strtoull(argv[a], nullptr, 10);
    else if (key == "--from") first = std::strtoull(argv[a], nullptr, 10);
    else return 2;
  }
  if (most == 0) most = limit > 0 ? UINT64_MAX : 100;
  return seed != 0 ? replay(seed, records) : campaign(limit, first, most);
}
