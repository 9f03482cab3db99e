// SPDX-License-Identifier: Apache-2.0
// The kill trial as a campaign: table_kill_campaign [--kills N] [--seconds N] [--seed N]
// Without either bound 100,000 kills; with --seconds alone as many as fit.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/kill/kill_trial.h"

int main(int argc, char** argv) {
  chimera::KillTrial trial{.kills = 0};
  bool bounded_by_time = false;
  for (int i = 1; i < argc; i += 2) {
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (std::strcmp(argv[i], "--kills") == 0 && std::atoll(value) > 0) {
      trial.kills = static_cast<std::uint64_t>(std::atoll(value));
    } else if (std::strcmp(argv[i], "--seconds") == 0 && std::atof(value) > 0) {
      trial.seconds = std::atof(value);
      bounded_by_time = true;
    } else if (std::strcmp(argv[i], "--seed") == 0 && std::atoll(value) > 0) {
      trial.seed = static_cast<std::uint64_t>(std::atoll(value));
    } else {
      std::fprintf(stderr, "usage: %s [--kills N] [--seconds N] [--seed N]\n", argv[0]);
      return 2;
    }
  }
  if (trial.kills == 0) trial.kills = bounded_by_time ? UINT64_MAX : 100'000;
  const chimera::KillReport r = chimera::run_kill_trial(trial);
  std::printf("reads %" PRIu64 ", torn %" PRIu64 ", backwards %" PRIu64 ", refused without a writer %" PRIu64
              ", refused beside a flooding writer %" PRIu64 "\n",
              r.reads, r.torn, r.backwards, r.refused_dead, r.refused_alive);
  if (!r.failure.empty()) std::printf("ended early: %s\n", r.failure.c_str());
  std::printf("{\"name\": \"register_kill\", \"n\": %" PRIu64 ", \"faults\": %" PRIu64 ", \"mid_write\": %" PRIu64
              "}\n",
              r.kills, r.faults(), r.mid_write);
  return r.faults() == 0 ? 0 : 1;
}
