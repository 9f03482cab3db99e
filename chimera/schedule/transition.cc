// SPDX-License-Identifier: Apache-2.0
// Proves the deadlines of a transition, level by level, for each place of the change in a busy window.
#include "chimera/schedule/transition.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/schedule/rank.h"

namespace chimera {
namespace {

constexpr std::int64_t kMostTerms = 20'000'000;
constexpr Nanoseconds kTick{1};

enum class Precedence : std::uint8_t { kBefore, kEqual, kAfter };

/// One attempt over the tasks of a CPU.
class TransitionAttempt {
 public:
  /// All arguments must outlive this object.
  TransitionAttempt(std::span<MovingWork> works, std::span<const ProcessorUse> uses, std::span<WorkVerdict> verdicts,
                    Effort& effort) noexcept
      : works_(works), uses_(uses), verdicts_(verdicts), window_(works), effort_(effort) {}

  void run() noexcept {
    const bool is_overloaded = greater_share([](const MovingWork&) { return true; }) > 1.0 + 1e-12;
    for (MovingWork& w : works_) w.is_judged = false;
    for (MovingWork& w : works_) {
      if (w.is_judged) continue;
      if (is_overloaded) decide(w, {}, Judgement::kFails);
      else if (order(w) == LevelOrder::kAlone) judge_equals(w);
      else judge_level(w);
    }
  }

 private:
  const ProcessorUse& use(const MovingWork& w) const noexcept { return uses_[w.ranked.work.rtpu]; }
  LevelOrder order(const MovingWork& w) const noexcept { return order_of(use(w).policy); }
  bool is_executive(const MovingWork& w) const noexcept { return use(w).dispatch == Dispatch::kExecutive; }
  std::int64_t cost() const noexcept { return static_cast<std::int64_t>(2 * works_.size()); }

  /// Processor share of the tasks that are `chosen`, and that stay or have `part`.
  template <class Chosen>
  double share(TransitionPart part, Chosen chosen) const noexcept {
    double sum = 0;
    for (const MovingWork& w : works_)
      if ((w.part == part || w.part == TransitionPart::kStays) && chosen(w))
        sum += static_cast<double>(w.ranked.work.time.count) / static_cast<double>(w.ranked.work.period.count);
    return sum;
  }
  template <class Chosen>
  double greater_share(Chosen chosen) const noexcept {
    return std::max(share(TransitionPart::kLeaves, chosen), share(TransitionPart::kArrives, chosen));
  }

  /// The rank of `a` relative to `b`. Equal: in one level, or with one period and priority.
  Precedence standing(const MovingWork& a, const MovingWork& b) const noexcept {
    const auto by = [](auto x, auto y) {
      return x < y ? Precedence::kBefore : x > y ? Precedence::kAfter : Precedence::kEqual;
    };
    const Work &wa = a.ranked.work, &wb = b.ranked.work;
    if (a.ranked.band != b.ranked.band) return by(a.ranked.band, b.ranked.band);
    const bool by_criticality = has_criticalities(use(a).policy);
    if (by_criticality && wa.criticality != wb.criticality) return by(wb.criticality, wa.criticality);
    if (order(a) != LevelOrder::kAlone) return Precedence::kEqual;
    if (wa.period != wb.period) return by(wa.period, wb.period);
    return by(wb.user_priority, wa.user_priority);
  }
  bool is_equal(const MovingWork& a, const MovingWork& b) const noexcept {
    return standing(a, b) == Precedence::kEqual;
  }

  /// True if a job of `a` may run before a waiting job of `b`. Equals run in the order of their ties if they are
  /// released together, or in an executive. With `mixed`, the running job stays. Staying tasks of one grid, under one
  /// name or two, meet only tasks of their own set.
  bool may_go_before(const MovingWork& a, const MovingWork& b, bool mixed) const noexcept {
    const Precedence how = standing(a, b);
    if (how != Precedence::kEqual) return how == Precedence::kBefore;
    const bool stay = a.part == TransitionPart::kStays && b.part == TransitionPart::kStays && a.is_on_grid_of(b);
    if (mixed) return true;
    return stay ? a.ranked.tie < b.ranked.tie || a.partner_tie < b.partner_tie : a.first_tie() < b.last_tie();
  }

  /// The longest job that may run when the window of `w` begins, without the jobs that run before `w`. It began before
  /// the window. So it belongs to the set before the change, if the change lies in the window.
  template <class CanBlock>
  Nanoseconds blocking(const MovingWork& w, CanBlock can_block) const noexcept {
    Nanoseconds most;
    if (!is_executive(w)) return most;
    for (const MovingWork& other : works_) {
      const bool is_new = other.part == TransitionPart::kArrives && window_.change() > Nanoseconds{};
      if (is_new || other.ranked.work.rtpu != w.ranked.work.rtpu || !can_block(other)) continue;
      most = std::max(most, other.ranked.work.time - kTick);
    }
    return most;
  }

  template <class F>
  Nanoseconds least(Nanoseconds from, Nanoseconds limit, F f) noexcept {
    return least_fixed_point(std::max(from, kTick), limit, cost(), effort_, f);
  }

  /// The longest time that the processor is busy with the chosen works and `first`. A full processor never catches up.
  Nanoseconds busy_with(Nanoseconds first) noexcept {
    Nanoseconds ahead = first;
    for (const MovingWork& w : works_)
      if (w.is_chosen) ahead += w.ranked.jitter;
    const bool is_full = greater_share([](const MovingWork& w) { return w.is_chosen; }) > 1.0 - 1e-9;
    if (is_full && ahead > Nanoseconds{}) return kNever;
    return least(first, kLongestInterval, [&](Nanoseconds t) { return first + window_.released(t - kTick); });
  }

  template <class Chosen>
  void choose(Chosen chosen) noexcept {
    for (MovingWork& w : works_) w.is_chosen = chosen(w);
  }

  // Fixed priorities:

  void judge_equals(const MovingWork& first) noexcept {
    bool mixed = false;
    for (const MovingWork& w : works_)
      mixed = mixed || (is_equal(w, first) && &w != &first && !w.is_on_grid_of(first));
    mixed = mixed && !is_executive(first);
    if (judge_equals(first, mixed) || mixed || is_executive(first)) return;
    (void)judge_equals(first, true);  // one of them may be late: the running job stays
  }
  bool judge_equals(const MovingWork& first, bool mixed) noexcept {
    bool all = true;
    for (MovingWork& w : works_) {
      if (!is_equal(w, first)) continue;
      const Nanoseconds most = longest_response(w, mixed);
      decide(w, most, most == kNever && effort_.is_spent() ? Judgement::kGivenUp : Judgement::kHolds);
      all = all && verdicts_[w.ranked.task].guarantee == Guarantee::kYes;
    }
    return all;
  }

  /// The maximum over all places of the change; kNever: no bound was found, or it is beyond the period.
  Nanoseconds longest_response(const MovingWork& w, bool mixed) noexcept {
    Nanoseconds most;
    for (window_.set_change({}); !effort_.is_spent(); window_.set_change(window_.next_change())) {
      Nanoseconds window = kTick;
      for (const GridPlace place : {GridPlace::kAtBegin, GridPlace::kAtChange}) {
        if (!w.ranked.work.server) window_.hold(&w, place);
        const Nanoseconds first = window_.first_release(w, place);
        const Window here = is_executive(w) ? in_executive(w, mixed, first) : preemptive(w, mixed, first);
        window_.hold(nullptr, place);
        if (here.length == kNever) return kNever;
        window = std::max(window, here.length);
        most = std::max(most, here.response);
      }
      if (window_.change() >= window || window_.next_change() == kNever) return most;
    }
    return kNever;
  }

  /// The longest window that ends with a job of one task, and the longest response in it.
  struct Window {
    Nanoseconds length = kNever;
    Nanoseconds response;
  };

  /// The first job of `w` in the window. If it ends within the period, no earlier work remains behind it.
  Window preemptive(const MovingWork& w, bool mixed, Nanoseconds first) noexcept {
    if (w.part == TransitionPart::kLeaves && first >= window_.change()) return {{}, {}};
    const Work& work = w.ranked.work;
    choose([&](const MovingWork& o) { return &o != &w && may_go_before(o, w, mixed); });
    const Nanoseconds end = least(work.time, first + work.period,
                                  [&](Nanoseconds t) { return work.time + window_.released(t - kTick); });
    return {end, end - first};
  }

  /// All jobs of `w` in the busy period of `w` and the jobs before it, behind the longest other job.
  Window in_executive(const MovingWork& w, bool mixed, Nanoseconds first) noexcept {
    const Work& work = w.ranked.work;
    const auto goes_before = [&](const MovingWork& o) { return &o != &w && may_go_before(o, w, mixed); };
    const Nanoseconds blocked =
        blocking(w, [&](const MovingWork& o) { return &o != &w && may_go_before(w, o, false); });
    choose([&](const MovingWork& o) { return &o == &w || goes_before(o); });
    Window window{busy_with(blocked), {}};
    if (window.length == kNever) return {};
    const bool leaves = w.part == TransitionPart::kLeaves;
    const Nanoseconds end_of_own = leaves ? std::min(window.length, window_.change()) : window.length;
    for (std::int64_t job = 0; first + work.period * job < end_of_own + w.ranked.jitter; ++job) {
      const Nanoseconds mine = blocked + work.time * job;
      choose(goes_before);
      const Nanoseconds start = least_fixed_point(Nanoseconds{}, kLongestInterval, cost(), effort_,
                                                  [&](Nanoseconds t) { return mine + window_.released(t); });
      if (start == kNever) return {};
      choose([&](const MovingWork& o) { return o.ranked.band == w.ranked.band && goes_before(o); });
      const Nanoseconds done = mine + work.time + window_.released(start);
      choose([&](const MovingWork& o) { return o.ranked.band < w.ranked.band; });
      const Nanoseconds end =
          least(done, kLongestInterval, [&](Nanoseconds t) { return done + window_.released(t - kTick); });
      if (end == kNever) return {};
      window.response = std::max(window.response, end - first - work.period * job + w.ranked.jitter);
    }
    return window;
  }

  // Earliest deadline and least laxity:

  void judge_level(const MovingWork& first) noexcept {
    const bool is_laxity = order(first) == LevelOrder::kLaxity;
    std::int64_t n = 0;
    bool has_server = false;
    for (const MovingWork& w : works_) {
      if (!is_equal(w, first)) continue;
      ++n;
      has_server = has_server || w.ranked.work.server;
    }
    const bool by_demand = !is_laxity || (!is_executive(first) && !has_server);
    const Nanoseconds extra = is_laxity ? use(first).quantum * (n - 1) : Nanoseconds{};
    Nanoseconds response;
    Judgement judgement = by_demand ? Judgement::kHolds : Judgement::kFails;
    for (window_.set_change({});; window_.set_change(window_.next_change())) {
      const Nanoseconds busy = longest_window(first, Precedence::kAfter, {});
      response = std::max(response, busy);
      Nanoseconds longest = busy;
      if (judgement == Judgement::kHolds) {
        longest = longest_window(first, Precedence::kEqual, extra);
        judgement = longest == kNever ? Judgement::kFails : demand_holds(first, extra, longest);
      }
      if (effort_.is_spent()) judgement = Judgement::kGivenUp;
      if (effort_.is_spent()) response = kNever;
      const Nanoseconds beyond = judgement == Judgement::kHolds ? longest : busy;
      if (response == kNever || window_.change() >= beyond || window_.next_change() == kNever) break;
    }
    for (MovingWork& w : works_) {
      if (!is_equal(w, first)) continue;
      const bool holds = judgement == Judgement::kHolds && response != kNever;
      decide(w, holds ? std::min(w.ranked.work.deadline, response) : response, judgement);
    }
  }

  /// The longest window behind the longest job whose rank relative to the level is `blocker` or lower.
  Nanoseconds longest_window(const MovingWork& first, Precedence blocker, Nanoseconds extra) noexcept {
    choose([&](const MovingWork& w) { return standing(w, first) != Precedence::kAfter; });
    return busy_with(extra + blocking(first, [&](const MovingWork& w) {
                       const Precedence how = standing(w, first);
                       return how == Precedence::kAfter || how == blocker;
                     }));
  }

  /// Checks deadlines from the longest window down. Like level.cc it skips all deadlines between the end of a demand
  /// and the demand. The exception is a leaving job that blocks behind the change: its blocking grows as the window
  /// shrinks.
  Judgement demand_holds(const MovingWork& first, Nanoseconds extra, Nanoseconds longest) noexcept {
    const bool leaps = !is_executive(first) || window_.change() > Nanoseconds{};
    const auto is_of_level = [&](const MovingWork& w) { return is_equal(w, first); };
    choose(is_of_level);
    Nanoseconds shortest = kNever;
    for (const MovingWork& w : works_)
      if (is_of_level(w)) shortest = std::min(shortest, w.ranked.work.deadline);
    for (Nanoseconds t = window_.due_before(longest + kTick); t >= shortest;) {
      if (effort_.is_spent()) return Judgement::kGivenUp;
      effort_.terms -= 2 * cost();
      const Nanoseconds blocked = blocking(first, [&](const MovingWork& w) {
        const Precedence how = standing(w, first);
        return how == Precedence::kAfter || (how == Precedence::kEqual && w.ranked.work.deadline > t);
      });
      const Nanoseconds work = window_.due(t) + blocked + extra;
      choose([&](const MovingWork& w) { return standing(w, first) == Precedence::kBefore; });
      const Nanoseconds ends = least(work, t, [&](Nanoseconds s) { return work + window_.released(s - kTick); });
      choose(is_of_level);
      if (ends == kNever || ends > t) return effort_.is_spent() ? Judgement::kGivenUp : Judgement::kFails;
      t = window_.due_before(leaps ? ends : t);
    }
    return Judgement::kHolds;
  }

  void decide(MovingWork& w, Nanoseconds response, Judgement judgement) noexcept {
    w.is_judged = true;
    const Work& work = w.ranked.work;
    WorkVerdict verdict;
    verdict.response = response > Nanoseconds{} ? response : kNever;
    verdict.guarantee = work.time == Nanoseconds{}         ? Guarantee::kNotStated
                        : verdict.response <= work.deadline ? Guarantee::kYes
                        : judgement == Judgement::kGivenUp  ? Guarantee::kTooLong
                                                            : Guarantee::kNo;
    if (work.time > work.deadline) verdict.guarantee = Guarantee::kNo;
    verdicts_[w.ranked.task] = verdicts_[w.partner] = verdict;
  }

  std::span<MovingWork> works_;
  std::span<const ProcessorUse> uses_;
  std::span<WorkVerdict> verdicts_;
  ChangeWindow window_;
  Effort& effort_;
};

/// The tasks of one CPU that take part; tasks of one grid are adjacent.
std::span<MovingWork> moving_works(std::span<const Work> works, std::span<const TransitionPart> parts,
                                   std::span<const ProcessorUse> uses, std::uint32_t cpu,
                                   std::span<MovingWork> room) noexcept {
  std::size_t n = 0;
  for (std::uint32_t i = 0; i < works.size(); ++i) {
    CHIMERA_ASSERT(works[i].rtpu < uses.size() && works[i].period > Nanoseconds{});
    if (parts[i] == TransitionPart::kAbsent || uses[works[i].rtpu].cpu != cpu) continue;
    CHIMERA_ASSERT(n < room.size());
    // A server counts as if events came all the time: this bounds its work before and after the change.
    const RankedWork ranked = ranked_work(works, uses, i);
    room[n++] = {ranked, works[i].server ? TransitionPart::kStays : parts[i], i, ranked.tie};
  }
  const auto moving = room.first(n);
  std::sort(moving.begin(), moving.end(), [](const MovingWork& a, const MovingWork& b) {
    const Work &wa = a.ranked.work, &wb = b.ranked.work;
    if (wa.server.has_value() != wb.server.has_value()) return wb.server.has_value();
    if (wa.period != wb.period) return wa.period < wb.period;
    if (wa.offset != wb.offset) return wa.offset < wb.offset;
    return a.ranked.task < b.ranked.task;
  });
  return moving;
}

/// True if an arriving task behaves as a leaving task of its time would continue to do.
bool is_like_for_like(const MovingWork& leaving, const MovingWork& arriving) noexcept {
  const Work &a = leaving.ranked.work, &b = arriving.ranked.work;
  return leaving.part == TransitionPart::kLeaves && arriving.part == TransitionPart::kArrives && a.rtpu == b.rtpu &&
         leaving.is_on_grid_of(arriving) && a.deadline == b.deadline && a.criticality == b.criticality &&
         a.user_priority == b.user_priority;
}

/// The longest of `works` that fulfils `is_one` and is not paired; nullptr: none.
template <class IsOne>
MovingWork* longest_of(std::span<MovingWork> works, IsOne is_one) noexcept {
  MovingWork* longest = nullptr;
  for (MovingWork& w : works)
    if (is_one(w) && (longest == nullptr || w.ranked.work.time > longest->ranked.work.time)) longest = &w;
  return longest;
}

/// Joins each leaving task and its replacement into one task that stays. It pairs the longest with the longest, so that
/// the sum of the longer times is least. Returns the rest of `works`.
std::span<MovingWork> pair_up(std::span<MovingWork> works) noexcept {
  for (MovingWork& w : works) w.is_judged = false;
  for (std::size_t n = works.size();;) {
    const auto left = works.first(n);
    MovingWork* const leaving = longest_of(left, [](const MovingWork& w) {
      return w.part == TransitionPart::kLeaves && !w.is_judged;
    });
    if (leaving == nullptr) return left;
    leaving->is_judged = true;
    MovingWork* const arriving =
        longest_of(left, [&](const MovingWork& w) { return is_like_for_like(*leaving, w); });
    if (arriving == nullptr) continue;
    Work& work = leaving->ranked.work;
    work.time = std::max(work.time, arriving->ranked.work.time);
    leaving->partner = arriving->ranked.task;
    leaving->partner_tie = arriving->ranked.tie;
    leaving->part = TransitionPart::kStays;
    std::rotate(arriving, arriving + 1, left.data() + n);
    --n;
  }
}

TransitionVerdict summary(std::span<const Work> works, std::span<const TransitionPart> parts,
                          std::span<const ProcessorUse> uses, std::uint32_t cpu,
                          std::span<WorkVerdict> verdicts) noexcept {
  TransitionVerdict all;
  for (std::uint32_t i = 0; i < works.size(); ++i) {
    if (parts[i] == TransitionPart::kAbsent || uses[works[i].rtpu].cpu != cpu) continue;
    WorkVerdict& verdict = verdicts[i];
    if (works[i].time == Nanoseconds{}) verdict.guarantee = Guarantee::kNotStated;
    if (parts[i] != TransitionPart::kArrives) all.settled = std::max(all.settled, verdict.response);
    if (verdict.guarantee == Guarantee::kNotStated) {
      ++all.unstated;
    } else if (verdict.guarantee != Guarantee::kYes && all.guarantee == Guarantee::kYes) {
      all.guarantee = verdict.guarantee;
      all.task = i;
    }
  }
  return all;
}

}  // namespace

TransitionVerdict analyse_transition(std::span<const Work> works, std::span<const TransitionPart> parts,
                                     std::span<const ProcessorUse> uses, std::uint32_t cpu,
                                     std::span<WorkVerdict> verdicts, std::span<MovingWork> room) noexcept {
  CHIMERA_ASSERT(verdicts.size() == works.size() && parts.size() == works.size());
  Effort effort{kMostTerms};
  TransitionVerdict verdict;
  for (const bool pairs : {true, false}) {
    const auto all = moving_works(works, parts, uses, cpu, room);
    const auto moving = pairs ? pair_up(all) : all;
    TransitionAttempt(moving, uses, verdicts, effort).run();
    verdict = summary(works, parts, uses, cpu, verdicts);
    if (verdict.guarantee == Guarantee::kYes || moving.size() == all.size()) break;
  }
  verdict.terms = kMostTerms - effort.terms;
  return verdict;
}

}  // namespace chimera
