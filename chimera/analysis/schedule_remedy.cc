// SPDX-License-Identifier: Apache-2.0
// Tries longer periods, other shares and other CPUs until the deadlines of a CPU hold.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "chimera/analysis/schedule_parts.h"
#include "chimera/schedule/utilisation.h"

namespace chimera {
namespace {

constexpr std::size_t kMostTried = 12;  // tasks of one kind of change
constexpr double kMostStretched = 64;   // a rate is lowered to 1/64 at most
constexpr int kBisections = 16;
constexpr std::uint32_t kMostCritical = 2;
constexpr std::int64_t kMostTerms = 200'000'000;  // of the analyses of a search, about half a second

double share(const Work& w) { return static_cast<double>(w.time.count) / static_cast<double>(w.period.count); }

std::uint32_t cpu_of(const SetWorks& set, std::size_t i) { return set.uses[set.works[i].rtpu].cpu; }

bool is_enough(const CpuVerdict& verdict) { return verdict.fits() && !is_beyond(verdict.utilisation); }

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

/// Three digits, to the nearest.
double round_near(double x) {
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 2);
  return std::round(x / unit) * unit;
}

/// The bands of `set` after a change; false: `check` would refuse it, for a task would go before a more critical one.
bool settle_bands(SetWorks& set) {
  std::vector<std::uint32_t> least(set.uses.size()), most(set.uses.size());
  for (std::size_t r = 0; r < set.uses.size(); ++r) {
    least[r] = r < set.outside.size() ? set.outside[r].least : UINT32_MAX;
    most[r] = r < set.outside.size() ? set.outside[r].most : 0;
  }
  for (const Work& w : set.works) {
    least[w.rtpu] = std::min(least[w.rtpu], w.criticality);
    most[w.rtpu] = std::max(most[w.rtpu], w.criticality);
  }
  for (std::size_t i = 0; i < set.uses.size(); ++i) {
    set.uses[i].criticality = most[i];
    for (std::size_t j = 0; j < i; ++j) {
      if (set.uses[i].cpu != set.uses[j].cpu) continue;
      const bool first_above = most[j] >= most[i];  // a tie: the order of the file
      if (least[first_above ? j : i] < most[first_above ? i : j]) return false;
    }
  }
  return true;
}

class Search {
 public:
  Search(const SetWorks& set, std::uint32_t cpu, const std::vector<WorkVerdict>& verdicts)
      : set_(set), cpu_(cpu), verdicts_(verdicts) {}

  std::vector<Remedy> all() {
    std::vector<Remedy> found;
    for (const auto& remedy : {executor(), rate(), processor(), criticality()})
      if (remedy) found.push_back(*remedy);
    return found;
  }

  /// Three digits, down; 0: none was found.
  double scale(double utilisation, bool fits) {
    if (utilisation <= 0) return 0;
    const double most = kMaxUtilisation / utilisation;
    double low = fits ? std::min(1.0, most) : most / kMostStretched, high = most;
    if (fits_scaled(round_near(most))) return round_near(most);
    if (!fits_scaled(low)) return 0;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = std::sqrt(low * high);
      (fits_scaled(middle) ? low : high) = middle;
    }
    for (const double rounded : {round_near(low), round_down(low)})
      if (fits_scaled(rounded)) return rounded;
    return 0;
  }

 private:
  bool lacks(std::size_t i) const {
    return verdicts_[i].guarantee == Guarantee::kNo || verdicts_[i].guarantee == Guarantee::kTooLong;
  }

  /// Tasks of the CPU worth changing, at most kMostTried: those without a promise, then the largest.
  std::vector<std::size_t> candidates() const {
    std::vector<std::size_t> tasks;
    for (std::size_t i = 0; i < set_.works.size(); ++i)
      if (cpu_of(set_, i) == cpu_ && set_.works[i].time.count > 0) tasks.push_back(i);
    std::stable_sort(tasks.begin(), tasks.end(), [&](std::size_t a, std::size_t b) {
      return lacks(a) != lacks(b) ? lacks(a) : share(set_.works[a]) > share(set_.works[b]);
    });
    tasks.resize(std::min(tasks.size(), kMostTried));
    return tasks;
  }

  /// Nothing fits any more when the search has cost enough.
  bool fits_now(const SetWorks& set, std::uint32_t cpu) {
    if (terms_ > kMostTerms) return false;
    std::vector<WorkVerdict> verdicts;
    const CpuVerdict verdict = analyse(set, cpu, verdicts);
    terms_ += verdict.terms;
    return is_enough(verdict);
  }
  /// Both CPUs, where the task has moved.
  bool fits_with(std::size_t task, const Work& work) {
    SetWorks changed = set_;
    changed.works[task] = work;
    return fits_moved(changed, task);
  }
  bool fits_moved(SetWorks& changed, std::size_t task) {
    if (!settle_bands(changed)) return false;
    const std::uint32_t cpu = cpu_of(changed, task);
    return fits_now(changed, cpu_) && (cpu == cpu_ || fits_now(changed, cpu));
  }
  bool fits_stretched(std::size_t task, double factor) { return fits_with(task, stretched(set_.works[task], factor)); }
  bool fits_scaled(double factor) {
    SetWorks scaled = set_;
    for (std::size_t i = 0; i < scaled.works.size(); ++i) {
      Nanoseconds& time = scaled.works[i].time;
      if (time.count == 0 || cpu_of(set_, i) != cpu_) continue;
      time.count = std::max<std::int64_t>(std::llround(static_cast<double>(time.count) * factor), 1);
    }
    return fits_now(scaled, cpu_);
  }

  std::optional<Remedy> executor() {
    for (std::uint32_t r = 0; r < set_.uses.size(); ++r) {
      if (!set_.may_preempt || set_.uses[r].cpu != cpu_ || set_.uses[r].dispatch == Dispatch::kPreemptive) continue;
      SetWorks changed = set_;
      changed.uses[r].dispatch = Dispatch::kPreemptive;
      if (fits_now(changed, cpu_)) return Remedy{.kind = Remedy::Kind::kExecutor, .rtpu = r};
    }
    return std::nullopt;
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
      if (high >= least && best) continue;
      const double period = to_seconds(set_.works[task].period), found = 1 / (period * high);
      for (const double hz : {round_near(found), round_down(found)}) {
        if (hz * period >= 1 || !fits_stretched(task, 1 / (hz * period))) continue;
        least = high;
        best = Remedy{.kind = Remedy::Kind::kRate, .task = task, .hz = hz};
        break;
      }
    }
    return best;
  }

  /// The task that moves with the least load.
  std::optional<Remedy> processor() {
    std::vector<std::size_t> tasks = candidates();
    std::sort(tasks.begin(), tasks.end(),
              [&](std::size_t a, std::size_t b) { return share(set_.works[a]) < share(set_.works[b]); });
    for (const std::size_t task : tasks)
      for (std::uint32_t r = 0; r < set_.uses.size(); ++r) {
        Work moved = set_.works[task];
        moved.rtpu = r;
        if (set_.uses[r].cpu != cpu_ && fits_with(task, moved))
          return Remedy{.kind = Remedy::Kind::kProcessor, .task = task, .rtpu = r};
      }
    for (const std::size_t task : tasks)
      if (fits_elsewhere(task)) return Remedy{.kind = Remedy::Kind::kNewProcessor, .task = task};
    return std::nullopt;
  }
  bool fits_elsewhere(std::size_t task) {
    SetWorks changed = set_;
    ProcessorUse alone = set_.uses[set_.works[task].rtpu];
    alone.cpu = UINT32_MAX;  // of no rtpu: at most 1023 can be written
    changed.uses.push_back(alone);
    changed.works[task].rtpu = static_cast<std::uint32_t>(set_.uses.size());
    return fits_moved(changed, task);
  }

  /// Under `muf`: makes a task without a promise more critical, so that everything fits. Else makes a task less
  /// critical, so that all others are promised. Some task without a promise must be at least as critical as that task.
  std::optional<Remedy> criticality() {
    std::uint32_t most = 0;  // of those without a promise
    for (std::size_t i = 0; i < set_.works.size(); ++i)
      if (cpu_of(set_, i) == cpu_ && lacks(i)) most = std::max(most, set_.works[i].criticality);
    for (const std::size_t task : candidates())
      if (lacks(task) && has_criticalities(task))
        if (auto raised = this->raised(task)) return raised;
    for (const std::size_t task : candidates())
      if (has_criticalities(task) && set_.works[task].criticality <= most && is_for_others(task))
        return Remedy{.kind = Remedy::Kind::kCriticality, .task = task, .criticality = 0, .is_for_others = true};
    return std::nullopt;
  }
  bool has_criticalities(std::size_t task) const {
    return chimera::has_criticalities(set_.uses[set_.works[task].rtpu].policy);
  }
  std::optional<Remedy> raised(std::size_t task) {
    for (Work w = set_.works[task]; w.criticality < kMostCritical;) {
      ++w.criticality;
      if (fits_with(task, w))
        return Remedy{.kind = Remedy::Kind::kCriticality, .task = task, .criticality = w.criticality};
    }
    return std::nullopt;
  }
  bool is_for_others(std::size_t task) {
    if (terms_ > kMostTerms || set_.works[task].criticality == 0) return false;
    SetWorks lowered = set_;
    lowered.works[task].criticality = 0;
    if (!settle_bands(lowered)) return false;
    std::vector<WorkVerdict> verdicts;
    const CpuVerdict verdict = analyse(lowered, cpu_, verdicts);
    terms_ += verdict.terms;
    const bool is_only_one = verdict.not_guaranteed == 1 && verdicts[task].guarantee != Guarantee::kYes;
    return !is_beyond(verdict.utilisation) && (verdict.not_guaranteed == 0 || is_only_one);
  }

  const SetWorks& set_;
  std::uint32_t cpu_;
  const std::vector<WorkVerdict>& verdicts_;
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
    if (fits_without(middle))
      high = middle;
    else
      low = middle + 1;
  }
  order.resize(high);
  return order;
}

std::vector<Remedy> remedies(const SetWorks& set, std::uint32_t cpu, const std::vector<WorkVerdict>& verdicts) {
  return Search(set, cpu, verdicts).all();
}

double most_scale(const SetWorks& set, const CpuVerdict& verdict, const std::vector<WorkVerdict>& verdicts) {
  return Search(set, verdict.cpu, verdicts).scale(verdict.utilisation, is_enough(verdict));
}

}  // namespace chimera
