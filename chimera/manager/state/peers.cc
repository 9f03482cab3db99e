// SPDX-License-Identifier: Apache-2.0
// The segments of all rtpus as the manager maps them.
#include "chimera/manager/state/peers.h"

#include <cstring>

#include "chimera/platform/descriptor.h"

namespace chimera::manager {

Result<Peers> Peers::create(const ApplicationSpec& spec) {
  Peers made(spec);
  for (std::uint32_t peer = 0; peer <= spec.rtpus.size(); ++peer) {
    auto layout = PeerLayout::of(spec, peer, *made.memory_);
    if (!layout) return layout.error();
    made.layouts_.push_back(*layout);
  }
  made.segments_.assign(spec.rtpus.size(), std::make_shared<const PeerSegment>());
  return made;
}

Result<void> Peers::map(RtpuId rtpu, std::uint32_t incarnation, int descriptor) {
  const OwnedDescriptor passed(descriptor);
  auto segment = PeerSegment::open(descriptor, layout(rtpu), n_tasks(), rtpu.index, incarnation);
  if (!segment) return segment.error();
  segments_[rtpu.index] = std::make_shared<const PeerSegment>(*std::move(segment));
  return {};
}

TaskStatus Peers::status(TaskId task) const noexcept {
  const PeerSegment& segment = of(task);
  return segment.is_there() ? segment.block().status(task) : TaskStatus{};
}

FaultRecord Peers::fault(TaskId task) const noexcept {
  const PeerSegment& segment = of(task);
  FaultRecord record;
  if (!segment.is_there()) return record;
  const GroupReader reader = segment.group(layout(spec_->tasks[task.index].rtpu).fault(task));
  std::vector<std::byte> payload(reader.payload_bytes());
  chimera_slot slot;
  if (!reader.try_read(slot, payload.data()) || slot.sequence == 0) return record;
  std::memcpy(static_cast<void*>(&record), payload.data(), sizeof record);
  record.last.text[sizeof record.last.text - 1] = '\0';
  record.note[sizeof record.note - 1] = '\0';
  return record;
}

}  // namespace chimera::manager
