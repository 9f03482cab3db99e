// SPDX-License-Identifier: Apache-2.0
// The proof of the analysis: random task sets, each simulated in several scenarios (brute_force.h) and compared with
// the verdict of analyse().
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "chimera/schedule/analysis.h"
#include "tests/schedule/brute_force.h"

namespace chimera::proof {

/// One CPU with its rtpus; times in ticks of a nanosecond.
struct TaskSet {
  std::vector<Work> works;
  std::vector<ProcessorUse> uses;
};

/// A random set; equal seeds give equal sets.
TaskSet random_set(std::uint32_t seed);
/// The set in words, for a failure.
std::string text(const TaskSet& set);

/// Mechanism of a set. With more mechanisms, a simulation reaches the bound less often.
enum class Kind : std::uint8_t { kFixed, kDeadline, kLaxity, kExecutive, kServers };
inline constexpr std::array kKindNames = {"fixed priorities", "earliest deadline", "least laxity", "executive",
                                          "servers"};
Kind kind_of(const TaskSet& set);

/// Counted over many sets, by Kind.
struct Tally {
  std::uint64_t sets = 0, fit = 0;
  std::uint64_t not_seen_to_miss = 0;  ///< sets called unschedulable in which no such task was seen to miss
  std::uint64_t exact = 0;             ///< responses compared with the very first after a synchronous release
  std::uint64_t failing_demands = 0;   ///< each seen to miss
  std::uint64_t bounds = 0;
  double bound_over_seen = 0;          ///< sum over `bounds` of bound / longest response seen
};
using Tallies = std::array<Tally, 5>;

/// Judges one set; the failure in words, empty when everything said of it held.
std::string judge(std::uint32_t seed, Tallies& tallies);

}  // namespace chimera::proof
