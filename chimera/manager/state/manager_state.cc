// SPDX-License-Identifier: Apache-2.0
// Logs events, and keeps the clocks of the manager.
#include "chimera/manager/state/manager_state.h"

#include "chimera/manager/state/credible.h"
#include "chimera/platform/wake.h"

namespace chimera::manager {
namespace {

Clock* stepped_clock = nullptr;  // set by a test

}  // namespace

Nanoseconds now() noexcept {
  return stepped_clock != nullptr ? stepped_clock->now() : LinuxClock().now();
}

void use_clock(Clock* clock) noexcept { stepped_clock = clock; }

std::int64_t wall_ns(Nanoseconds at) noexcept { return wall_clock_shift() + at.count; }

ManagerState::ManagerState(Bundle given, Peers mapped, OwnSegment segment, DecisionPage& shared,
                           const KeeperPage& keepers)
    : bundle(std::move(given)),
      peers(std::move(mapped)),
      own(std::move(segment)),
      page(shared),
      keeper(keepers),
      logic(peers.spec()),
      log(own.block().memory().events),
      rtpus(peers.n_rtpus()),
      tap_users(peers.n_tasks()) {
  rivals.prepare(peers.spec(), memory);
  if (bundle.is_idle()) return;
  configuration = verify(bundle).configuration;
  if (configuration)
    readings.emplace(peers, own, *configuration, bundle.library, [this](TaskId task) { return state(task); });
}

Profile ManagerState::profile(TaskId task) const noexcept {
  const PeerSegment& segment = peers.of(task);
  return segment.is_there() ? credible(segment.block().profile(task), now() - keeper.origin) : Profile{};
}

FaultRecord ManagerState::fault(TaskId task) const noexcept {
  const FaultRecord read = peers.fault(task);
  return is_credible(read, keeper.origin, now()) ? read : FaultRecord{};
}

void ManagerState::tell(std::string kind, TaskId task, RtpuId rtpu, std::string text, Nanoseconds at) {
  log.add({0, at, wall_ns(at), std::move(kind), task, rtpu, std::move(text), acting});
  if (keep) keep(log.at(log.last()));  // may add a note about the disk
  own.block().memory().events.store(log.last(), std::memory_order_release);
}

void ManagerState::announce() noexcept {
  page.changes.fetch_add(1, std::memory_order_release);
  for (std::uint32_t peer = 0; peer < peers.n_rtpus(); ++peer) Doorbell(page.bells[peer].word).ring();
}

}  // namespace chimera::manager
