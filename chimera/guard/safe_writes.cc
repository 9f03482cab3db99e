// SPDX-License-Identifier: Apache-2.0
// Writes the frames of dead processes to their devices; no device delays another.
#include "chimera/guard/safe_writes.h"

#include <algorithm>
#include <cstring>

#include "chimera/platform/descriptor.h"

namespace chimera {
namespace {

constexpr Nanoseconds kDeviceLimit = seconds(1);    // a frame is given up if its device accepts nothing for this time
constexpr Nanoseconds kTryAgain = microseconds(500);

}  // namespace

void SafeWrites::keep(std::uint32_t task, std::uint32_t frame, OwnedDescriptor descriptor, Nanoseconds pause) noexcept {
  if (frame >= kSafeFrames || std::size_t{task} * kSafeFrames >= frames_.size()) return;
  Frame& kept = of(TaskId(task))[frame];
  kept.device = std::move(descriptor);
  kept.pause = std::clamp(pause, Nanoseconds{0}, kDeviceLimit);
}

void SafeWrites::begin(TaskId task, const BlockView& block, const BlockView& successor, Nanoseconds now) noexcept {
  for (std::uint32_t i = 0; i < kSafeFrames; ++i) {
    Frame& frame = of(task)[i];
    const auto bytes = block.safe_frame(task, i).last_words();
    if (bytes.empty() || frame.device.fd < 0) continue;
    if (successor.is_there() && !successor.safe_frame(task, i).last_words().empty()) {
      frame.stage = Stage::kLate;
      continue;
    }
    std::memcpy(frame.bytes, bytes.data(), bytes.size());
    frame.size = static_cast<std::uint32_t>(bytes.size());
    frame.put = 0;
    frame.stage = Stage::kWaits;
    frame.due = now + frame.pause;
    frame.until = frame.due + kDeviceLimit;
    take_over_device(frame.device.fd);
  }
}

void SafeWrites::advance(Nanoseconds now) noexcept {
  for (Frame& frame : frames_)
    if (frame.stage == Stage::kWaits && frame.due <= now) write(frame, now);
}

void SafeWrites::write(Frame& frame, Nanoseconds now) noexcept {
  const int put = write_device(frame.device.fd, std::span(frame.bytes).subspan(frame.put, frame.size - frame.put));
  if (put > 0) {
    frame.put += static_cast<std::uint32_t>(put);
    frame.at = now;
  }
  if (frame.put == frame.size) frame.stage = Stage::kWritten;
  else if (put < 0 || now >= frame.until) frame.stage = Stage::kLost;
  frame.due = frame.stage == Stage::kWaits ? now + kTryAgain : kNever;
}

Nanoseconds SafeWrites::due() const noexcept {
  Nanoseconds due = kNever;
  for (const Frame& frame : frames_) due = std::min(due, frame.due);
  return due;
}

bool SafeWrites::is_on_its_way(TaskId task) noexcept {
  return std::ranges::any_of(of(task), [](const Frame& frame) { return frame.stage == Stage::kWaits; });
}

void SafeWrites::finish(TaskId task, WrittenFrames& written) noexcept {
  for (Frame& frame : of(task)) {
    if (frame.stage == Stage::kWritten) ++written.good;
    if (frame.stage == Stage::kLost) ++written.bad;
    if (frame.stage == Stage::kLate || frame.stage == Stage::kWaits) ++written.late;
    written.at = std::max(written.at, frame.at);
    frame.device = OwnedDescriptor();
    frame.stage = Stage::kNone;
    frame.due = kNever;
    frame.at = {};
  }
}

}  // namespace chimera
