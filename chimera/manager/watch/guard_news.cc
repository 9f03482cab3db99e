// SPDX-License-Identifier: Apache-2.0
// Writes the guard's reports as sentences.
#include "chimera/manager/watch/guard_news.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"

namespace chimera::manager {
namespace {

std::string frames_text(const KeeperMessage& message) {
  const auto n_written = static_cast<std::uint64_t>(std::max(message.code, 0));
  std::string text = counted(n_written, "safe frame") + " written";
  const double ms = static_cast<double>((message.at - message.silent).count) / 1e6;
  if (n_written > 0) text += formatted(", the last byte %.3f ms after the guard saw the death", ms);
  if (message.letter == 0) return text;
  return text + "; " + std::to_string(message.letter) + " COULD NOT BE WRITTEN: the device took nothing for 1 s";
}

}  // namespace

void tell_of_guard(ManagerState& state, const KeeperMessage& message, Nanoseconds now) {
  using Kind = KeeperMessage::Kind;
  const bool is_of_rtpu = message.index < state.peers.n_rtpus();
  if (message.kind == Kind::kFramesWritten && is_of_rtpu && (message.code > 0 || message.letter > 0)) {
    state.tell("safe", TaskId{}, RtpuId(message.index), frames_text(message), now);
  } else if (message.kind == Kind::kSilent && is_of_rtpu &&
             static_cast<std::uint32_t>(message.code) < state.peers.n_tasks()) {
    const TaskId task(static_cast<std::uint32_t>(message.code));
    const std::string whose = message.letter == 0 ? "`safe_after`" : "`stale_after` of its standby";
    state.tell("safe", task, RtpuId(message.index),
               "published nothing for as long as " + whose + " says: its rtpu is ended", now);
  } else if (message.kind == Kind::kGuardState && message.code == KeeperMessage::kGuardIsSlow) {
    state.tell("safe", TaskId{}, RtpuId{},
               "the guard has no real-time rights: it writes safe frames, and nothing bounds when", now);
  } else if (message.kind == Kind::kGuardState && message.code == KeeperMessage::kGuardIsDead) {
    state.tell("safe", TaskId{}, RtpuId{}, "the guard is dead: no safe frames are written until the next run", now);
  }
}

}  // namespace chimera::manager
