// SPDX-License-Identifier: Apache-2.0
#include "tests/schedule/proof.h"

#include <algorithm>

namespace chimera::proof {
namespace {

using brute::Scenario;
using brute::Seen;
using brute::Tick;

/// Scenarios for one set. In the first, all tasks are released together and use all of their times.
class Worlds {
 public:
  Worlds(const TaskSet& set, std::uint32_t seed) : set_(set), random_(seed ^ 0x9e3779b9u) {
    for (const Work& w : set.works) longest_ = std::max(longest_, w.period.count);
  }

  std::vector<Scenario> all() {
    std::vector<Scenario> worlds = {together(), together(), distance(), distance(), distance()};
    worlds[1].shorter = worlds[1].scarce = worlds[1].drops_late = true;
    worlds[3].shorter = worlds[3].drops_late = true;
    worlds[4].shorter = worlds[4].scarce = true;
    worlds[4].gaps = !has_ties();
    for (int i = 0; i < 3 && has_deferrable(); ++i) worlds.push_back(late_in_the_period());
    for (std::size_t i = 0; i < set_.works.size(); ++i)
      if (set_.uses[set_.works[i].rtpu].dispatch == Dispatch::kExecutive) worlds.push_back(behind(i));
    return worlds;
  }

 private:
  Scenario together() {
    Scenario world;
    for (const Work& w : set_.works) {
      world.first.push_back(0);
      world.boundary.push_back(w.time.count);  // deferrable: all of its capacity, then again
    }
    world.horizon = 120 + 4 * longest_;
    world.seed = static_cast<std::uint32_t>(random_());
    return world;
  }
  /// Offsets at random; tasks of one period and offset stay together, as on their grid.
  Scenario distance() {
    Scenario world = together();
    for (std::size_t i = 0; i < set_.works.size(); ++i) {
      world.first[i] = static_cast<Tick>(random_() % static_cast<std::uint32_t>(set_.works[i].period.count));
      world.boundary[i] = static_cast<Tick>(random_() % static_cast<std::uint32_t>(set_.works[i].period.count));
      for (std::size_t j = 0; j < i; ++j)
        if (is_tie(i, j) && set_.works[i].offset == set_.works[j].offset) world.first[i] = world.first[j];
    }
    world.horizon += longest_;
    return world;
  }
  /// One task begins a tick before all others.
  Scenario behind(std::size_t blocker) {
    Scenario world = together();
    for (std::size_t i = 0; i < set_.works.size(); ++i) {
      world.first[i] = i == blocker ? 0 : 1;
      world.boundary[i] += world.first[i];
    }
    return world;
  }
  /// Deferrable servers have less time to the end of their period than capacity, and with earliest deadline that end
  /// is near.
  Scenario late_in_the_period() {
    Scenario world = together();
    for (std::size_t i = 0; i < set_.works.size(); ++i)
      world.boundary[i] = 1 + static_cast<Tick>(random_() % static_cast<std::uint32_t>(set_.works[i].time.count));
    return world;
  }
  bool has_deferrable() const {
    return std::any_of(set_.works.begin(), set_.works.end(),
                       [](const Work& w) { return w.server == ServerKind::kDeferrable; });
  }
  bool is_tie(std::size_t i, std::size_t j) const {
    const Work &a = set_.works[i], &b = set_.works[j];
    return !a.server && !b.server && a.rtpu == b.rtpu && a.period == b.period;
  }
  bool has_ties() const {
    for (std::size_t i = 0; i < set_.works.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (is_tie(i, j)) return true;
    return false;
  }

  const TaskSet& set_;
  std::mt19937 random_;
  Tick longest_ = 0;
};

class Trial {
 public:
  Trial(std::uint32_t seed, Tally& tally) : set_(random_set(seed)), tally_(tally), verdicts_(set_.works.size()) {
    std::vector<RankedWork> room(set_.works.size());
    cpu_ = analyse(set_.works, set_.uses, 0, verdicts_, room);
    longest_.resize(set_.works.size());
    seed_ = seed;
  }

  std::string run() {
    bool is_first = true;
    for (const Scenario& world : Worlds(set_, seed_).all()) {
      const std::vector<Seen> seen = brute::Processor(set_.works, set_.uses, world).play();
      std::string wrong = promises(seen);
      if (wrong.empty() && is_first) wrong = precision(seen, world.horizon);
      if (!wrong.empty()) return wrong + "\n" + text(set_);
      is_first = false;
    }
    count();
    return {};
  }

 private:
  bool is_promised(std::size_t i) const { return verdicts_[i].guarantee == Guarantee::kYes; }
  std::string name(std::size_t i) const { return "seed " + std::to_string(seed_) + ": task " + std::to_string(i); }

  /// Each guaranteed task meets its deadline, and every bound holds.
  std::string promises(const std::vector<Seen>& seen) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
      misses_ |= !is_promised(i) && seen[i].missed;
      longest_[i] = std::max(longest_[i], seen[i].worst_response);
      if (!is_promised(i)) continue;
      if (seen[i].missed) return name(i) + " was called schedulable and missed";
      if (seen[i].worst_response > verdicts_[i].response.count)
        return name(i) + " took " + std::to_string(seen[i].worst_response) + ", bound " +
               std::to_string(verdicts_[i].response.count);
    }
    return {};
  }

  bool all_before_are_promised(std::uint32_t level) const {
    for (std::size_t i = 0; i < verdicts_.size(); ++i)
      if (verdicts_[i].level < level && !is_promised(i)) return false;
    return true;
  }

  /// An exact response is reached if all tasks are released together; a failing demand misses its deadline then.
  std::string precision(const std::vector<Seen>& seen, Tick horizon) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const WorkVerdict& verdict = verdicts_[i];
      if (!verdict.is_exact || !all_before_are_promised(verdict.level)) continue;
      ++tally_.exact;
      if (verdict.response == kNever && !seen[i].missed) return name(i) + " has no bound and did not miss";
      if (verdict.response != kNever && seen[i].first_response != verdict.response.count)
        return name(i) + " took " + std::to_string(seen[i].first_response) + " first, said to be exactly " +
               std::to_string(verdict.response.count);
    }
    return failing_demand(seen, horizon);
  }

  std::string failing_demand(const std::vector<Seen>& seen, Tick horizon) {
    if (kind_of(set_) != Kind::kDeadline || cpu_.demand.within.count == 0 || cpu_.demand.within.count >= horizon)
      return {};
    std::uint32_t level = UINT32_MAX;
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (!is_promised(i)) level = std::min(level, verdicts_[i].level);
    if (!all_before_are_promised(level)) return {};
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (verdicts_[i].level != level || set_.uses[set_.works[i].rtpu].policy == Policy::kRm) continue;
      if (seen[i].missed) return ++tally_.failing_demands, "";
      if (i + 1 == seen.size()) return name(i) + " and those of its level did not miss, and their demand fails";
    }
    return {};
  }

  void count() {
    ++tally_.sets;
    tally_.fit += cpu_.fits();
    tally_.not_seen_to_miss += !cpu_.fits() && !misses_;
    for (std::size_t i = 0; i < verdicts_.size(); ++i) {
      if (!is_promised(i) || longest_[i] == 0) continue;
      ++tally_.bounds;
      tally_.bound_over_seen += static_cast<double>(verdicts_[i].response.count) / static_cast<double>(longest_[i]);
    }
  }

  TaskSet set_;
  Tally& tally_;
  std::vector<WorkVerdict> verdicts_;
  std::vector<Tick> longest_;
  CpuVerdict cpu_;
  std::uint32_t seed_ = 0;
  bool misses_ = false;
};

}  // namespace

std::string judge(std::uint32_t seed, Tallies& tallies) {
  Tally& tally = tallies[static_cast<std::size_t>(kind_of(random_set(seed)))];
  return Trial(seed, tally).run();
}

}  // namespace chimera::proof
