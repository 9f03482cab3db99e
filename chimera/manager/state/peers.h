// SPDX-License-Identifier: Apache-2.0
// The segments of the rtpus as the manager maps them, read-only. Each stays mapped until the segment of its successor
// arrives, so that the last words and values of a dead rtpu can still be read.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/peer_segment.h"
#include "chimera/task/fault_record.h"

namespace chimera::manager {

/// All rtpus. Context: setup.
class Peers {
 public:
  /// `spec` outlives it.
  static Result<Peers> create(const ApplicationSpec& spec);

  const ApplicationSpec& spec() const noexcept { return *spec_; }
  std::uint32_t n_rtpus() const noexcept { return static_cast<std::uint32_t>(segments_.size()); }
  std::uint32_t n_tasks() const noexcept { return static_cast<std::uint32_t>(spec_->tasks.size()); }
  const PeerLayout& layout(RtpuId rtpu) const noexcept { return layouts_[rtpu.index]; }
  const PeerLayout& manager_layout() const noexcept { return layouts_.back(); }
  const PeerSegment& operator[](RtpuId rtpu) const noexcept { return *segments_[rtpu.index]; }
  /// The segment, which stays mapped as long as the pointer lives.
  std::shared_ptr<const PeerSegment> hold(RtpuId rtpu) const noexcept { return segments_[rtpu.index]; }
  /// Replaces the present incarnation by another. Closes `descriptor` in any case.
  Result<void> map(RtpuId rtpu, std::uint32_t incarnation, int descriptor);
  /// Reads nothing more of the present incarnation.
  void forget(RtpuId rtpu) { segments_[rtpu.index] = std::make_shared<const PeerSegment>(); }

  /// The segment of the task's rtpu; not there before it arrived.
  const PeerSegment& of(TaskId task) const noexcept { return *segments_[spec_->tasks[task.index].rtpu.index]; }
  /// The status word in the segment, even if the rtpu is dead.
  TaskStatus status(TaskId task) const noexcept;
  /// As it stands there: maybe overwritten. ManagerState::fault() is what users see.
  FaultRecord fault(TaskId task) const noexcept;

 private:
  explicit Peers(const ApplicationSpec& spec) noexcept : spec_(&spec) {}

  const ApplicationSpec* spec_;
  std::unique_ptr<HeapMemory> memory_ = std::make_unique<HeapMemory>();  // memory of layouts_
  std::vector<PeerLayout> layouts_;  // of the rtpus, then of the manager
  std::vector<std::shared_ptr<const PeerSegment>> segments_;  // never null
};

}  // namespace chimera::manager
