// SPDX-License-Identifier: Apache-2.0
// The guard as its keeper holds it: chimera/guard/guard.h. docs/formats/processes.md, "The guard".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/keeper/keeper_pages.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"
#include "chimera/rtpu/guard_message.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera {

/// One process, started once. A dead guard is reported and not replaced, because the descriptors that it held are lost.
/// Single-threaded. Context: setup; blocks only in end().
class KeptGuard {
 public:
  /// `limits`: words of its command line. From here on `pages` show its state; they outlive it. Refuses if the system
  /// refuses the process.
  Result<void> start(const std::string& program, std::span<const std::string> limits, int image, KeeperPages& pages);
  /// True from the start until the keeper sees the death of the guard.
  bool lives() const noexcept { return process_.is_held(); }
  int channel() const noexcept { return channel_.descriptor(); }
  int pidfd() const noexcept { return process_.pidfd(); }
  pid_t pid() const noexcept { return process_.pid(); }

  /// Makes the line between the guard and the rtpu that starts next. Returns the rtpu's end; it is closed if there is
  /// no guard, or no room for a line. watch() gives the other end to the guard.
  Channel make_line(std::uint32_t index, std::uint32_t incarnation);
  /// Introduces the rtpu of the last line to the guard: it runs now. The caller keeps the descriptor.
  void watch(std::uint32_t index, std::uint32_t incarnation, int pidfd);

  /// Reads the messages of the guard and notices its death. Appends the news for the manager to `news`.
  void poll(std::vector<KeeperMessage>& news);
  /// Asks the guard to end, and kills it after `limit`. Requires: no rtpu lives. Blocks.
  void end(Nanoseconds limit);

 private:
  void send(const GuardMessage& message, int passed) const;

  Process process_;
  Channel channel_, new_line_;  // new_line_: the guard's end of the line of the rtpu that starts next
  KeeperPages* pages_ = nullptr;
};

}  // namespace chimera
