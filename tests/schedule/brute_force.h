// SPDX-License-Identifier: Apache-2.0
// Simulates a processor tick by tick, as a reference for the analysis. Both share only the specs: the simulation has no
// bound, no busy period and no level, only the task that runs in each tick.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "chimera/schedule/work.h"

namespace chimera::brute {

using Tick = std::int64_t;
inline constexpr Tick kFar = INT64_MAX / 4;

/// Releases, demands and server events of one simulation of a set.
struct Scenario {
  std::vector<Tick> first;     ///< first release of each task; server: its first event
  std::vector<Tick> until;     ///< of each task: no release, or event, from here on; empty: all go on
  std::vector<Tick> boundary;  ///< deferrable server: its periods begin here, plus or minus whole periods
  bool gaps = false;           ///< releases come later than a period apart, now and then
  bool shorter = false;        ///< jobs use less than their time, now and then
  bool drops_late = false;     ///< a job is over at its deadline, when it can be taken off
  bool scarce = false;         ///< servers have nothing to do, now and then
  Tick horizon = 0;
  std::uint32_t seed = 1;
};

struct Seen {
  Tick first_response = -1;
  Tick worst_response = 0;
  bool missed = false;
};

class Processor {
 public:
  Processor(const std::vector<Work>& works, const std::vector<ProcessorUse>& uses, const Scenario& scenario)
      : works_(works), uses_(uses), scenario_(scenario), random_(scenario.seed), tasks_(works.size()),
        running_(uses.size(), kNobody), seen_(works.size()) {
    for (std::size_t i = 0; i < works.size(); ++i) {
      tasks_[i].next = scenario.first[i];
      if (works[i].server) tasks_[i].chunks = {{scenario.first[i], works[i].time.count}};
    }
  }

  std::vector<Seen> play() {
    for (now_ = 0; now_ < scenario_.horizon; ++now_) {
      for (std::size_t i = 0; i < works_.size(); ++i) arrive(i);
      for (std::size_t i = 0; i < works_.size(); ++i) look_at_deadline(i);
      const std::size_t who = chosen();
      if (who != kNobody) run(who);
    }
    return seen_;
  }

 private:
  static constexpr std::size_t kNobody = SIZE_MAX;
  struct Chunk {
    Tick from, amount;
  };
  struct Task {
    Tick next = 0;               // release, or boundary of a deferrable server
    bool is_active = false;      // a job waits or runs
    bool has_started = false;
    bool has_pending = false;    // released while a started job is late
    Tick release = 0, deadline = 0, left = 0;
    Tick pending_release = 0;
    bool is_busy = true;         // server: events wait
    Tick busy_since = 0;
    std::vector<Chunk> chunks;   // server: capacity and when it may be used
  };

  std::uint32_t dice(std::uint32_t sides) { return static_cast<std::uint32_t>(random_() % sides); }
  Tick until(std::size_t task) const { return scenario_.until.empty() ? kFar : scenario_.until[task]; }
  bool is_executive(std::size_t task) const { return uses_[works_[task].rtpu].dispatch == Dispatch::kExecutive; }
  bool is_under_way(std::size_t i) const { return is_executive(i) && running_[works_[i].rtpu] == i; }

  void start_job(std::size_t i, Tick release) {
    Task& t = tasks_[i];
    const Tick time = works_[i].time.count;
    t.is_active = true;
    t.has_started = false;
    t.release = release;
    t.deadline = release + works_[i].deadline.count;
    t.left = scenario_.shorter && dice(2) == 0 ? 1 + dice(static_cast<std::uint32_t>(time)) : time;
    event_[works_[i].rtpu] = true;
  }

  void arrive(std::size_t i) {
    if (works_[i].server) return serve(i);
    Task& t = tasks_[i];
    if (now_ != t.next || now_ >= until(i)) return;
    const Tick period = works_[i].period.count;
    t.next += period + (scenario_.gaps && dice(3) == 0 ? dice(static_cast<std::uint32_t>(period)) : 0);
    if (works_[i].time.count == 0) return;
    if (!t.is_active || !t.has_started) {
      if (t.is_active) seen_[i].missed = true;  // replaced
      return start_job(i, now_);
    }
    if (t.has_pending) seen_[i].missed = true;
    t.has_pending = true;
    t.pending_release = now_;
  }

  // Events for a server: all the time, or in bursts.
  void draw_events(std::size_t i) {
    Task& t = tasks_[i];
    const bool was = t.is_busy && now_ > scenario_.first[i];
    if (now_ < scenario_.first[i] || now_ >= until(i)) t.is_busy = false;
    else if (!scenario_.scarce) t.is_busy = true;
    else if (now_ == scenario_.first[i] || dice(5) == 0) t.is_busy = dice(2) == 0;
    if (t.is_busy && !was) t.busy_since = now_;
  }

  void serve(std::size_t i) {
    if (is_under_way(i)) return;  // a job that began runs to its end
    draw_events(i);
    if (works_[i].server == ServerKind::kDeferrable) serve_deferrable(i);
    else serve_sporadic(i);
  }

  void serve_deferrable(std::size_t i) {
    Task& t = tasks_[i];
    const Tick period = works_[i].period.count;
    const Tick into = (((now_ - scenario_.boundary[i]) % period) + period) % period;
    const Tick begin = now_ - into;
    if (t.chunks[0].from != begin) {
      if (now_ >= scenario_.first[i] + period && t.chunks[0].amount > 0 && t.is_busy && t.busy_since <= begin - period)
        seen_[i].missed = true;
      t.chunks[0] = {begin, works_[i].time.count};
    }
    const bool may = t.is_busy && t.chunks[0].amount > 0;
    if (may && !t.is_active) event_[works_[i].rtpu] = true;
    t.is_active = may;
    t.left = t.chunks[0].amount;
    t.deadline = begin + period;
  }

  void serve_sporadic(std::size_t i) {
    Task& t = tasks_[i];
    if (t.is_active && !t.is_busy) give_back(i);
    if (t.is_active || !t.is_busy) return;
    for (Chunk& c : t.chunks) {
      if (c.amount == 0 || c.from > now_) continue;
      t.left = c.amount;
      c.amount = 0;
      t.is_active = true;
      t.release = now_;
      t.deadline = now_ + works_[i].period.count;
      t.pending_release = t.left;  // capacity of the chunk
      event_[works_[i].rtpu] = true;
      return;
    }
  }

  // Used capacity comes back a period after the server became active; the rest comes back at once.
  void give_back(std::size_t i) {
    Task& t = tasks_[i];
    const Tick used = t.pending_release - t.left;
    std::erase_if(t.chunks, [](const Chunk& c) { return c.amount == 0; });
    if (used > 0) t.chunks.push_back({t.deadline, used});
    if (t.left > 0) t.chunks.push_back({now_, t.left});
    t.is_active = false;
    t.left = 0;
  }

  void look_at_deadline(std::size_t i) {
    Task& t = tasks_[i];
    if (!t.is_active || now_ < t.deadline) return;
    if (works_[i].server == ServerKind::kDeferrable) return;
    seen_[i].missed = true;
    if (works_[i].server || !scenario_.drops_late || is_under_way(i)) return;
    end_job(i);
  }

  void end_job(std::size_t i) {
    Task& t = tasks_[i];
    t.is_active = false;
    if (running_[works_[i].rtpu] == i) running_[works_[i].rtpu] = kNobody;
    event_[works_[i].rtpu] = true;
    if (!t.has_pending) return;
    t.has_pending = false;
    start_job(i, t.pending_release);
  }

  // 1: a goes first; -1: b goes first; 0: a tie, in which the running task continues.
  int compare(std::size_t a, std::size_t b) const {
    const auto order = [](auto x, auto y) { return x < y ? 1 : x > y ? -1 : 0; };
    const Work &wa = works_[a], &wb = works_[b];
    int first = 0;
    switch (uses_[wa.rtpu].policy) {
      case Policy::kRm: first = order(wa.period.count, wb.period.count); break;
      case Policy::kEdf: first = order(tasks_[a].deadline, tasks_[b].deadline); break;
      case Policy::kMuf:
        first = order(wb.criticality, wa.criticality);
        if (first == 0) first = order(tasks_[a].deadline, tasks_[b].deadline);
        break;
      case Policy::kMufLaxity: first = order(wb.criticality, wa.criticality); [[fallthrough]];
      case Policy::kLlf:
        if (first == 0) first = order(tasks_[a].deadline - tasks_[a].left, tasks_[b].deadline - tasks_[b].left);
        break;
    }
    return first != 0 ? first : order(wb.user_priority, wa.user_priority);
  }

  std::size_t candidate(std::size_t rtpu) {
    std::size_t& runs = running_[rtpu];
    if (runs != kNobody && !tasks_[runs].is_active) runs = kNobody;
    const ProcessorUse& use = uses_[rtpu];
    if (runs != kNobody && use.dispatch == Dispatch::kExecutive) return runs;
    const bool laxity = use.policy == Policy::kLlf || use.policy == Policy::kMufLaxity;
    if (runs != kNobody && laxity && !event_[rtpu] && now_ % use.quantum.count != 0) return runs;
    std::size_t best = runs;
    for (std::size_t i = 0; i < works_.size(); ++i) {
      if (works_[i].rtpu != rtpu || !tasks_[i].is_active || i == runs) continue;
      if (best == kNobody || compare(i, best) > 0) best = i;
    }
    event_[rtpu] = false;
    return best;
  }

  std::size_t chosen() {
    std::size_t rtpu = kNobody;
    for (std::size_t r = 0; r < uses_.size(); ++r) {
      const bool waits = std::any_of(works_.begin(), works_.end(), [&](const Work& w) {
        return w.rtpu == r && tasks_[static_cast<std::size_t>(&w - works_.data())].is_active;
      });
      if (waits && (rtpu == kNobody || uses_[r].criticality > uses_[rtpu].criticality)) rtpu = r;
    }
    if (rtpu == kNobody) return kNobody;
    running_[rtpu] = candidate(rtpu);
    return running_[rtpu];
  }

  void run(std::size_t i) {
    Task& t = tasks_[i];
    t.has_started = true;
    --t.left;
    if (works_[i].server) {
      if (works_[i].server == ServerKind::kDeferrable) --t.chunks[0].amount;
      if (t.left > 0) return;
      if (works_[i].server == ServerKind::kSporadic) give_back(i);
      t.is_active = false;
      running_[works_[i].rtpu] = kNobody;
      return;
    }
    if (t.left > 0) return;
    const Tick response = now_ + 1 - t.release;
    Seen& seen = seen_[i];
    if (seen.first_response < 0) seen.first_response = response;
    seen.worst_response = std::max(seen.worst_response, response);
    if (response > works_[i].deadline.count) seen.missed = true;
    end_job(i);
  }

  const std::vector<Work>& works_;
  const std::vector<ProcessorUse>& uses_;
  const Scenario& scenario_;
  std::mt19937 random_;
  std::vector<Task> tasks_;
  std::vector<std::size_t> running_;  // of each rtpu
  std::vector<Seen> seen_;
  std::vector<bool> event_ = std::vector<bool>(uses_.size());  // of each rtpu: a release or an end to look at
  Tick now_ = 0;
};

}  // namespace chimera::brute
