// SPDX-License-Identifier: Apache-2.0
// Writes the guard's reports as sentences.
#include "chimera/manager/watch/guard_news.h"

#include <algorithm>
#include <cstring>

#include "chimera/base/hosted/wording.h"

namespace chimera::manager {
namespace {

constexpr const char* kRaiseLimits =
    "raise the limits of open files (ulimit -n) and locked memory (ulimit -l), and start the run again";

std::string frames_text(const KeeperMessage& message) {
  const auto n_written = static_cast<std::uint64_t>(std::max(message.code, 0));
  std::string text = counted(n_written, "safe frame") + " written";
  const double ms = static_cast<double>((message.at - message.silent).count) / 1e6;
  if (n_written > 0) text += formatted(", the last byte %.3f ms after the guard saw the death", ms);
  if (message.letter > 0)
    text += "; " + std::to_string(message.letter) + " COULD NOT BE WRITTEN: the device took nothing for 1 s";
  if (message.late > 0)
    text += "; " + std::to_string(message.late) + " left out: the guard was late, its restarted rtpu drives the device";
  return text;
}

const char* lack_text(GuardState guard) {
  switch (guard) {
    case GuardState::kWell:
      return "";
    case GuardState::kLate:
      return "the guard lacks real-time priority or locked memory: it may write safe frames late";
    case GuardState::kDead:
      break;
  }
  return "the guard is dead: no safe frames are written until the next run";
}

}  // namespace

void tell_of_guard(ManagerState& state, const KeeperMessage& message, Nanoseconds now) {
  using Kind = KeeperMessage::Kind;
  const bool is_of_rtpu = message.index < state.peers.n_rtpus();
  const bool had_frames = message.code > 0 || message.letter > 0 || message.late > 0;
  if (message.kind == Kind::kFramesWritten && is_of_rtpu && had_frames) {
    state.tell("safe", TaskId{}, RtpuId(message.index), frames_text(message), now);
  } else if (message.kind == Kind::kSilent && is_of_rtpu &&
             static_cast<std::uint32_t>(message.code) < state.peers.n_tasks()) {
    const TaskId task(static_cast<std::uint32_t>(message.code));
    const std::string whose = message.letter == 0 ? "`safe_after`" : "`stale_after` of its standby";
    state.tell("safe", task, RtpuId(message.index),
               "published nothing for as long as " + whose + " says: its rtpu is ended", now);
  }
}

std::string unguarded_text(const ManagerState& state, RtpuId rtpu) {
  const std::int32_t error = state.keeper.unguarded[rtpu.index].load(std::memory_order_relaxed);
  return error == 0 ? "" : std::string("no safe frame can be written: ") + ::strerrordesc_np(error);
}

NoGuard no_guard(const ManagerState& state, RtpuId rtpu) {
  const std::int32_t pid = state.keeper.guard_pid.load(std::memory_order_relaxed);
  const GuardState guard = state.keeper.guard_state.load(std::memory_order_relaxed);
  if (guard == GuardState::kDead) return {lack_text(guard), "end the run and start it again"};
  if (pid == 0) return {"the subsystem has no guard: no task has a device", "leave out `--kill`"};
  if (const std::string why = unguarded_text(state, rtpu); !why.empty()) return {why, kRaiseLimits};
  if (!state.guard_hang.empty())
    return {"the guard " + state.guard_hang, "`kill -CONT " + std::to_string(pid) + "` continues a stopped one"};
  return {};
}

void GuardWatch::look(ManagerState& state, Nanoseconds at) {
  const GuardState guard = state.keeper.guard_state.load(std::memory_order_relaxed);
  if (guard != shown_) state.tell("safe", TaskId{}, RtpuId{}, lack_text(guard), at);
  shown_ = guard;
  for (std::uint32_t r = 0; r < state.peers.n_rtpus(); ++r) {
    const std::int32_t error = state.keeper.unguarded[r].load(std::memory_order_relaxed);
    if (error != 0 && error != unguarded_[r])
      state.tell("safe", TaskId{}, RtpuId(r), unguarded_text(state, RtpuId(r)) + "; " + kRaiseLimits, at);
    unguarded_[r] = error;
  }
}

Json guard_json(const ManagerState& state) {
  const std::int32_t pid = state.keeper.guard_pid.load(std::memory_order_relaxed);
  const GuardState guard = state.keeper.guard_state.load(std::memory_order_relaxed);
  if (pid == 0 && guard == GuardState::kWell) return {};
  const auto or_null = [](const std::string& text) { return text.empty() ? Json() : Json(text); };
  return {{"pid", pid}, {"lack", or_null(lack_text(guard))}, {"hang", or_null(state.guard_hang)}};
}

}  // namespace chimera::manager
