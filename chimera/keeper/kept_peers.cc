// SPDX-License-Identifier: Apache-2.0
// Starts and restarts the processes of a subsystem, passes their memory on, and reports their starts and ends.
#include "chimera/keeper/kept_peers.h"

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace chimera {

using Kind = KeeperMessage::Kind;

namespace {

constexpr Nanoseconds kWritingLimit = seconds(3);  // longer than the guard waits for a device

}  // namespace

KeptPeers::KeptPeers(PeerPlan plan) : plan_(std::move(plan)) {
  for (std::uint32_t index = 0; index <= plan_.n_rtpus; ++index) peers_.emplace_back(index);
}

KeptPeers::~KeptPeers() { end_all(); }

void KeptPeers::end_all() {
  const Nanoseconds until = clock_.now() + kSigkillLimit;
  for (const KeptPeer& peer : peers_) peer.signal(SIGKILL);
  for (KeptPeer& peer : peers_) peer.wait(until - clock_.now());
  guard_.end(kWritingLimit);
  orphans_.end_all(kSigkillLimit);
}

void KeptPeers::check_orphans(pid_t other) {
  std::vector<pid_t> held = {other, guard_.pid()};
  for (const KeptPeer& peer : peers_) held.push_back(peer.pid());
  const auto lives = [this](std::string_view origin) {
    return std::ranges::any_of(peers_,
                               [origin](const KeptPeer& peer) { return peer.lives() && peer.origin() == origin; });
  };
  orphans_.look(held, lives, clock_.now());
}

Result<void> KeptPeers::start_all() {
  if (plan_.n_rtpus > kMaxRtpus)
    return (Message() << plan_.n_rtpus << " rtpus; a subsystem has at most " << kMaxRtpus).error(ErrorCode::kBadInput);
  auto pages = KeeperPages::create(plan_.n_rtpus, clock_.now());
  if (!pages) return pages.error();
  pages_ = *std::move(pages);
  if (!plan_.guard_program.empty()) {
    auto started = guard_.start(plan_.guard_program, plan_.guard_limits, plan_.image, pages_);
    if (!started) return started;
  }
  // The manager starts first, because its start takes longest. It gets the inventory piece by piece as the rtpus start.
  if (auto started = start(manager_index()); !started) return started;
  for (std::uint32_t rtpu = 0; rtpu < manager_index(); ++rtpu) {
    if (auto started = start(rtpu); !started) return started;
    introduce(rtpu);
  }
  manager().send({.kind = Kind::kComplete});
  return {};
}

Result<void> KeptPeers::start(std::uint32_t index) {
  const bool is_manager = index == manager_index();
  const std::uint32_t incarnation = peers_[index].incarnation() + 1;
  std::vector<int> passed = {plan_.image, pages_.decision_descriptor(), pages_.keeper_descriptor()};
  if (is_manager) passed.insert(passed.end(), {plan_.listening, plan_.bundle});
  else passed.push_back(plan_.objects);
  pages_.show_life(index, incarnation);  // before the process reads the page
  pages_.ring_all();
  const Channel line = is_manager ? Channel() : guard_.make_line(index, incarnation);
  if (line.is_open()) passed.push_back(line.descriptor());
  const auto started = peers_[index].start({.program = is_manager ? plan_.manager_program : plan_.rtpu_program,
                                            .passed = passed,
                                            .origin_prefix = orphans_.prefix(),
                                            .has_guard = line.is_open()},
                                           clock_.now());
  if (started && !is_manager) guard_.watch(index, incarnation, peers_[index].pidfd());
  return started;
}

void KeptPeers::restart(std::uint32_t index) {
  const auto started = start(index);
  if (started) return introduce(index);
  std::fprintf(stderr, "%s\n", started.error().message.c_str());
  show_end(index);
}

/// Passes the memory of the other peers to a new rtpu and reports it to the manager; gives a new manager the whole
/// inventory.
void KeptPeers::introduce(std::uint32_t newcomer) {
  const KeptPeer& peer = peers_[newcomer];
  if (newcomer != manager_index()) {
    for (const KeptPeer& other : peers_)
      if (&other != &peer) other.pass_segment_to(peer);
    return tell_life(newcomer);
  }
  for (std::uint32_t rtpu = 0; rtpu < manager_index(); ++rtpu) {
    const bool lives = peers_[rtpu].lives();
    if (lives) tell_life(rtpu);
    peers_[rtpu].pass_segment_to(peer);
    if (!lives) tell_life(rtpu);
  }
  peer.pass_segment_to(peer);  // the memory of its predecessor
  peer.send({.kind = Kind::kComplete});
}

/// Sends the last start or end of the peer to the manager.
void KeptPeers::tell_life(std::uint32_t of) { manager().send(peers_[of].life(), peers_[of].pidfd()); }

void KeptPeers::read_messages(std::uint32_t index, std::vector<KeeperMessage>& wishes) {
  KeeperMessage message;
  for (KeptPeer::Said said; (said = peers_[index].receive(message)) != KeptPeer::Said::kNothing;) {
    if (said == KeptPeer::Said::kSegment) {
      for (const KeptPeer& other : peers_)
        if (&other != &peers_[index]) peers_[index].pass_segment_to(other);
    } else if (index == manager_index()) {
      wishes.push_back(message);
    }
  }
}

void KeptPeers::read_guard() {
  std::vector<KeeperMessage> news;
  guard_.poll(news);
  for (const KeeperMessage& message : news) manager().send(message);
}

bool KeptPeers::has_ended(std::uint32_t index, std::vector<KeeperMessage>& wishes) {
  ProcessEnd how;
  if (!peers_[index].has_ended(how)) return false;
  read_messages(index, wishes);  // messages that it sent before it ended
  peers_[index].note_end(how, clock_.now());
  show_end(index);
  return true;
}

void KeptPeers::show_end(std::uint32_t index) {
  pages_.show_life(index, 0);
  if (index != manager_index()) tell_life(index);  // before the bells: each ring is a system call
  pages_.ring_all();
}

void KeptPeers::finish_rtpus() {
  pages_.show_ending();
  for (std::uint32_t index = 0; index < manager_index(); ++index) peers_[index].send({.kind = Kind::kFinish});
}

void KeptPeers::give_up_rtpus() {
  for (std::uint32_t index = 0; index < manager_index(); ++index) {
    if (!peers_[index].lives()) continue;
    peers_[index].note_end({.by_signal = true, .code = SIGKILL}, clock_.now());
    show_end(index);
  }
}

void KeptPeers::finish_manager() { peers_[manager_index()].send({.kind = Kind::kFinish}); }

bool KeptPeers::any_rtpu_lives() const noexcept {
  return std::any_of(peers_.begin(), peers_.end() - 1, [](const KeptPeer& peer) { return peer.lives(); });
}

}  // namespace chimera
