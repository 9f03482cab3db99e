// SPDX-License-Identifier: Apache-2.0
// The keeper's loop: waits, handles signals, messages and deaths, watches the manager, and steps the phases of the end.
#include "chimera/keeper/keeper.h"

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "chimera/platform/descriptor.h"
#include "chimera/platform/realtime.h"

namespace chimera {
namespace {

constexpr Nanoseconds kQuickDeath = seconds(1), kLongestPause = milliseconds(500);
constexpr int kMostRefusals = 10;               // starts of the manager that fail in a row: about 2 s
constexpr Nanoseconds kLastLimit = seconds(1);  // for the manager to finish
constexpr Nanoseconds kWatchEvery = milliseconds(250);
constexpr Nanoseconds kManagerPatience = milliseconds(1500);  // a killed manager is replaced within 20 ms
constexpr Nanoseconds kFacePatience = seconds(30);            // longer than the run client waits for an answer, 20 s
constexpr Nanoseconds kStartPatience = seconds(10);           // a starting manager first verifies the description

// Descriptors of the keeper: signals, two pages, guard and run client with two each; process, channel and memory of
// each peer. And those of one more start: channel, line to the guard, pipe, and seven in the child before its exec.
constexpr std::uint64_t kOwnDescriptors = 7, kPeerDescriptors = 3, kStartDescriptors = 13;

}  // namespace

Keeper::Keeper(KeeperPlan plan) : plan_(std::move(plan)), peers_(plan_.peers), face_(plan_.face) {}

Keeper::~Keeper() = default;

Result<void> Keeper::start() {
  const std::uint64_t n_peers = plan_.peers.n_rtpus + 1;
  const auto may = may_open_here(kOwnDescriptors + n_peers * kPeerDescriptors + kStartDescriptors);
  if (!may) return may.error();
  constexpr int kTaken[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGCHLD}, kIgnored[] = {SIGPIPE};
  auto signals = SignalQueue::open(kTaken, kIgnored);
  if (!signals) return signals.error();
  signals_ = *std::move(signals);
  if (auto started = peers_.start_all(); !started || !face_.is_wanted()) return started;
  return face_.start();
}

int Keeper::run() {
  while (phase_ != Phase::kDone) {
    wait();
    poll();
    watch_manager();
    while (advance()) {
    }
  }
  face_.end();  // its time to finish is over
  peers_.end_all();
  return end_code_ != 0 ? end_code_ : face_.code();
}

void Keeper::wait() {
  std::vector<int> descriptors = {signals_.descriptor(), face_.pidfd(), peers_.guard().channel(),
                                  peers_.guard().pidfd()};
  for (std::uint32_t index = 0; index < peers_.size(); ++index) {
    descriptors.push_back(peers_[index].channel());
    descriptors.push_back(peers_[index].pidfd());
  }
  const Nanoseconds due = std::min({phase_due_, manager_due_, watch_due_, peers_.orphans_due()});
  await_readable(descriptors, due - clock_.now());
}

/// Handles all signals, messages and deaths that have arrived.
void Keeper::poll() {
  SignalQueue::Arrived signal;
  while (signals_.take(signal)) {
    const bool is_of_face = face_.lives() && signal.from == face_.pid();
    if (signal.number == SIGUSR1)
      face_has_looked_ = face_has_looked_ || is_of_face;
    else if (signal.number == SIGUSR2 && is_of_face)
      peers_.pages().show_face(face_.page());
    else if (signal.number != SIGCHLD && signal.number != SIGUSR2)
      end_asked_ = true;
  }
  end_asked_ = end_asked_ || face_has_looked_;
  std::vector<KeeperMessage> wishes;
  for (std::uint32_t index = 0; index < peers_.size(); ++index) {
    peers_.read_messages(index, wishes);
    const Nanoseconds started = peers_[index].life().at;
    if (!peers_.has_ended(index, wishes) || index != peers_.manager_index()) continue;
    manager_life_ = {};
    manager_beats_ = 0;
    const Nanoseconds ended = peers_[index].life().at;
    count_refusal(ended - started);
    if (ended - started >= kQuickDeath) manager_pause_ = {0};
    manager_due_ = ended + manager_pause_;
    manager_pause_ = std::clamp(manager_pause_ * 2, milliseconds(10), kLongestPause);
  }
  peers_.read_guard();
  for (const KeeperMessage& wish : wishes) on_message(wish);
  check_face();
  peers_.check_orphans(face_.pid());
}

void Keeper::end_badly(const Message& why) {
  std::fprintf(stderr, "%.*s\n", static_cast<int>(why.view().size()), why.view().data());
  end_asked_ = true;
  end_code_ = 1;
}

void Keeper::check_face() {
  const KeptFace::Fate fate = face_.poll();
  if (fate == KeptFace::Fate::kNothingNew) return;
  face_life_ = {};
  peers_.pages().show_face(face_.page());
  Message said("the process that prints and ends this run died ");
  if (fate == KeptFace::Fate::kExited) {
    end_asked_ = true;
  } else if (phase_ != Phase::kRunning || end_asked_) {
    end_badly(said << "of " << face_.cause().view() << " while the run was ending: the result of the run is unknown");
  } else if (fate == KeptFace::Fate::kGivenUp) {
    end_badly(said << kMostFaceDeaths << " times in 10 s, the last time of " << face_.cause().view()
                   << ": the run ends");
  } else if (const auto started = face_.start(); !started) {
    end_badly(said << "of " << face_.cause().view() << ", and no other can be started ("
                   << started.error().message.view() << "): the run ends");
  }
}

/// Ends the run if the first managers fail to start kMostRefusals times in a row. No task is ON yet, so no task is
/// lost.
void Keeper::count_refusal(Nanoseconds lived) {
  const bool refused = lived < kQuickDeath && peers_.manager().life().by_signal == 0;
  if (!refused) manager_refusals_ = -1;
  if (manager_refusals_ < 0 || ++manager_refusals_ != kMostRefusals) return;
  end_badly(Message("the manager could not start, ") << kMostRefusals << " times: the run ends");
}

void Keeper::on_message(const KeeperMessage& wish) {
  if (wish.kind == KeeperMessage::Kind::kBeat) ++manager_beats_;
  if (wish.kind == KeeperMessage::Kind::kEnd) {
    end_asked_ = true;
    if (end_code_ == 0) end_code_ = wish.code;
  }
  if (wish.index >= peers_.manager_index()) return;
  const KeptPeer& meant = peers_[wish.index];
  const bool is_meant = wish.incarnation == 0 || wish.incarnation == meant.incarnation();
  if (wish.kind == KeeperMessage::Kind::kEndChild && is_meant) meant.signal(SIGKILL);
  if (wish.kind == KeeperMessage::Kind::kStart && !meant.lives() && phase_ < Phase::kRtpusFinish)
    peers_.restart(wish.index);
}

/// The manager watches the rtpus, and the keeper watches the manager: docs/formats/processes.md, "Who watches whom".
void Keeper::watch_manager() {
  const Nanoseconds now = clock_.now();
  if (now < watch_due_) return;
  watch_due_ = now + kWatchEvery;
  peers_.pages().beat();
  watch_face(now);
  const KeptPeer& manager = peers_.manager();
  if (!manager.lives() || phase_ >= Phase::kRtpusFinish) return;
  const ProcessState process = process_state(manager.pid());
  const bool is_slow_start = manager_beats_ == 0 && process.letter != 'T';
  const Nanoseconds patience = is_slow_start ? kStartPatience : kManagerPatience;
  const LifeVerdict verdict = manager_life_.look({now, manager_beats_, process}, {patience, patience});
  if (verdict.life != Life::kRuns) {
    hung_ = {.kind = KeeperMessage::Kind::kHung,
             .index = peers_.manager_index(),
             .incarnation = manager.incarnation(),
             .code = static_cast<std::int32_t>(verdict.life),
             .pid = verdict.tracer,
             .silent = verdict.silent,
             .letter = static_cast<std::uint32_t>(verdict.letter),
             .was_ended = verdict.is_over};
    if (verdict.is_over) manager.signal(SIGKILL);
  } else if (verdict.is_news) {
    report_hang();
  }
}

/// Kills a run client that is stopped or hangs: the client ends the run in time, so the keeper replaces it. Each phase
/// of the end has its own limit, which the client cannot extend.
void Keeper::watch_face(Nanoseconds now) {
  if (phase_ != Phase::kRunning || !face_.lives()) return;
  const LifeVerdict verdict =
      face_life_.look({now, face_.page().beats, process_state(face_.pid())}, {kManagerPatience, kFacePatience});
  if (verdict.is_over || verdict.life == Life::kStopped) face_.signal(SIGKILL);
}

/// Sends the report of a hang to the manager that runs now, which may be the successor of the one that hung.
void Keeper::report_hang() {
  if (hung_.kind == KeeperMessage::Kind::kHung) peers_.manager().send(hung_);
  hung_ = {};
}

void Keeper::enter(Phase phase, Nanoseconds limit) {
  phase_ = phase;
  phase_due_ = clock_.now() + limit;
}

/// Carries out one step that is due. True if another step may be due.
bool Keeper::advance() {
  const Nanoseconds now = clock_.now();
  const bool is_late = now >= phase_due_;
  const KeptPeer& manager = peers_.manager();
  if (now >= manager_due_) {
    manager_due_ = kNever;
    if (phase_ < Phase::kRtpusFinish) peers_.restart(peers_.manager_index());
    if (phase_ < Phase::kRtpusFinish && !manager.lives()) manager_due_ = now + kLongestPause;
    if (manager.lives()) report_hang();
  } else if (phase_ == Phase::kRunning && end_asked_) {
    face_.signal(SIGTERM);
    enter(Phase::kFaceLooks, plan_.face_limit);
  } else if (phase_ == Phase::kFaceLooks && (!face_.lives() || face_has_looked_ || is_late)) {
    peers_.finish_rtpus();
    enter(Phase::kRtpusFinish, plan_.ending_limit);
  } else if (phase_ == Phase::kRtpusFinish && (!peers_.any_rtpu_lives() || is_late)) {
    for (std::uint32_t index = 0; index < peers_.manager_index(); ++index) peers_[index].signal(SIGKILL);
    enter(Phase::kRtpusDie, kSigkillLimit);
  } else if (phase_ == Phase::kRtpusDie && (!peers_.any_rtpu_lives() || is_late)) {
    peers_.give_up_rtpus();
    enter(Phase::kFaceFinishes, plan_.face_limit);
  } else if (phase_ == Phase::kFaceFinishes && (!face_.lives() || is_late)) {
    if (face_.lives())
      end_badly(Message("the process that prints did not end in time: the result of the run is not printed"));
    peers_.finish_manager();
    enter(Phase::kManagerFinishes, kLastLimit);
  } else if (phase_ == Phase::kManagerFinishes && (!manager.lives() || is_late)) {
    phase_ = Phase::kDone;  // the keeper's exit ends every process that is left
  } else {
    return false;
  }
  return phase_ != Phase::kDone;
}

}  // namespace chimera
