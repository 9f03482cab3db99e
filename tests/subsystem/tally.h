// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "chimera/task/state_machine.h"

namespace chimera::simulated {

/// How often what happened: every transition of the state machine, every action, every fault point by name.
class Tally {
 public:
  void count(const std::string& what, std::uint64_t n = 1) { counts_[what] += n; }
  void count_signal(State state, Signal signal, bool aperiodic);
  void count_answer(Step step, Answer answer);
  void add(const Tally& other) {
    for (const auto& [what, n] : other.counts_) counts_[what] += n;
  }
  std::uint64_t of(const std::string& what) const {
    const auto found = counts_.find(what);
    return found == counts_.end() ? 0 : found->second;
  }
  const std::map<std::string, std::uint64_t>& all() const noexcept { return counts_; }
  /// Names of the transitions and events that must happen over many seeds and did not.
  std::vector<std::string> missing() const;

 private:
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace chimera::simulated
