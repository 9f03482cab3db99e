// SPDX-License-Identifier: Apache-2.0
// One rtpu, or the manager, as its keeper has it: the process of its present incarnation, the channel to it, and the
// memory that it made. docs/formats/processes.md, "Keeper messages".
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "chimera/base/result.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera {

/// What to start as the next incarnation of a peer. All of it stays the caller's.
struct PeerStart {
  const std::string& program;
  std::span<const int> passed;  ///< descriptors behind the one of its channel
  /// Of the origin by which it, and what it starts, is found again: the numbers of peer and incarnation come behind.
  const std::string& origin_prefix;
  bool has_guard = false;  ///< the last of `passed` is its line to the guard
};

/// Single-threaded. Context: setup; never blocks but in wait().
class KeptPeer {
 public:
  explicit KeptPeer(std::uint32_t index) { last_.index = index; }

  /// Starts the next incarnation. Requires: !lives(). Refuses when it cannot be started: it counts then as ended with
  /// code 127, and its number is taken.
  Result<void> start(const PeerStart& start, Nanoseconds now);
  /// A peer that does not take its messages any more would see a world that is not there: it is sent SIGKILL.
  void send(const KeeperMessage& message, int passed = -1) const;
  /// Gives `other` the memory that this peer made last; nothing when it has made none.
  void pass_segment_to(const KeptPeer& other) const;
  enum class Said : std::uint8_t {
    kNothing,  ///< for now, or for ever
    kSegment,  ///< it has made its memory: pass_segment_to() passes it on
    kMessage,
  };
  /// Takes the next that it has sent.
  Said receive(KeeperMessage& message);
  /// True, once, when its process has ended, and how. What it has sent can still be received, up to note_end().
  bool has_ended(ProcessEnd& how) { return process_.has_ended(how); }
  /// Its process has ended, in this way: life() says so, and its channel is closed.
  void note_end(const ProcessEnd& how, Nanoseconds now);
  void signal(int number) const noexcept { process_.signal(number); }
  /// Blocks until its process has ended, for `limit` at most.
  void wait(Nanoseconds limit);

  bool lives() const noexcept { return process_.is_held(); }
  std::uint32_t incarnation() const noexcept { return last_.incarnation; }
  /// kStarted or kEnded, of its last incarnation: what the manager is told of it.
  const KeeperMessage& life() const noexcept { return last_; }
  /// Of its last incarnation.
  const std::string& origin() const noexcept { return origin_; }
  int channel() const noexcept { return channel_.descriptor(); }
  pid_t pid() const noexcept { return process_.pid(); }
  int pidfd() const noexcept { return process_.pidfd(); }

 private:
  Process process_;
  Channel channel_;
  OwnedDescriptor segment_;  // of its last incarnation that made one
  std::uint32_t segment_incarnation_ = 0;
  KeeperMessage last_;
  std::string origin_;
};

}  // namespace chimera
