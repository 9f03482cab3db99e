// SPDX-License-Identifier: Apache-2.0
// Sorts the tasks of a CPU into levels and proves or refutes the deadlines level by level.
#include "chimera/schedule/analysis.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/base/math.h"
#include "chimera/schedule/rank.h"
#include "chimera/schedule/response.h"

namespace chimera {
namespace {

constexpr std::int64_t kMostTerms = 100'000'000;

/// The time that a policy compares between tasks of one rtpu: within a level, or, under `rm`, between levels.
Nanoseconds key_of(const Work& w, Policy policy) noexcept { return policy == Policy::kRm ? w.period : w.deadline; }

bool goes_before(std::span<const ProcessorUse> uses, const RankedWork& a, const RankedWork& b) noexcept {
  if (a.band != b.band) return a.band < b.band;
  const Policy policy = uses[a.work.rtpu].policy;
  if (has_criticalities(policy) && a.work.criticality != b.work.criticality)
    return a.work.criticality > b.work.criticality;
  const Nanoseconds ka = key_of(a.work, policy), kb = key_of(b.work, policy);
  if (ka != kb) return ka < kb;
  if (a.work.user_priority != b.work.user_priority) return a.work.user_priority > b.work.user_priority;
  return a.tie < b.tie;
}

/// Walks once over the tasks of a CPU.
class Analysis {
 public:
  Analysis(std::span<const Work> works, std::span<const ProcessorUse> uses, std::uint32_t cpu,
           std::span<WorkVerdict> verdicts, std::span<RankedWork> room) noexcept
      : works_(works), uses_(uses), verdicts_(verdicts) {
    verdict_.cpu = cpu;
    ranked_ = rank(room);
    for (const RankedWork& r : ranked_) verdicts_[r.task] = {};
  }

  CpuVerdict run() noexcept {
    add_up();
    for (std::uint32_t at = 0, number = 0; at < ranked_.size();) {
      const Level level = level_at(at);
      const bool is_alone = level.order == LevelOrder::kAlone;
      const std::uint32_t end = is_alone ? end_of_equals(at) : level.end;
      for (std::uint32_t i = at; i < end; ++i) verdict_of(i).level = is_alone ? number++ : number;
      if (is_alone) judge_equals(at, end, level.dispatch == Dispatch::kPreemptive);
      else judge_together(level), ++number;
      at = end;
    }
    for (const RankedWork& r : ranked_) count(r);
    verdict_.terms = kMostTerms - effort_.terms;
    return verdict_;
  }

 private:
  std::span<RankedWork> rank(std::span<RankedWork> room) noexcept {
    std::size_t n = 0;
    for (std::uint32_t i = 0; i < works_.size(); ++i) {
      CHIMERA_ASSERT(works_[i].rtpu < uses_.size() && works_[i].period > Nanoseconds{});
      if (uses_[works_[i].rtpu].cpu != verdict_.cpu) continue;
      CHIMERA_ASSERT(n < room.size());
      room[n++] = ranked_work(works_, uses_, i);
    }
    const auto ranked = room.first(n);
    std::sort(ranked.begin(), ranked.end(),
              [this](const RankedWork& a, const RankedWork& b) { return goes_before(uses_, a, b); });
    return ranked;
  }

  WorkVerdict& verdict_of(std::uint32_t rank) noexcept { return verdicts_[ranked_[rank].task]; }

  void add_up() noexcept {
    verdict_.tasks = static_cast<std::uint32_t>(ranked_.size());
    verdict_.hyperbolic = 1;
    for (const RankedWork& r : ranked_) {
      if (r.work.time == Nanoseconds{}) ++verdict_.unstated;
      const double u = static_cast<double>(works_[r.task].time.count) / static_cast<double>(r.work.period.count);
      verdict_.utilisation += u;
      verdict_.hyperbolic *= 1 + u;
    }
    const double n = verdict_.tasks - verdict_.unstated;
    verdict_.rate_monotonic_bound = n > 0 ? n * (math::exp(math::log(2.0) / n) - 1) : 0;
  }

  Level level_at(std::uint32_t begin) const noexcept {
    const RankedWork& first = ranked_[begin];
    const ProcessorUse& use = uses_[first.work.rtpu];
    Level level{.ranked = ranked_, .begin = begin, .end = begin + 1, .order = order_of(use.policy),
                .dispatch = use.dispatch, .quantum = use.quantum};
    const auto belongs = [&](const RankedWork& r) {
      return r.band == first.band &&
             (!has_criticalities(use.policy) || r.work.criticality == first.work.criticality);
    };
    if (level.order != LevelOrder::kAlone)
      while (level.end < ranked_.size() && belongs(ranked_[level.end])) ++level.end;
    return level;
  }

  /// End of the tasks with the rank of the task at `begin`: same period and user priority. Between them the running job
  /// stays.
  std::uint32_t end_of_equals(std::uint32_t begin) const noexcept {
    const RankedWork& first = ranked_[begin];
    std::uint32_t end = begin + 1;
    while (end < ranked_.size() && ranked_[end].band == first.band && ranked_[end].work.period == first.work.period &&
           ranked_[end].work.user_priority == first.work.user_priority)
      ++end;
    return end;
  }
  static bool is_apart(const RankedWork& a, const RankedWork& b) noexcept {
    return a.work.offset != b.work.offset || a.work.server || b.work.server;
  }

  /// Equals that are released together run in the order of their ties. If one of them may be late, if their offsets
  /// differ, or if one is a server, each may find another running. Then all of them get the bound of
  /// their busy period.
  void judge_equals(std::uint32_t begin, std::uint32_t end, bool preemptive) noexcept {
    bool in_order = true;
    for (std::uint32_t i = begin; i < end; ++i) {
      judge_alone(level_at(i));
      in_order = in_order && verdict_of(i).guarantee == Guarantee::kYes && !is_apart(ranked_[begin], ranked_[i]);
    }
    if (in_order || !preemptive || end - begin == 1) return;
    Level together = level_at(begin);
    together.end = end;
    const Nanoseconds busy = busy_period(together, {}, effort_);
    for (std::uint32_t i = begin; i < end; ++i) decide(ranked_[i], {busy, {}}, false);
  }

  void judge_alone(const Level& level) noexcept {
    const bool preemptive = level.dispatch == Dispatch::kPreemptive;
    decide(ranked_[level.begin], preemptive ? preemptive_response(level, effort_) : executive_response(level, effort_),
           preemptive && !has_server(level.up_to_here()));
  }

  void decide(const RankedWork& r, const Response& response, bool is_exact) noexcept {
    WorkVerdict& verdict = verdicts_[r.task];
    verdict.response = response.most;
    verdict.blocking = response.blocking;
    verdict.is_exact = is_exact;
    const bool is_lost = response.most == kNever && effort_.is_spent();
    verdict.guarantee = is_lost                                 ? Guarantee::kTooLong
                        : response.most <= r.work.deadline ? Guarantee::kYes
                                                                : Guarantee::kNo;
  }
  static bool has_server(std::span<const RankedWork> works) noexcept {
    return std::any_of(works.begin(), works.end(), [](const RankedWork& r) { return r.work.server.has_value(); });
  }

  void judge_together(const Level& level) noexcept {
    const Nanoseconds blocking = blocking_of_later(level);
    const Nanoseconds busy = busy_period(level, blocking, effort_);
    Demand demand;
    const Judgement judgement = demand_holds(level, demand, effort_);
    if (judgement == Judgement::kFails && verdict_.demand.within == Nanoseconds{}) verdict_.demand = demand;
    for (std::uint32_t i = level.begin; i < level.end; ++i) {
      const RankedWork& r = ranked_[i];
      WorkVerdict& verdict = verdicts_[r.task];
      const bool holds = judgement == Judgement::kHolds;
      verdict.response = holds ? std::min(r.work.deadline, busy) : busy;
      verdict.blocking = blocking;
      const bool is_lost = judgement == Judgement::kGivenUp || (busy == kNever && effort_.is_spent());
      verdict.guarantee = verdict.response <= r.work.deadline ? Guarantee::kYes
                          : is_lost                           ? Guarantee::kTooLong
                                                              : Guarantee::kNo;
    }
  }

  void count(const RankedWork& r) noexcept {
    WorkVerdict& verdict = verdicts_[r.task];
    const Work& w = works_[r.task];
    if (w.time == Nanoseconds{}) {
      verdict.guarantee = Guarantee::kNotStated;
      return;
    }
    if (w.time > w.deadline) verdict.guarantee = Guarantee::kNo;
    ++(verdict.guarantee == Guarantee::kYes ? verdict_.guaranteed : verdict_.not_guaranteed);
  }

  std::span<const Work> works_;
  std::span<const ProcessorUse> uses_;
  std::span<WorkVerdict> verdicts_;
  std::span<RankedWork> ranked_;
  CpuVerdict verdict_;
  Effort effort_{kMostTerms};
};

}  // namespace

CpuVerdict analyse(std::span<const Work> works, std::span<const ProcessorUse> uses, std::uint32_t cpu,
                   std::span<WorkVerdict> verdicts, std::span<RankedWork> room) noexcept {
  CHIMERA_ASSERT(verdicts.size() == works.size());
  return Analysis(works, uses, cpu, verdicts, room).run();
}

}  // namespace chimera
