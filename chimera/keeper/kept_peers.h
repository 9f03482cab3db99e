// SPDX-License-Identifier: Apache-2.0
// The rtpus and the manager together: starts them, passes messages and memory between them, and ends them.
// docs/formats/processes.md, "Keeper messages".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/keeper/keeper_pages.h"
#include "chimera/keeper/kept_guard.h"
#include "chimera/keeper/kept_peer.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/orphans.h"

namespace chimera {

/// The processes to start. The caller keeps the descriptors.
struct PeerPlan {
  std::string rtpu_program, manager_program;
  std::string guard_program{};              ///< empty: no task has a device
  std::vector<std::string> guard_limits{};  ///< KeptGuard::start()
  std::uint32_t n_rtpus = 0;
  int image = -1, objects = -1, bundle = -1, listening = -1;
};

/// Peers by number: the rtpus, then the manager. Single-threaded. Context: setup; blocks only in end_all().
class KeptPeers {
 public:
  explicit KeptPeers(PeerPlan plan);
  ~KeptPeers();
  KeptPeers(const KeptPeers&) = delete;
  KeptPeers& operator=(const KeptPeers&) = delete;

  /// Makes the decision page and the keeper page, and starts all peers. Refuses if a page or a process cannot be made.
  Result<void> start_all();
  /// Starts the next incarnation of a dead peer. A peer that cannot start counts as ended with code 127.
  void restart(std::uint32_t index);
  /// Reads the messages of `index` and passes its new memory to all others. Appends the manager's requests to `wishes`.
  void read_messages(std::uint32_t index, std::vector<KeeperMessage>& wishes);
  /// Reads the messages of the guard and passes them to the manager.
  void read_guard();
  /// True, once, when `index` has ended. The page and the manager already show the end then.
  bool has_ended(std::uint32_t index, std::vector<KeeperMessage>& wishes);
  /// Asks every rtpu to end its tasks. The keeper page shows all processes that the run ends.
  void finish_rtpus();
  /// Reports each rtpu that still lives, though SIGKILL was sent, as ended by it: its tasks may not be OFF.
  void give_up_rtpus();
  /// Asks the manager to finish its work and end.
  void finish_manager();
  /// Ends the processes that dead rtpus left behind. Spares `other`, a child that other code of this process waits for.
  /// Due again at orphans_due().
  void check_orphans(pid_t other);
  Nanoseconds orphans_due() const noexcept { return orphans_.due(); }
  /// Sends SIGKILL to every child that is left and to its orphans, and waits for their ends. Blocks for at most 1 s for
  /// the peers, 6 s for the guard and 1 s for the orphans.
  void end_all();

  std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(peers_.size()); }
  std::uint32_t manager_index() const noexcept { return size() - 1; }
  const KeptPeer& operator[](std::uint32_t index) const noexcept { return peers_[index]; }
  const KeptPeer& manager() const noexcept { return peers_.back(); }
  const KeptGuard& guard() const noexcept { return guard_; }
  bool any_rtpu_lives() const noexcept;
  /// The pages that all peers see. Requires: start_all() was called.
  KeeperPages& pages() noexcept { return pages_; }

 private:
  Result<void> start(std::uint32_t index);
  void introduce(std::uint32_t newcomer);
  void tell_life(std::uint32_t of);
  void show_end(std::uint32_t index);

  const PeerPlan plan_;
  LinuxClock clock_;
  Orphans orphans_;
  KeeperPages pages_;
  KeptGuard guard_;
  std::vector<KeptPeer> peers_;
};

}  // namespace chimera
