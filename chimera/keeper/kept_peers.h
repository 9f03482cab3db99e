// SPDX-License-Identifier: Apache-2.0
// The rtpus and the manager as their keeper has them: each one's process, channel and memory, and what the others
// are told of it. docs/formats/processes.md, "Keeper messages".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/platform/orphans.h"
#include "chimera/platform/channel.h"
#include "chimera/platform/linux_clock.h"
#include "chimera/platform/owned_descriptor.h"
#include "chimera/platform/memory_region.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_pages.h"
#include "chimera/rtpu/keeper_message.h"
#include "chimera/runtime/hosted/face_page.h"
#include "chimera/runtime/hosted/pages.h"

namespace chimera {

/// What to start. The descriptors stay the caller's.
struct PeerPlan {
  std::string rtpu_program, manager_program;
  std::uint32_t n_rtpus = 0;
  int image = -1, objects = -1, bundle = -1, listening = -1;
};

/// By number: the rtpus, then the manager. Single-threaded. Context: setup; never blocks.
class KeptPeers {
 public:
  explicit KeptPeers(PeerPlan plan);
  ~KeptPeers();
  KeptPeers(const KeptPeers&) = delete;
  KeptPeers& operator=(const KeptPeers&) = delete;

  /// Makes the decision page and the keeper page and starts everybody; refuses when one cannot be.
  Result<void> start_all();
  /// Starts the next incarnation of one that does not live. One that cannot be started counts as ended with 127.
  void restart(std::uint32_t index);
  /// Takes what `index` has sent; its new memory goes to all others. What the manager wants is added to `wishes`.
  void read_messages(std::uint32_t index, std::vector<KeeperMessage>& wishes);
  /// True, once, when `index` has ended: then the others know.
  bool has_ended(std::uint32_t index, std::vector<KeeperMessage>& wishes);
  /// Tells the manager; one that does not take its messages any more is ended.
  void send_to_manager(const KeeperMessage& message) { send(manager(), message); }
  /// Shows all peers that the loop of the keeper went round once more.
  void beat() noexcept { page().beats.fetch_add(1, std::memory_order_release); }
  /// Everybody may know this of the face of the run.
  void publish_face(const FacePage& face);
  /// Tells every rtpu to end its tasks; from here on everybody sees that it ends.
  void finish_rtpus();
  /// Ends the processes that dead rtpus left behind; `other` is a child that other code of this process waits for. Due
  /// again at orphans_due().
  void check_orphans(pid_t other);
  Nanoseconds orphans_due() const noexcept { return orphans_.due(); }
  /// SIGKILL for every child that is left, and for its orphans, until none is left. Blocks for 2 s at most.
  void end_all();

  std::uint32_t size() const noexcept { return plan_.n_rtpus + 1; }
  std::uint32_t manager() const noexcept { return plan_.n_rtpus; }
  bool lives(std::uint32_t index) const noexcept { return peers_[index].process.is_held(); }
  bool any_rtpu_lives() const noexcept;
  std::uint32_t incarnation(std::uint32_t index) const noexcept { return peers_[index].last.incarnation; }
  void signal(std::uint32_t index, int number) const noexcept { peers_[index].process.signal(number); }
  int channel(std::uint32_t index) const noexcept { return peers_[index].channel.descriptor(); }
  pid_t pid(std::uint32_t index) const noexcept { return peers_[index].process.pid(); }
  int pidfd(std::uint32_t index) const noexcept { return peers_[index].process.pidfd(); }
  /// Whether its last end was by a signal.
  bool by_signal(std::uint32_t index) const noexcept { return peers_[index].last.by_signal != 0; }
  /// When it was started last, or ended.
  Nanoseconds since(std::uint32_t index) const noexcept { return peers_[index].last.at; }

 private:
  struct Peer {
    Process process;
    Channel channel;
    OwnedDescriptor segment;  // of its last incarnation that made one
    std::uint32_t segment_incarnation = 0;
    KeeperMessage last;                     // kStarted or kEnded: what a new manager is told
    std::string origin;                     // of its last incarnation, and of what that starts
  };

  KeeperPage& page() const noexcept { return *reinterpret_cast<KeeperPage*>(keeper_.writable().data()); }
  Result<void> start(std::uint32_t index);
  void introduce(std::uint32_t newcomer);
  void send(std::uint32_t index, const KeeperMessage& message, int passed = -1);
  void send_segment(std::uint32_t to, std::uint32_t of);
  void send_life(std::uint32_t of);
  void end(std::uint32_t index, const ProcessEnd& how);
  void publish_life(std::uint32_t index, std::uint32_t incarnation);
  void ring_all();

  const PeerPlan plan_;
  LinuxClock clock_;
  Orphans orphans_;
  SharedPages decision_;
  MemoryRegion keeper_;
  std::vector<Peer> peers_;
};

}  // namespace chimera
