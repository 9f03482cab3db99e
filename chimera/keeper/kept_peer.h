// SPDX-License-Identifier: Apache-2.0
// One rtpu, or the manager, as its keeper holds it: the process of its present incarnation, its channel, and the memory
// that it made. docs/formats/processes.md, "Keeper messages".
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

/// The next incarnation of a peer to start. The caller keeps all of it.
struct PeerStart {
  const std::string& program;
  std::span<const int> passed;  ///< descriptors that follow the one of its channel
  /// Prefix of the origin, by which the peer and all processes that it starts are found. The numbers of peer and
  /// incarnation follow it.
  const std::string& origin_prefix;
  bool has_guard = false;  ///< the last of `passed` is its line to the guard
};

/// Single-threaded. Context: setup; blocks only in wait().
class KeptPeer {
 public:
  explicit KeptPeer(std::uint32_t index) { last_.index = index; }

  /// Starts the next incarnation. Requires: !lives(). If the process cannot start, the incarnation counts as ended with
  /// code 127.
  Result<void> start(const PeerStart& start, Nanoseconds now);
  /// Sends a message. A peer with a full channel is sent SIGKILL: without the message it would act on an old state.
  void send(const KeeperMessage& message, int passed = -1) const;
  /// Passes the memory that this peer made last to `other`; does nothing if the peer made none.
  void pass_segment_to(const KeptPeer& other) const;
  enum class Said : std::uint8_t {
    kNothing,  ///< no message now, or none any more
    kSegment,  ///< the peer has made its memory: pass_segment_to() passes it on
    kMessage,
  };
  /// Receives the next message of the peer.
  Said receive(KeeperMessage& message);
  /// True, once, when the process has ended; `how` says how. receive() still reads what it sent before, up to
  /// note_end().
  bool has_ended(ProcessEnd& how) { return process_.has_ended(how); }
  /// Records the end of the process: life() reports it, and the channel is closed.
  void note_end(const ProcessEnd& how, Nanoseconds now);
  void signal(int number) const noexcept { process_.signal(number); }
  /// Blocks until the process has ended, `limit` at most.
  void wait(Nanoseconds limit);

  bool lives() const noexcept { return process_.is_held(); }
  std::uint32_t incarnation() const noexcept { return last_.incarnation; }
  /// kStarted or kEnded of the last incarnation: the message about the peer for the manager.
  const KeeperMessage& life() const noexcept { return last_; }
  /// Origin of the last incarnation.
  const std::string& origin() const noexcept { return origin_; }
  int channel() const noexcept { return channel_.descriptor(); }
  pid_t pid() const noexcept { return process_.pid(); }
  int pidfd() const noexcept { return process_.pidfd(); }

 private:
  Process process_;
  Channel channel_;
  OwnedDescriptor segment_;  // memory of the last incarnation that made one
  std::uint32_t segment_incarnation_ = 0;
  KeeperMessage last_;
  std::string origin_;
};

}  // namespace chimera
