// SPDX-License-Identifier: Apache-2.0
// Starts and restarts the processes of a subsystem, hands their memory round, and publishes who lives.
#include "chimera/keeper/kept_peers.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "chimera/platform/doorbell.h"
#include "chimera/platform/origin.h"
#include "chimera/platform/process_id.h"

namespace chimera {

using Kind = KeeperMessage::Kind;

namespace {

constexpr Nanoseconds kDyingLimit = seconds(1);  // for SIGKILL to be carried out

/// What is started while it lives comes from there. Of one thread only: the environment is the whole process's.
class StartsFrom {
 public:
  explicit StartsFrom(const std::string& origin) {
    const char* before = std::getenv(kOriginVariable);
    has_before_ = before != nullptr;
    if (has_before_) before_ = before;
    ::setenv(kOriginVariable, origin.c_str(), 1);
  }
  ~StartsFrom() {
    if (has_before_) ::setenv(kOriginVariable, before_.c_str(), 1);
    else ::unsetenv(kOriginVariable);
  }
  StartsFrom(const StartsFrom&) = delete;
  StartsFrom& operator=(const StartsFrom&) = delete;

 private:
  bool has_before_;
  std::string before_;
};

}  // namespace

KeptPeers::KeptPeers(PeerPlan plan) : plan_(std::move(plan)), peers_(plan_.n_rtpus + 1) {}

KeptPeers::~KeptPeers() { end_all(); }

void KeptPeers::end_all() {
  ProcessEnd how;
  const Nanoseconds until = clock_.now() + kDyingLimit;
  for (Peer& peer : peers_) peer.process.signal(SIGKILL);
  for (Peer& peer : peers_) peer.process.wait(how, std::max(until - clock_.now(), Nanoseconds{0}).count);
  orphans_.end_all(kDyingLimit);
}

void KeptPeers::check_orphans(pid_t other) {
  std::vector<pid_t> held = {other};
  for (const Peer& peer : peers_) held.push_back(peer.process.pid());
  const auto lives = [this](std::string_view origin) {
    return std::any_of(peers_.begin(), peers_.end(),
                       [origin](const Peer& peer) { return peer.process.is_held() && peer.origin == origin; });
  };
  orphans_.look(held, lives, clock_.now());
}

Result<void> KeptPeers::start_all() {
  if (plan_.n_rtpus > kMaxRtpus)
    return (Message() << plan_.n_rtpus << " rtpus; a subsystem has at most " << kMaxRtpus).error(ErrorCode::kBadInput);
  auto decision = SharedPages::create("chimera-decision", sizeof(DecisionPage));
  if (!decision) return decision.error();
  auto keeper = MemoryRegion::create("chimera-keeper", sizeof(KeeperPage));
  if (!keeper) return keeper.error();
  decision_ = *std::move(decision);
  keeper_ = *std::move(keeper);
  new (decision_.bytes().data()) DecisionPage;
  new (keeper_.writable().data()) KeeperPage;
  page().origin = clock_.now();
  page().n_rtpus = plan_.n_rtpus;
  // The manager has most to do before it can serve; the inventory it is owed is told as it comes into being.
  if (auto started = start(manager()); !started) return started;
  for (std::uint32_t rtpu = 0; rtpu < manager(); ++rtpu) {
    if (auto started = start(rtpu); !started) return started;
    introduce(rtpu);
  }
  send(manager(), {.kind = Kind::kComplete});
  return {};
}

Result<void> KeptPeers::start(std::uint32_t index) {
  Peer& peer = peers_[index];
  auto ends = Channel::pair();
  if (!ends) return ends.error();
  const bool is_manager = index == manager();
  const std::uint32_t incarnation = peer.last.incarnation + 1;
  const std::string& program = is_manager ? plan_.manager_program : plan_.rtpu_program;
  const std::string numbers[] = {std::to_string(index), std::to_string(incarnation), std::to_string(own_process_id())};
  const std::array words = {program.c_str(),    "--peer",   numbers[0].c_str(), "--incarnation",
                            numbers[1].c_str(), "--parent", numbers[2].c_str()};
  std::vector<int> passed = {ends->second.descriptor(), plan_.image, decision_.descriptor(), keeper_.descriptor()};
  if (is_manager) passed.insert(passed.end(), {plan_.listening, plan_.bundle});
  else passed.push_back(plan_.objects);
  publish_life(index, incarnation);  // before it can look
  ring_all();
  peer.origin = orphans_.prefix() + numbers[0] + "." + numbers[1];
  const StartsFrom origin(peer.origin);
  auto process = Process::start(program.c_str(), words, passed);
  if (!process) return process.error();
  peer.process = *std::move(process);
  peer.channel = std::move(ends->first);
  peer.last = {.kind = Kind::kStarted,
               .index = index,
               .incarnation = incarnation,
               .pid = peer.process.pid(),
               .at = clock_.now()};
  return {};
}

void KeptPeers::restart(std::uint32_t index) {
  const auto started = start(index);
  if (started) return introduce(index);
  std::fprintf(stderr, "%s\n", started.error().message.c_str());
  ++peers_[index].last.incarnation;
  end(index, {.by_signal = false, .code = 127});
}

/// The newcomer is told of the others, and the manager of a new rtpu.
void KeptPeers::introduce(std::uint32_t newcomer) {
  if (newcomer != manager()) {
    for (std::uint32_t other = 0; other < size(); ++other)
      if (other != newcomer) send_segment(newcomer, other);
    return send_life(newcomer);
  }
  for (std::uint32_t rtpu = 0; rtpu < manager(); ++rtpu) {
    if (lives(rtpu)) send_life(rtpu);
    send_segment(newcomer, rtpu);
    if (!lives(rtpu)) send_life(rtpu);
  }
  send_segment(newcomer, newcomer);  // its predecessor's
  send(newcomer, {.kind = Kind::kComplete});
}

/// A child that does not take its messages any more would see a world that is not there: it is ended.
void KeptPeers::send(std::uint32_t index, const KeeperMessage& message, int passed) {
  const Peer& peer = peers_[index];
  if (peer.channel.is_open() && !peer.channel.send(bytes_of(message), passed) && errno == EAGAIN)
    peer.process.signal(SIGKILL);
}

void KeptPeers::send_segment(std::uint32_t to, std::uint32_t of) {
  const Peer& peer = peers_[of];
  if (peer.segment.fd < 0) return;
  send(to, {.kind = Kind::kPeer, .index = of, .incarnation = peer.segment_incarnation}, peer.segment.fd);
}

void KeptPeers::send_life(std::uint32_t of) { send(manager(), peers_[of].last, peers_[of].process.pidfd()); }

void KeptPeers::publish_life(std::uint32_t index, std::uint32_t incarnation) {
  page().alive[index].store(incarnation, std::memory_order_release);
  auto* decision = reinterpret_cast<DecisionPage*>(decision_.bytes().data());
  decision->changes.fetch_add(1, std::memory_order_release);  // pairs with the look at an edge: who lives
}

void KeptPeers::ring_all() {
  auto* decision = reinterpret_cast<DecisionPage*>(decision_.bytes().data());
  for (std::uint32_t i = 0; i < size(); ++i) Doorbell(decision->bells[i].word).ring();
}

void KeptPeers::read_messages(std::uint32_t index, std::vector<KeeperMessage>& wishes) {
  Peer& peer = peers_[index];
  KeeperMessage message;
  int passed = -1;
  while (peer.channel.is_open()) {
    const Channel::Got got = peer.channel.receive(bytes_of(message), passed);
    if (got == Channel::Got::kNothing) return;
    if (got == Channel::Got::kClosed) {
      peer.channel = Channel();
      return;
    }
    OwnedDescriptor segment(passed);
    if (message.kind == Kind::kSegment && segment.fd >= 0) {
      peer.segment = std::move(segment);
      peer.segment_incarnation = peer.last.incarnation;
      for (std::uint32_t other = 0; other < size(); ++other)
        if (other != index) send_segment(other, index);
    } else if (index == manager()) {
      wishes.push_back(message);
    }
  }
}

bool KeptPeers::has_ended(std::uint32_t index, std::vector<KeeperMessage>& wishes) {
  ProcessEnd how;
  if (!peers_[index].process.has_ended(how)) return false;
  read_messages(index, wishes);  // its last words
  end(index, how);
  return true;
}

void KeptPeers::end(std::uint32_t index, const ProcessEnd& how) {
  Peer& peer = peers_[index];
  peer.channel = Channel();
  peer.last = {.kind = Kind::kEnded,
               .index = index,
               .incarnation = peer.last.incarnation,
               .code = how.code,
               .by_signal = how.by_signal,
               .core_dumped = how.core_dumped,
               .at = clock_.now()};
  publish_life(index, 0);
  if (index != manager()) send_life(index);  // before the bells: each of them is a system call
  ring_all();
}

void KeptPeers::publish_face(const FacePage& face) {
  page().face_signal.store(face.last_signal, std::memory_order_relaxed);
  page().face_deaths.store(face.deaths, std::memory_order_release);
  page().lost_output.store(face.lost_output, std::memory_order_release);
  ring_all();
}

void KeptPeers::finish_rtpus() {
  page().ending.store(1, std::memory_order_release);
  for (std::uint32_t index = 0; index < manager(); ++index) send(index, {.kind = Kind::kFinish});
}

bool KeptPeers::any_rtpu_lives() const noexcept {
  return std::any_of(peers_.begin(), peers_.end() - 1, [](const Peer& peer) { return peer.process.is_held(); });
}

}  // namespace chimera
