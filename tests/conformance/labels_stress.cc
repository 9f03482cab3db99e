// SPDX-License-Identifier: Apache-2.0
// The invariants of the labels, looked up in the kernel at every entry to the section, over random sets.
//   labels_stress [--seconds N] [--entries N] [--seed N]
// Ends with one JSON line: n entries; faults = times the section was found taken, or a label was wrong or out of order;
// taken_asleep = times it was found taken while the kernel had its holder wait for a page (of a virtual machine: from
// its host).
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

#include "tests/conformance/by_threads.h"
#include "tests/conformance/toy.h"

namespace chimera::toy {
namespace {

constexpr Nanoseconds kRound = milliseconds(600), kRest = milliseconds(300);

// Twenty tasks of 0.7 to 3 ms at 60 % to 110 %; some sleep, some overrun, some are demoted for it.
ProcessorCounts one_round(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&random](unsigned n) { return static_cast<std::int64_t>(random() % n); };
  Application app;
  const std::int64_t percent = 60 + below(50);
  for (int i = 0; i < 20; ++i) {
    const Nanoseconds period = microseconds(700 + below(2300));
    TaskSpec& spec = app.add("t" + std::to_string(i), period);
    spec.budget = {period.count * percent / 2000};
    spec.criticality = static_cast<std::uint32_t>(below(3));
    spec.on_miss = below(2) == 0 ? OnMiss::kContinue : OnMiss::kAbort;
    spec.on_overrun = below(4) == 0 ? OnMiss::kDemote : OnMiss::kContinue;
    app.toy("t" + std::to_string(i)).during = [budget = spec.budget.count, n = seed + static_cast<unsigned>(i)](
                                                  const chimera_call& call) mutable {
      n = n * 1664525u + 1013904223u;
      const std::int64_t share = n >> 24;  // of 256
      call.host->spend(call.context, budget * share / 200);
      if (share == 0) LinuxClock().wait_until(LinuxClock().now() + microseconds(200));
      return call.host->expired(call.context) != 0 ? CHIMERA_ABORTED : CHIMERA_OK;
    };
  }
  constexpr Policy kPolicies[] = {Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity};
  ProcessorPlace place = checked_place();
  place.base = kCeiling - (seed % 2 == 0 ? 19 : 6);  // few levels: parking is used
  RunOptions options;
  options.policy = kPolicies[seed % 4];
  PreemptiveExecutor executor(app.build_preemptive(), options, place);
  at_the_ceiling([&] {
    if (executor.start()) executor.run(kRound);
  });
  return executor.counts();
}

int run(Nanoseconds time, std::uint64_t entries, unsigned seed) {
  if (!may_be_realtime(kCeiling)) {
    std::puts("no real-time rights: levels cannot be judged");
    return 77;
  }
  (void)enter_realtime({0, -1, true});  // memory locked, as in an rtpu
  LinuxClock clock;
  ProcessorCounts all;
  const Nanoseconds end = clock.now() + time;
  std::uint64_t faults = 0;
  for (; clock.now() < end || all.checked < entries; ++seed) {
    const ProcessorCounts one = one_round(seed);
    if (one.section_taken + one.wrong_levels > 0)
      std::printf("seed %u: section taken %llu times, %llu wrong labels\n", seed,
                  static_cast<unsigned long long>(one.section_taken),
                  static_cast<unsigned long long>(one.wrong_levels));
    faults += one.section_taken + one.wrong_levels;
    all.taken_asleep += one.taken_asleep;
    all.checked += one.checked;
    all.jobs += one.jobs;
    all.level_changes += one.level_changes;
    all.preemptions += one.preemptions;
    all.ended_unseen += one.ended_unseen;
    all.supervised += one.supervised;
    clock.wait_until(clock.now() + kRest);
  }
  std::printf("{\"name\": \"labels\", \"n\": %llu, \"faults\": %llu, \"jobs\": %llu, \"level_changes\": %llu, "
              "\"preemptions\": %llu, \"ended_unseen\": %llu, \"supervised\": %llu, \"taken_asleep\": %llu}\n",
              static_cast<unsigned long long>(all.checked), static_cast<unsigned long long>(faults),
              static_cast<unsigned long long>(all.jobs), static_cast<unsigned long long>(all.level_changes),
              static_cast<unsigned long long>(all.preemptions), static_cast<unsigned long long>(all.ended_unseen),
              static_cast<unsigned long long>(all.supervised), static_cast<unsigned long long>(all.taken_asleep));
  return faults == 0 && all.preemptions > 0 ? 0 : 1;
}

}  // namespace
}  // namespace chimera::toy

int main(int argc, char** argv) {
  chimera::Nanoseconds time;
  std::uint64_t entries = 0;
  unsigned seed = 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--seconds") == 0) time = chimera::seconds(std::atoi(argv[i + 1]));
    if (std::strcmp(argv[i], "--entries") == 0) entries = std::strtoull(argv[i + 1], nullptr, 10);
    if (std::strcmp(argv[i], "--seed") == 0) seed = static_cast<unsigned>(std::atoi(argv[i + 1]));
  }
  return chimera::toy::run(time, entries, seed);
}
