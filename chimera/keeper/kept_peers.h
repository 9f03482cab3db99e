// SPDX-License-Identifier: Apache-2.0
// The rtpus and the manager together: who is started, what each is told of the others, and how all of them end.
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

/// What to start. The descriptors stay the caller's.
struct PeerPlan {
  std::string rtpu_program, manager_program;
  std::string guard_program{};              ///< empty: no task has a device
  std::vector<std::string> guard_limits{};  ///< KeptGuard::start()
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
  /// Takes what the guard has said, for the manager.
  void read_guard();
  /// True, once, when `index` has ended: then the others know.
  bool has_ended(std::uint32_t index, std::vector<KeeperMessage>& wishes);
  /// Tells every rtpu to end its tasks; from here on everybody sees that it ends.
  void finish_rtpus();
  /// Tells the manager to end when it has done what is left.
  void finish_manager();
  /// Ends the processes that dead rtpus left behind; `other` is a child that other code of this process waits for. Due
  /// again at orphans_due().
  void check_orphans(pid_t other);
  Nanoseconds orphans_due() const noexcept { return orphans_.due(); }
  /// SIGKILL for every child that is left, and for its orphans, until none is left. Blocks for 2 s at most.
  void end_all();

  std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(peers_.size()); }
  std::uint32_t manager_index() const noexcept { return size() - 1; }
  const KeptPeer& operator[](std::uint32_t index) const noexcept { return peers_[index]; }
  const KeptPeer& manager() const noexcept { return peers_.back(); }
  const KeptGuard& guard() const noexcept { return guard_; }
  bool any_rtpu_lives() const noexcept;
  /// What all of them see. Requires: start_all() was called.
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
