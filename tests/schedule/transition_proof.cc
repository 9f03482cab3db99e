// SPDX-License-Identifier: Apache-2.0
#include "tests/schedule/transition_proof.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <random>

namespace chimera::proof {
namespace {

using brute::Scenario;
using brute::Seen;
using brute::Tick;

bool is_before(TransitionPart part) { return part != TransitionPart::kArrives; }
bool is_after(TransitionPart part) { return part != TransitionPart::kLeaves; }

class TransitionTrial {
 public:
  TransitionTrial(std::uint32_t seed, const Transition& transition, TransitionTally& tally)
      : seed_(seed), transition_(transition), tally_(tally), random_(seed ^ 0x85ebca6bu), verdicts_(works().size()),
        longest_(works().size()) {
    std::vector<MovingWork> room(works().size());
    verdict_ = analyse_transition(works(), transition.parts, transition.set.uses, 0, verdicts_, room);
  }

  std::string run() {
    for (const Tick change : changes()) {
      for (int world = 0; world < 2; ++world) {
        const std::vector<Seen> seen = brute::Processor(works(), transition_.set.uses, scenario(change, world)).play();
        const std::string wrong = promises(seen);
        if (!wrong.empty()) return wrong + ", change at " + std::to_string(change) + "\n" + text(transition_);
      }
      ++tally_.changes;
    }
    return count();
  }

 private:
  const std::vector<Work>& works() const { return transition_.set.works; }
  std::string name(std::size_t i) const { return "seed " + std::to_string(seed_) + ": task " + std::to_string(i); }

  Tick cycle() const {
    Tick all = 1;
    for (const Work& w : works()) all = std::lcm(all, w.period.count);
    return all;
  }

  /// Within one cycle of all grids, behind one: just behind each release that this takes from the set after, or leaves
  /// to the one before. In between the same jobs are released.
  std::vector<Tick> changes() const {
    std::vector<Tick> all = {cycle()};
    for (std::size_t i = 0; i < works().size(); ++i) {
      const Work& w = works()[i];
      if (transition_.parts[i] == TransitionPart::kStays) continue;
      for (Tick release = w.offset.count; release < 2 * cycle(); release += w.period.count)
        if (release >= cycle()) all.push_back(release + 1);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  Scenario scenario(Tick change, int world) {
    Scenario made;
    Tick longest = 0;
    for (std::size_t i = 0; i < works().size(); ++i) {
      const Work& w = works()[i];
      const Tick period = w.period.count, offset = w.offset.count;
      const Tick next = offset + (change - offset + period - 1) / period * period;
      made.first.push_back(is_before(transition_.parts[i]) ? offset : w.server ? change : next);
      made.until.push_back(is_after(transition_.parts[i]) ? brute::kFar : change);
      made.boundary.push_back(offset);
      longest = std::max(longest, period);
    }
    made.shorter = made.scarce = world > 0;
    made.drops_late = world > 0 && change % 2 == 0;
    made.horizon = change + cycle() + 2 * longest;
    made.seed = static_cast<std::uint32_t>(random_());
    return made;
  }

  bool is_promised(std::size_t i) const { return verdicts_[i].guarantee == Guarantee::kYes; }

  std::string promises(const std::vector<Seen>& seen) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
      misses_ = misses_ || seen[i].missed;
      longest_[i] = std::max(longest_[i], seen[i].worst_response);
      if (!is_promised(i)) continue;
      if (seen[i].missed) return name(i) + " was called schedulable and missed";
      if (seen[i].worst_response > verdicts_[i].response.count)
        return name(i) + " took " + std::to_string(seen[i].worst_response) + ", bound " +
               std::to_string(verdicts_[i].response.count);
    }
    return {};
  }

  bool fits(bool (*is_there)(TransitionPart)) const {
    std::vector<Work> some;
    for (std::size_t i = 0; i < works().size(); ++i)
      if (is_there(transition_.parts[i])) some.push_back(works()[i]);
    std::vector<WorkVerdict> verdicts(some.size());
    std::vector<RankedWork> room(some.size());
    return analyse(some, transition_.set.uses, 0, verdicts, room).fits();
  }

  /// A transition that is promised is one between sets that are, unless phases on a grid say more than analyse() knows.
  std::string count() {
    const bool is_yes = verdict_.guarantee == Guarantee::kYes, alone = fits(is_before) && fits(is_after);
    if (transition_.is_like_for_like && fits(is_before)) {
      ++tally_.like_for_like;
      if (!is_yes) return name(verdict_.task) + " is replaced like for like and not promised\n" + text(transition_);
    }
    ++tally_.transitions;
    tally_.promised += is_yes;
    if (!misses_) {
      ++tally_.never_missed;
      tally_.promised_alone += alone;
    }
    for (std::size_t i = 0; i < verdicts_.size(); ++i) {
      if (!is_promised(i) || longest_[i] == 0) continue;
      ++tally_.bounds;
      tally_.bound_over_seen += static_cast<double>(verdicts_[i].response.count) / static_cast<double>(longest_[i]);
    }
    return {};
  }

  std::uint32_t seed_;
  const Transition& transition_;
  TransitionTally& tally_;
  std::mt19937 random_;
  std::vector<WorkVerdict> verdicts_;
  std::vector<Tick> longest_;
  TransitionVerdict verdict_;
  bool misses_ = false;
};

}  // namespace

std::string judge_transition(std::uint32_t seed, TransitionTallies& tallies) {
  const Transition transition = random_transition(seed);
  return TransitionTrial(seed, transition, tallies[static_cast<std::size_t>(kind_of(transition.set))]).run();
}

std::string table(const TransitionTallies& tallies) {
  char line[200];
  std::snprintf(line, sizeof line, "%-18s %11s %9s %12s %9s %14s %13s %11s\n", "kind", "transitions", "promised",
                "never missed", "share", "share of alone", "like for like", "bound/seen");
  std::string all = line;
  for (std::size_t k = 0; k < tallies.size(); ++k) {
    const TransitionTally& t = tallies[k];
    const auto ratio = [](double a, double b) { return b == 0 ? 0 : a / b; };
    std::snprintf(line, sizeof line, "%-18s %11llu %9llu %12llu %9.3f %14.3f %13llu %11.3f\n", kKindNames[k],
                  static_cast<unsigned long long>(t.transitions), static_cast<unsigned long long>(t.promised),
                  static_cast<unsigned long long>(t.never_missed),
                  ratio(static_cast<double>(t.promised), static_cast<double>(t.never_missed)),
                  ratio(static_cast<double>(t.promised), static_cast<double>(t.promised_alone)),
                  static_cast<unsigned long long>(t.like_for_like),
                  ratio(t.bound_over_seen, static_cast<double>(t.bounds)));
    all += line;
  }
  return all;
}

}  // namespace chimera::proof
