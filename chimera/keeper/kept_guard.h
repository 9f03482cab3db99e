// SPDX-License-Identifier: Apache-2.0
// The guard as its keeper has it: chimera/guard/guard.h. docs/formats/processes.md, "The guard".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"
#include "chimera/rtpu/guard_message.h"
#include "chimera/rtpu/keeper_message.h"

namespace chimera {

/// One process, started once: one that dies is told of and not replaced, because the descriptors that it held are gone
/// with it. Single-threaded. Context: setup; never blocks but in end().
class KeptGuard {
 public:
  /// `limits`: words of its command line. Refuses what the system refuses.
  Result<void> start(const std::string& program, std::span<const std::string> limits, int image);
  /// It was started, and has not been seen dead.
  bool lives() const noexcept { return process_.is_held(); }
  int channel() const noexcept { return channel_.descriptor(); }
  int pidfd() const noexcept { return process_.pidfd(); }
  pid_t pid() const noexcept { return process_.pid(); }

  /// A line between the guard and a unit that is to be started: answers the end of the unit, closed where there is no
  /// guard; the other one is given to the guard by watch().
  Channel make_line();
  /// The unit of the last line runs. The descriptor stays the caller's.
  void watch(std::uint32_t index, std::uint32_t incarnation, int pidfd);

  /// Takes what the guard has said, and its death; what the manager is to know is added to `news`.
  void poll(std::vector<KeeperMessage>& news);
  /// What a manager that comes is to know of it: kGuardState, or nothing for a guard that is as it should be.
  void introduce(std::vector<KeeperMessage>& news) const;
  /// Lets it end, and ends it when it does not within `limit`. Requires: no unit lives. Blocks.
  void end(Nanoseconds limit);

 private:
  void send(const GuardMessage& message, int passed) const;

  Process process_;
  Channel channel_, new_line_;  // the guard's end of the line of the unit that is being started
  KeeperMessage state_{.kind = KeeperMessage::Kind::kGuardState, .code = KeeperMessage::kGuardIsWell};
};

}  // namespace chimera
