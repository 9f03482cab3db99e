// SPDX-License-Identifier: Apache-2.0
// Simulates the worst window of a set of tasks: all releases at once, all budgets used up.
#include "chimera/schedule/worst_window.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/schedule/policy.h"

namespace chimera {
namespace {

constexpr std::uint32_t kNobody = UINT32_MAX;

class Window {
 public:
  Window(std::span<const Work> works, std::span<const ProcessorUse> uses, std::uint32_t cpu,
         std::span<WindowTask> room, std::span<WindowRun> runs) noexcept
      : works_(works), uses_(uses), cpu_(cpu), tasks_(room), runs_(runs) {}

  WorstWindow play(Nanoseconds length) noexcept {
    for (std::uint32_t i = 0; i < works_.size(); ++i) tasks_[i] = {.next = {}, .release = {}, .left = {}};
    open_behind_a_blocker();
    WorstWindow window{length, 0};
    std::uint32_t before = kNobody;
    for (Nanoseconds now; now < length;) {
      release_due(now);
      const std::uint32_t who = chosen(before);
      const Nanoseconds next = std::min(next_event(who), length);
      before = who;
      if (who == kNobody) {
        now = next;
        continue;
      }
      const Nanoseconds end = std::min(next, now + tasks_[who].left);
      if (!write(window, {who, now, end})) {
        window.length = now;
        return window;
      }
      run(who, end - now);
      now = end;
    }
    return window;
  }

 private:
  void run(std::uint32_t i, Nanoseconds time) noexcept {
    tasks_[i].left -= time;
    tasks_[i].has_started = true;
    if (tasks_[i].left == Nanoseconds{}) tasks_[i].is_active = false;
  }

  bool is_here(std::uint32_t i) const noexcept {
    return uses_[works_[i].rtpu].cpu == cpu_ && works_[i].time > Nanoseconds{};
  }

  /// In each executive, the longest job except the first in order is running when the others are released.
  void open_behind_a_blocker() noexcept {
    for (std::uint32_t r = 0; r < uses_.size(); ++r) {
      if (uses_[r].cpu != cpu_ || uses_[r].dispatch != Dispatch::kExecutive) continue;
      std::uint32_t longest = kNobody, others = 0;
      for (std::uint32_t i = 0; i < works_.size(); ++i) {
        if (!is_here(i) || works_[i].rtpu != r) continue;
        ++others;
        if (longest == kNobody || works_[i].time > works_[longest].time) longest = i;
      }
      if (others < 2) continue;
      WindowTask& t = tasks_[longest];
      t = {.next = works_[longest].period, .release = {}, .left = works_[longest].time, .is_active = true,
           .has_started = true, .releases = 1};
    }
  }

  void release_due(Nanoseconds now) noexcept {
    for (std::uint32_t i = 0; i < works_.size(); ++i) {
      WindowTask& t = tasks_[i];
      if (!is_here(i) || t.next > now) continue;
      if (t.is_active && t.has_started) continue;  // late: waits for its end
      const Work& w = works_[i];
      while (t.next + w.period <= now) t.next += w.period;
      t.release = t.next;
      t.left = w.time;
      t.is_active = true;
      t.has_started = false;
      // A deferrable server uses its whole capacity at the end of a period, and then that of the next period.
      const bool is_end = w.server == ServerKind::kDeferrable && t.releases == 0;
      t.next += is_end ? w.time : w.period;
      ++t.releases;
    }
  }

  Nanoseconds next_event(std::uint32_t runs) const noexcept {
    Nanoseconds next = kNever;
    for (std::uint32_t i = 0; i < works_.size(); ++i)
      if (is_here(i) && i != runs && !(tasks_[i].is_active && tasks_[i].has_started))
        next = std::min(next, tasks_[i].next);
    return next;
  }

  bool goes_first(std::uint32_t a, std::uint32_t b, std::uint32_t running) const noexcept {
    const ProcessorUse &ua = uses_[works_[a].rtpu], &ub = uses_[works_[b].rtpu];
    if (&ua != &ub) {
      if (ua.criticality != ub.criticality) return ua.criticality > ub.criticality;
      return works_[a].rtpu < works_[b].rtpu;
    }
    if (ua.dispatch == Dispatch::kExecutive && tasks_[a].has_started != tasks_[b].has_started)
      return tasks_[a].has_started;
    if (is_more_urgent(ua.policy, urgency(a), urgency(b))) return true;
    if (is_more_urgent(ua.policy, urgency(b), urgency(a))) return false;
    return b != running && (a == running || tie_of(works_[a].place, a) < tie_of(works_[b].place, b));
  }
  Urgency urgency(std::uint32_t i) const noexcept {
    const Work& w = works_[i];
    return {w.criticality, w.user_priority, w.period, tasks_[i].release + w.deadline, tasks_[i].left};
  }

  std::uint32_t chosen(std::uint32_t running) const noexcept {
    std::uint32_t best = kNobody;
    for (std::uint32_t i = 0; i < works_.size(); ++i)
      if (is_here(i) && tasks_[i].is_active && (best == kNobody || goes_first(i, best, running))) best = i;
    return best;
  }

  bool write(WorstWindow& window, const WindowRun& run) noexcept {
    if (window.runs > 0) {
      WindowRun& last = runs_[window.runs - 1];
      if (last.task == run.task && last.to == run.from) return last.to = run.to, true;
    }
    if (window.runs == runs_.size()) return false;
    runs_[window.runs++] = run;
    return true;
  }

  std::span<const Work> works_;
  std::span<const ProcessorUse> uses_;
  std::uint32_t cpu_;
  std::span<WindowTask> tasks_;
  std::span<WindowRun> runs_;
};

}  // namespace

WorstWindow worst_window(std::span<const Work> works, std::span<const ProcessorUse> uses, std::uint32_t cpu,
                         Nanoseconds length, std::span<WindowTask> room, std::span<WindowRun> runs) noexcept {
  CHIMERA_ASSERT(room.size() == works.size());
  return Window(works, uses, cpu, room, runs).play(length);
}

}  // namespace chimera
