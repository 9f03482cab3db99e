// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/schedule/transition_proof.h"

namespace chimera::proof {
namespace {

using Random = std::mt19937;

std::int64_t between(Random& random, std::int64_t least, std::int64_t most) {
  return std::uniform_int_distribution<std::int64_t>(least, most)(random);
}
double share(Random& random) { return std::uniform_real_distribution<double>(0, 1)(random); }

/// Periods that meet again soon: every place of the change is played.
constexpr std::int64_t kPeriods[][5] = {{4, 6, 8, 12, 24}, {4, 5, 10, 20, 20}, {5, 6, 10, 15, 30}, {3, 4, 6, 12, 12},
                                        {6, 9, 12, 18, 36}};

class Maker {
 public:
  explicit Maker(std::uint32_t seed) : random_(seed) {}

  Transition make() {
    const TaskSet like = random_set(static_cast<std::uint32_t>(random_()));  // for its rtpus
    made_.set.uses = like.uses;
    periods_ = kPeriods[random_() % std::size(kPeriods)];
    has_offsets_ = random_() % 2 == 0;
    has_servers_ = random_() % 6 == 0;
    const double whole = 0.45 + 0.5 * share(random_), stays = random_() % 4 == 0 ? 0 : whole * share(random_);
    add(stays, TransitionPart::kStays, 1 + random_() % 3);
    const std::size_t first = made_.parts.size();
    add(whole - stays, TransitionPart::kLeaves, 1 + random_() % 3);
    switch (random_() % 4) {
      case 0: replace(first, true); break;
      case 1: replace(first, false); [[fallthrough]];
      default: add((0.45 + 0.5 * share(random_)) - stays, TransitionPart::kArrives, random_() % 4);
    }
    shuffle();
    for (const Work& w : made_.set.works) {
      ProcessorUse& use = made_.set.uses[w.rtpu];
      use.criticality = std::max(use.criticality, w.criticality);
    }
    return std::move(made_);
  }

 private:
  void add(double load, TransitionPart part, std::size_t n) {
    for (std::size_t i = 0; i < n && load > 0.02; ++i) {
      const double mine = i + 1 == n ? load : load * share(random_);
      load -= mine;
      made_.set.works.push_back(work(mine));
      made_.parts.push_back(part);
    }
  }

  Work work(double load) {
    Work w;
    w.period = Nanoseconds{periods_[random_() % 5]};
    w.time = Nanoseconds{
        std::clamp<std::int64_t>(std::llround(load * static_cast<double>(w.period.count)), 1, w.period.count)};
    w.deadline = random_() % 3 == 0 ? Nanoseconds{between(random_, w.time.count, w.period.count)} : w.period;
    w.offset = has_offsets_ ? Nanoseconds{between(random_, 0, w.period.count - 1)} : Nanoseconds{};
    w.criticality = static_cast<std::uint32_t>(random_() % 3);
    w.user_priority = random_() % 3 == 0 ? static_cast<std::uint32_t>(random_() % 3) : 0;
    w.rtpu = static_cast<std::uint32_t>(random_() % made_.set.uses.size());
    if (has_servers_ && random_() % 3 == 0) {
      w.server = random_() % 2 == 0 ? ServerKind::kDeferrable : ServerKind::kSporadic;
      w.deadline = w.period;
    }
    return w;
  }

  /// Successors of the leaving tasks from `first` on, like for like; all of them, with no longer times, or some. In the
  /// description a successor follows the one before it, or, where all grids begin together, stands behind all others.
  void replace(std::size_t first, bool all) {
    made_.is_like_for_like = all;
    const bool behind = !has_offsets_ && random_() % 2 == 0;
    for (std::size_t i = first, end = made_.parts.size(); i < end; ++i) {
      const std::size_t at = behind ? i : first + 2 * (i - first);
      Work next = made_.set.works[all ? at : i];
      if (all && next.server) made_.is_like_for_like = false;  // both count
      if (!all && random_() % 2 == 0) continue;
      next.time = Nanoseconds{between(random_, 1, all ? next.time.count : next.deadline.count)};
      const std::size_t to = behind || !all ? made_.parts.size() : at + 1;
      made_.set.works.insert(made_.set.works.begin() + static_cast<std::ptrdiff_t>(to), next);
      made_.parts.insert(made_.parts.begin() + static_cast<std::ptrdiff_t>(to), TransitionPart::kArrives);
    }
  }

  /// Any order in the description, but for tasks replaced like for like.
  void shuffle() {
    if (made_.is_like_for_like) return;
    for (std::size_t i = made_.parts.size(); i > 1; --i) {
      const std::size_t j = random_() % i;
      std::swap(made_.parts[i - 1], made_.parts[j]);
      std::swap(made_.set.works[i - 1], made_.set.works[j]);
    }
  }

  Random random_;
  Transition made_;
  const std::int64_t* periods_ = nullptr;
  bool has_offsets_ = false, has_servers_ = false;
};

}  // namespace

Transition random_transition(std::uint32_t seed) { return Maker(seed).make(); }

std::string text(const Transition& transition) {
  constexpr const char* kParts[] = {"absent", "stays", "leaves", "arrives"};
  std::string said = text(transition.set);
  for (std::size_t i = 0; i < transition.parts.size(); ++i)
    said += "\n  " + std::to_string(i) + " " + kParts[static_cast<int>(transition.parts[i])];
  return said;
}

}  // namespace chimera::proof
