// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/schedule/proof.h"

namespace chimera::proof {
namespace {

using Random = std::mt19937;

double share(Random& random) { return std::uniform_real_distribution<double>(0, 1)(random); }
std::uint32_t below(Random& random, std::uint32_t end) { return static_cast<std::uint32_t>(random() % end); }
std::int64_t between(Random& random, std::int64_t least, std::int64_t most) {
  return std::uniform_int_distribution<std::int64_t>(least, most)(random);
}

ProcessorUse random_use(Random& random) {
  constexpr Policy kPolicies[] = {Policy::kRm, Policy::kEdf, Policy::kMuf, Policy::kMufLaxity, Policy::kLlf};
  constexpr int kWeights[] = {0, 0, 0, 1, 1, 2, 2, 2, 3, 4};
  ProcessorUse use;
  use.policy = kPolicies[kWeights[random() % 10]];
  use.dispatch = random() % 4 == 0 ? Dispatch::kExecutive : Dispatch::kPreemptive;
  use.quantum = Nanoseconds{between(random, 1, 3)};
  return use;
}

Work random_work(Random& random, double load, bool is_round, std::uint32_t rtpus, bool has_servers) {
  // Round periods meet again within 120 ticks; the others rarely do.
  constexpr std::int64_t kRound[] = {4, 5, 6, 8, 10, 12, 15, 20, 24, 30, 40, 60};
  Work w;
  w.period = Nanoseconds{is_round ? kRound[random() % 12] : std::llround(4 * std::pow(40.0, share(random)))};
  w.time = Nanoseconds{std::clamp<std::int64_t>(std::llround(load * static_cast<double>(w.period.count)), 1,
                                                w.period.count)};
  const bool is_constrained = random() % 2 == 0;
  w.deadline = is_constrained ? Nanoseconds{between(random, w.time.count, w.period.count)} : w.period;
  w.criticality = below(random, 3);
  w.user_priority = below(random, 3) == 0 ? below(random, 3) : 0;
  w.rtpu = below(random, rtpus);
  if (has_servers && random() % 3 == 0) {
    w.server = random() % 2 == 0 ? ServerKind::kDeferrable : ServerKind::kSporadic;
    w.deadline = w.period;
  }
  return w;
}

}  // namespace

TaskSet random_set(std::uint32_t seed) {
  Random random(seed);
  TaskSet set;
  const std::uint32_t rtpus = below(random, 4) == 0 ? 2 : 1;
  for (std::uint32_t r = 0; r < rtpus; ++r) set.uses.push_back(random_use(random));
  const std::size_t n = 2 + random() % 5;
  const bool is_round = random() % 3 != 0, has_servers = random() % 4 == 0;
  // Shares of a whole that lies where verdicts turn (UUniFast: Bini & Buttazzo 2005).
  double whole = 0.5 + 0.55 * share(random);
  for (std::size_t i = 0; i < n; ++i) {
    const double rest = i + 1 < n ? whole * std::pow(share(random), 1.0 / static_cast<double>(n - i - 1)) : 0;
    set.works.push_back(random_work(random, whole - rest, is_round, rtpus, has_servers));
    whole = rest;
  }
  for (const Work& w : set.works)
    set.uses[w.rtpu].criticality = std::max(set.uses[w.rtpu].criticality, w.criticality);
  if (random() % 4 == 0)
    for (Work& w : set.works) w.offset = Nanoseconds{between(random, 0, 1)};
  return set;
}

std::string text(const TaskSet& set) {
  std::string said;
  for (const ProcessorUse& use : set.uses)
    said += std::string(policy_name(use.policy)) +
            (use.dispatch == Dispatch::kExecutive ? " executive" : "") + " quantum " +
            std::to_string(use.quantum.count) + "; ";
  for (const Work& w : set.works)
    said += "\n  T " + std::to_string(w.period.count) + " D " + std::to_string(w.deadline.count) + " C " +
            std::to_string(w.time.count) + " offset " + std::to_string(w.offset.count) + " criticality " +
            std::to_string(w.criticality) + " user " + std::to_string(w.user_priority) + " rtpu " +
            std::to_string(w.rtpu) + (!w.server ? "" : w.server == ServerKind::kSporadic ? " sporadic" : " deferrable");
  return said;
}

Kind kind_of(const TaskSet& set) {
  Kind kind = Kind::kFixed;
  for (const ProcessorUse& use : set.uses) {
    if (use.policy == Policy::kEdf || use.policy == Policy::kMuf) kind = std::max(kind, Kind::kDeadline);
    if (use.policy == Policy::kLlf || use.policy == Policy::kMufLaxity) kind = std::max(kind, Kind::kLaxity);
    if (use.dispatch == Dispatch::kExecutive) kind = std::max(kind, Kind::kExecutive);
  }
  for (const Work& w : set.works)
    if (w.server) kind = Kind::kServers;
  return kind;
}

}  // namespace chimera::proof
