// SPDX-License-Identifier: Apache-2.0
// The trials of this folder as campaigns: register_campaign kill|stop [--times N] [--seconds N] [--seed N]
// Without either bound 100,000 times; with --seconds alone as many as fit.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/kill/kill_trial.h"
#include "tests/kill/stop_trial.h"

namespace {

struct Bounds {
  std::uint64_t times;
  double seconds;
  std::uint64_t seed;
};

struct Verdict {
  std::uint64_t n, faults, mid_write;
};

void print_reads(std::uint64_t reads, std::uint64_t torn, std::uint64_t backwards, std::uint64_t refused) {
  std::printf("reads %" PRIu64 ", torn %" PRIu64 ", backwards %" PRIu64 ", refused beside a flooding writer %" PRIu64
              "\n",
              reads, torn, backwards, refused);
}

Verdict run_kills(const Bounds& bounds) {
  const auto r = chimera::run_kill_trial({.kills = bounds.times, .seconds = bounds.seconds, .seed = bounds.seed});
  print_reads(r.reads, r.torn, r.backwards, r.refused_alive);
  std::printf("refused without a writer %" PRIu64 "\n", r.refused_dead);
  if (!r.failure.empty()) std::printf("ended early: %s\n", r.failure.c_str());
  return {r.kills, r.faults(), r.mid_write};
}

Verdict run_stops(const Bounds& bounds) {
  const auto r = chimera::run_stop_trial({.stops = bounds.times, .seconds = bounds.seconds, .seed = bounds.seed});
  print_reads(r.reads, r.torn, r.backwards, r.refused);
  if (!r.failure.empty()) std::printf("ended early: %s\n", r.failure.c_str());
  return {r.stops, r.faults(), r.mid_write};
}

}  // namespace

int main(int argc, char** argv) {
  const char* name = argc > 1 ? argv[1] : "";
  bool is_good = std::strcmp(name, "kill") == 0 || std::strcmp(name, "stop") == 0;
  std::uint64_t times = 0;
  Bounds bounds{100'000, 1e9, 1};
  for (int i = 2; i < argc; i += 2) {
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    const long long number = std::atoll(value);
    if (std::strcmp(argv[i], "--times") == 0 && number > 0) {
      times = static_cast<std::uint64_t>(number);
    } else if (std::strcmp(argv[i], "--seconds") == 0 && std::atof(value) > 0) {
      bounds.seconds = std::atof(value);
      bounds.times = UINT64_MAX;
    } else if (std::strcmp(argv[i], "--seed") == 0 && number > 0) {
      bounds.seed = static_cast<std::uint64_t>(number);
    } else {
      is_good = false;
    }
  }
  if (!is_good) {
    std::fprintf(stderr, "usage: %s kill|stop [--times N] [--seconds N] [--seed N]\n", argv[0]);
    return 2;
  }
  if (times != 0) bounds.times = times;
  const Verdict verdict = *name == 'k' ? run_kills(bounds) : run_stops(bounds);
  std::printf("{\"name\": \"register_%s\", \"n\": %" PRIu64 ", \"faults\": %" PRIu64 ", \"mid_write\": %" PRIu64 "}\n",
              name, verdict.n, verdict.faults, verdict.mid_write);
  return verdict.faults == 0 ? 0 : 1;
}
