// SPDX-License-Identifier: Apache-2.0
// The segments of the real-time units as the manager maps them: read-only, each kept until its successor's came, so
// that the last words and values of a dead one can still be read.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/peer_segment.h"
#include "chimera/task/fault_record.h"

namespace chimera::manager {

/// All real-time units. Context: setup.
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
  /// Puts another incarnation in the place of the present one. Closes `descriptor` in any case.
  Result<void> map(RtpuId rtpu, std::uint32_t incarnation, int descriptor);

  /// The segment of the task's rtpu; not there before it came.
  const PeerSegment& of(TaskId task) const noexcept { return *segments_[spec_->tasks[task.index].rtpu.index]; }
  /// As it stands in the segment, dead or alive.
  TaskStatus status(TaskId task) const noexcept;
  FaultRecord fault(TaskId task) const noexcept;

 private:
  explicit Peers(const ApplicationSpec& spec) noexcept : spec_(&spec) {}

  const ApplicationSpec* spec_;
  std::unique_ptr<HeapMemory> memory_ = std::make_unique<HeapMemory>();  // behind the layouts
  std::vector<PeerLayout> layouts_;  // of the rtpus, then of the manager
  std::vector<std::shared_ptr<const PeerSegment>> segments_;  // never null
};

}  // namespace chimera::manager
