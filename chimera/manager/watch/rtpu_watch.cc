// SPDX-License-Identifier: Apache-2.0
// Samples the rtpus and the keeper, reports hangs, and names the rtpus that must be killed.
#include "chimera/manager/watch/rtpu_watch.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"
#include "chimera/manager/state/cause.h"
#include "chimera/runtime/task_word.h"

namespace chimera::manager {
namespace {

constexpr Nanoseconds kWatchEvery = milliseconds(250);
constexpr Nanoseconds kStartPatience = seconds(10);  // until an rtpu has begun its first method or answers the manager

std::string seconds_text(Nanoseconds time) {
  return formatted(time < seconds(10) ? "%.1f s" : "%.0f s", to_seconds(time));
}

const BlockHead* head_of(const ManagerState& state, RtpuId rtpu) {
  const PeerSegment& segment = state.peers[rtpu];
  const bool is_current = segment.is_there() && segment.incarnation() == state.rtpus[rtpu.index].incarnation;
  return is_current ? &segment.block().head() : nullptr;
}

}  // namespace

RtpuWatch::RtpuWatch(ManagerState& state) : state_(state) {
  for (std::uint32_t r = 0; r < state.peers.n_rtpus(); ++r) rtpus_.push_back(std::make_unique<Rtpu>());
}

std::vector<RtpuId> RtpuWatch::look(Nanoseconds at) {
  due_ = at + kWatchEvery;
  const std::uint64_t beats = state_.keeper.beats.load(std::memory_order_acquire);
  state_.keeper_hang = look_at(keeper_, "keeper", {at, beats, process_state(state_.keeper_pid)});
  const std::int32_t guard = state_.keeper.guard_pid.load(std::memory_order_relaxed);
  const std::uint64_t rounds = state_.page.guard_beats.load(std::memory_order_relaxed);
  state_.guard_hang = guard == 0 ? "" : look_at(guard_, "guard", {at, rounds, process_state(guard)});
  std::vector<RtpuId> over;
  for (std::uint32_t r = 0; r < rtpus_.size(); ++r) {
    const RtpuId rtpu(r);
    RtpuRecord& record = state_.rtpus[r];
    if (rtpus_[r]->incarnation != record.incarnation) {
      rtpus_[r] = std::make_unique<Rtpu>();
      rtpus_[r]->incarnation = record.incarnation;
    }
    record.hang.clear();
    record.is_away = false;
    if (!record.is_alive) continue;
    if (record.is_overwritten) {
      record.is_away = true;
      record.hang = "something in it has overwritten its memory";
      over.push_back(rtpu);
      continue;
    }
    if (look_at_life(rtpu, at)) over.push_back(rtpu);
    if (!record.is_away) look_at_methods(rtpu, at);
  }
  return over;
}

/// True if the rtpu has not run for longer than its limit, so that it must be killed.
bool RtpuWatch::look_at_life(RtpuId rtpu, Nanoseconds at) {
  RtpuRecord& record = state_.rtpus[rtpu.index];
  const BlockHead* head = head_of(state_, rtpu);
  const std::uint32_t beats = head == nullptr ? 0 : head->attended.load(std::memory_order_acquire);
  const ProcessState process = process_state(record.pid);
  LifeLimits limits;
  limits.spins = milliseconds(900);  // a thread that spins fills the second window whole, at the latest
  // Until the rtpu answers the manager, a running object or method is reported by name and has no time limit.
  const bool is_opening = head != nullptr && head->serving != 0;
  if (beats == 0 && process.letter != 'T') limits = {is_opening ? kNever : kStartPatience, kNever, kNever};
  const LifeVerdict verdict = rtpus_[rtpu.index]->life.look({at, beats, process}, limits);
  const bool runs = verdict.life == Life::kRuns, spins = verdict.life == Life::kSpins;
  record.is_away = !runs && !spins;
  if (spins) record.hang = "its main thread " + verdict.text();
  if (record.is_away) record.hang = "does not run: " + verdict.text() + ", for " + seconds_text(verdict.silent);
  std::string news = record.hang;
  if (runs) news = verdict.silent < seconds(1) ? "no longer loops" : "runs again after ";
  if (runs && verdict.silent >= seconds(1)) news += seconds_text(verdict.silent);
  const std::string subject = "rtpu " + state_.name(rtpu) + (spins ? ": " : " ");
  if (verdict.is_news) state_.tell("hang", TaskId{}, rtpu, subject + news, at);
  const bool is_over = verdict.is_over && record.ended_for.empty();
  if (is_over) record.ended_for = "it did not run for " + seconds_text(verdict.silent) + ": " + verdict.text();
  return is_over;
}

void RtpuWatch::look_at_methods(RtpuId rtpu, Nanoseconds at) {
  const BlockHead* head = head_of(state_, rtpu);
  if (head == nullptr) return;
  Rtpu& watched = *rtpus_[rtpu.index];
  const auto look = [&](MethodWatch& watch, std::uint32_t word, std::uint64_t progress = 0) {
    tell(rtpu, watch.look(word, progress, at), at);
  };
  look(watched.serving, head->serving.load(std::memory_order_relaxed));
  look(watched.at_edge, head->at_edge.load(std::memory_order_relaxed));
  look(watched.background, head->background.load(std::memory_order_relaxed));
  // A preemptive rtpu itself reports jobs that do not end: it can tell a wait from a loop.
  if (state_.spec().rtpus[rtpu.index].preemptive) return;
  const std::uint32_t running = head->running.load(std::memory_order_relaxed);
  const bool is_cycle = (running & 255u) == CHIMERA_CYCLE;
  look(watched.cycle, is_cycle ? running : 0, head->beats + head->jobs);
}

void RtpuWatch::tell(RtpuId rtpu, const MethodVerdict& verdict, Nanoseconds at) {
  const std::uint32_t word = verdict.word != 0 ? verdict.word : verdict.ended;
  const std::string what = running_text(state_.spec(), word);
  if (what.empty()) return;
  std::string& hang = state_.rtpus[rtpu.index].hang;
  const std::string text = what + (verdict.ended == 0 ? " for " : " ended after ") + seconds_text(verdict.since);
  if (verdict.ended == 0) append_joined(hang, "; ", text);
  if (verdict.is_news) state_.tell("hang", TaskWord::found(word).task(), rtpu, text, at);
}

/// How the keeper or the guard hangs; "" if it runs. A process that has not begun its loop has longer for its start.
std::string RtpuWatch::look_at(LifeWatch& watch, const char* name, const LifeSample& sample) {
  const bool is_slow_start = sample.beats == 0 && sample.process.letter != 'T';
  const LifeVerdict verdict = watch.look(sample, {.told = is_slow_start ? kStartPatience : LifeLimits().told});
  const bool runs = verdict.life == Life::kRuns;
  const std::string hang = "does not run: " + verdict.text() + ", for " + seconds_text(verdict.silent);
  const std::string news = runs ? "runs again after " + seconds_text(verdict.silent) : hang;
  if (verdict.is_news) state_.tell("hang", TaskId{}, RtpuId{}, name + (" " + news), sample.at);
  return runs ? "" : hang;
}

void RtpuWatch::told(const KeeperMessage& hung, Nanoseconds at) {
  LifeVerdict verdict;
  verdict.life = static_cast<Life>(hung.code);
  verdict.letter = static_cast<char>(hung.letter);
  verdict.tracer = hung.pid;
  state_.tell("hang", TaskId{}, RtpuId{},
              "manager did not answer for " + seconds_text(hung.silent) + ": " + verdict.text() +
                  (hung.was_ended != 0 ? "; it was replaced" : "; it runs again"),
              at);
}

}  // namespace chimera::manager
