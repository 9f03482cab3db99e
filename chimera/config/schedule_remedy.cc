// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "chimera/config/schedule_parts.h"
#include "chimera/schedule/utilisation.h"

namespace chimera {
namespace {

constexpr std::size_t kMostTried = 12;   // tasks of one kind of change
constexpr double kMostStretched = 64;    // a rate is lowered to 1/64 at most
constexpr int kBisections = 16;
constexpr std::int64_t kMostTerms = 200'000'000;  // of the analyses of a search, about half a second

double share(const Work& w) { return static_cast<double>(w.time.count) / static_cast<double>(w.period.count); }

std::uint32_t cpu_of(const SetWorks& set, std::size_t i) { return set.uses[set.works[i].rtpu].cpu; }

bool is_enough(const CpuVerdict& verdict) {
  return verdict.fits() && !is_beyond(verdict.utilisation);
}

/// With a period longer by `factor`; a deadline that is the period stays it.
Work stretched(Work w, double factor) {
  const bool is_implicit = w.deadline == w.period;
  w.period = Nanoseconds{std::llround(static_cast<double>(w.period.count) * factor)};
  if (is_implicit) w.deadline = w.period;
  return w;
}

/// Three digits, down.
double round_down(double hz) {
  const double unit = std::pow(10.0, std::floor(std::log10(hz)) - 2);
  return std::floor(hz / unit + 1e-9) * unit;
}

class Search {
 public:
  Search(const SetWorks& set, std::uint32_t cpu, const std::vector<WorkVerdict>& verdicts)
      : set_(set), cpu_(cpu), verdicts_(verdicts), changed_(set) {}

  std::vector<Remedy> all() {
    std::vector<Remedy> found;
    for (const auto& remedy : {rate(), processor(), criticality()})
      if (remedy) found.push_back(*remedy);
    return found;
  }

 private:
  /// Tasks of the CPU worth changing, at most kMostTried: those without a promise, then the largest.
  std::vector<std::size_t> candidates() const {
    std::vector<std::size_t> tasks;
    for (std::size_t i = 0; i < set_.works.size(); ++i)
      if (cpu_of(set_, i) == cpu_ && set_.works[i].time.count > 0) tasks.push_back(i);
    std::stable_sort(tasks.begin(), tasks.end(), [&](std::size_t a, std::size_t b) {
      const bool lacks_a = verdicts_[a].guarantee != Guarantee::kYes;
      const bool lacks_b = verdicts_[b].guarantee != Guarantee::kYes;
      return lacks_a != lacks_b ? lacks_a : share(set_.works[a]) > share(set_.works[b]);
    });
    tasks.resize(std::min(tasks.size(), kMostTried));
    return tasks;
  }

  template <class Change>
  bool would_fit(std::size_t task, Change change) {
    const Work before = changed_.works[task];
    change(changed_.works[task]);
    const std::uint32_t cpu = cpu_of(changed_, task);
    const bool fit = fits_now(cpu_) && (cpu == cpu_ || fits_now(cpu));
    changed_.works[task] = before;
    return fit;
  }
  /// Nothing fits any more when the search has cost enough.
  bool fits_now(std::uint32_t cpu) {
    if (terms_ > kMostTerms) return false;
    std::vector<WorkVerdict> verdicts;
    const CpuVerdict verdict = analyse(changed_, cpu, verdicts);
    terms_ += verdict.terms;
    return is_enough(verdict);
  }

  bool fits_stretched(std::size_t task, double factor) {
    return would_fit(task, [factor](Work& w) { w = stretched(w, factor); });
  }

  std::optional<Remedy> rate() {
    std::optional<Remedy> best;
    double least = kMostStretched;
    for (const std::size_t task : candidates()) {
      if (set_.works[task].server || !fits_stretched(task, least)) continue;
      double low = 1, high = least;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = std::sqrt(low * high);
        (fits_stretched(task, middle) ? high : low) = middle;
      }
      const double period = to_seconds(set_.works[task].period);
      const double hz = round_down(1 / (period * high));
      if (high >= least && best) continue;
      if (!fits_stretched(task, 1 / (hz * period))) continue;
      least = high;
      best = Remedy{.kind = Remedy::Kind::kRate, .task = task, .hz = hz};
    }
    return best;
  }

  /// The task that moves with the least load.
  std::optional<Remedy> processor() {
    std::vector<std::size_t> tasks = candidates();
    std::sort(tasks.begin(), tasks.end(),
              [&](std::size_t a, std::size_t b) { return share(set_.works[a]) < share(set_.works[b]); });
    for (const std::size_t task : tasks)
      for (std::uint32_t r = 0; r < set_.uses.size(); ++r)
        if (set_.uses[r].cpu != cpu_ && would_fit(task, [r](Work& w) { w.rtpu = r; }))
          return Remedy{.kind = Remedy::Kind::kProcessor, .task = task, .rtpu = r};
    for (const std::size_t task : tasks) {
      const Work& w = set_.works[task];
      if (w.time <= w.deadline && !is_beyond(share(w)) &&
          would_fit(task, [](Work& without) { without.time = {}; }))
        return Remedy{.kind = Remedy::Kind::kNewProcessor, .task = task};
    }
    return std::nullopt;
  }

  /// Under `muf`: one task made less critical than all others of its rtpu, so that those are promised.
  std::optional<Remedy> criticality() {
    for (const std::size_t task : candidates()) {
      if (terms_ > kMostTerms) break;
      const Work& w = set_.works[task];
      const Policy policy = set_.uses[w.rtpu].policy;
      if ((policy != Policy::kMuf && policy != Policy::kMufLaxity) || w.criticality == 0) continue;
      SetWorks lowered = set_;
      lowered.works[task].criticality = 0;
      std::vector<WorkVerdict> verdicts;
      const CpuVerdict verdict = analyse(lowered, cpu_, verdicts);
      terms_ += verdict.terms;
      const bool only_it = verdict.not_guaranteed == 0 ||
                           (verdict.not_guaranteed == 1 && verdicts[task].guarantee != Guarantee::kYes);
      if (only_it) return Remedy{.kind = Remedy::Kind::kCriticality, .task = task};
    }
    return std::nullopt;
  }

  const SetWorks& set_;
  std::uint32_t cpu_;
  const std::vector<WorkVerdict>& verdicts_;
  SetWorks changed_;
  std::int64_t terms_ = 0;
};

}  // namespace

CpuVerdict analyse(const SetWorks& set, std::uint32_t cpu, std::vector<WorkVerdict>& verdicts) {
  verdicts.resize(set.works.size());
  std::vector<RankedWork> room(set.works.size());
  return analyse(set.works, set.uses, cpu, verdicts, room);
}

bool fits(const SetWorks& set, std::uint32_t cpu) {
  std::vector<WorkVerdict> verdicts;
  return is_enough(analyse(set, cpu, verdicts));
}

std::vector<std::size_t> give_way(const SetWorks& set, std::uint32_t cpu, const std::vector<WorkVerdict>& verdicts) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < set.works.size(); ++i)
    if (cpu_of(set, i) == cpu && set.works[i].time.count > 0) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Work &wa = set.works[a], &wb = set.works[b];
    if (wa.criticality != wb.criticality) return wa.criticality < wb.criticality;
    if (verdicts[a].level != verdicts[b].level) return verdicts[a].level > verdicts[b].level;
    return wa.deadline > wb.deadline;
  });
  const auto fits_without = [&](std::size_t n) {
    SetWorks rest = set;
    for (std::size_t i = 0; i < n; ++i) rest.works[order[i]].time = {};
    return fits(rest, cpu);
  };
  std::size_t low = 0, high = order.size();  // without all of them it fits
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (fits_without(middle)) high = middle;
    else low = middle + 1;
  }
  order.resize(high);
  return order;
}

std::vector<Remedy> remedies(const SetWorks& set, std::uint32_t cpu, const std::vector<WorkVerdict>& verdicts) {
  return Search(set, cpu, verdicts).all();
}

}  // namespace chimera
