// SPDX-License-Identifier: Apache-2.0
// The proof of the analysis of transitions: two random sets with common tasks, simulated on their grids with the change
// at every instant that makes a difference, and compared with the verdict of analyse_transition().
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "chimera/schedule/transition.h"
#include "tests/schedule/proof.h"

namespace chimera::proof {

/// `parts[i]` is the change of set.works[i], and set.works[i].offset is the phase of its grid.
struct Transition {
  TaskSet set;
  std::vector<TransitionPart> parts;
  bool is_like_for_like = false;  ///< only replaces tasks by such with no longer times
};

/// A random transition; equal seeds give equal transitions.
Transition random_transition(std::uint32_t seed);
std::string text(const Transition& transition);

/// Counted over many transitions, by Kind.
struct TransitionTally {
  std::uint64_t transitions = 0, changes = 0;  ///< instants of change that were played
  std::uint64_t promised = 0;
  std::uint64_t never_missed = 0;       ///< transitions in which no task was seen to miss
  std::uint64_t promised_alone = 0;     ///< of these: both sets by themselves are promised
  std::uint64_t like_for_like = 0;      ///< with the set before promised, and so all of them
  std::uint64_t bounds = 0;
  double bound_over_seen = 0;           ///< sum over `bounds` of bound / longest response seen
};
using TransitionTallies = std::array<TransitionTally, 5>;

/// Judges one transition; the failure in words, empty when everything said of it held.
std::string judge_transition(std::uint32_t seed, TransitionTallies& tallies);
/// The tallies as a table, one line a kind.
std::string table(const TransitionTallies& tallies);

}  // namespace chimera::proof
