// SPDX-License-Identifier: Apache-2.0
// Gives the cycling thread its real-time rights and runs the executive or the preemptive executor in it.
#include "chimera/rtpu/cycling_thread.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "chimera/platform/realtime.h"
#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"
#include "chimera/schedule/bands.h"
#include "chimera/schedule/shares.h"
#include "chimera/schedule/utilisation.h"

namespace chimera {
namespace {

std::int32_t priority_of(const ApplicationSpec& spec, std::uint32_t me, std::int32_t top) {
  std::vector<BandMember> members;
  for (const RtpuSpec& rtpu : spec.rtpus) members.push_back({rtpu.cpu, 0});
  for (const TaskSpec& task : spec.tasks) {
    BandMember& member = members[task.rtpu.index];
    member.criticality = std::max(member.criticality, task.criticality);
  }
  return band_top(members, me, top);
}

// CPU time that the jobs of this rtpu may use: a little less than the kernel's limit for it.
Nanoseconds share(const ApplicationSpec& spec, std::uint32_t me, Nanoseconds window) {
  std::vector<ShareMember> members;
  for (const RtpuSpec& rtpu : spec.rtpus) members.push_back({rtpu.cpu, 0});
  for (const TaskSpec& task : spec.tasks) members[task.rtpu.index].load += load_of(task);
  const double mine = share_of(members, me, realtime_share() - kShareMargin);
  return {static_cast<std::int64_t>(mine * static_cast<double>(window.count))};
}

}  // namespace

void publish_phase(BlockHead& head, std::string_view text, PeerPhase phase) noexcept {
  const std::size_t n = std::min(text.size(), sizeof head.grant - 1);
  std::memcpy(head.grant, text.data(), n);
  head.grant[n] = '\0';
  head.phase.store(phase, std::memory_order_release);
}

CyclingThread::CyclingThread(const CyclingPlace& place) : place_(place), tap_(place.others.block().tap()) {}

void CyclingThread::start() {
  thread_ = std::thread([this] { run(); });
}

bool CyclingThread::is_gone() const noexcept {
  const pid_t id = thread_id_;
  return id != 0 && used_by(id) == kNever && !has_ended_;  // in this order: it may end in between
}

void CyclingThread::run() {
  thread_id_ = this_thread();
  use_decimal_point();
  const int ceiling = priority_of(place_.spec, place_.me, place_.priority);
  const RealtimeGrant grant = enter_realtime({ceiling, own_cpu(), true, place_.room});
  if (self().preemptive)
    make_threads(grant.priority ? ceiling : 0);
  else
    make_loop();
  publish_phase(head(), grant.report.view(), PeerPhase::kServing);
  if (self().preemptive)
    run_threads();
  else
    run_loop();
  has_ended_ = true;
  ring_event(place_.over);
}

RunOptions CyclingThread::options() {
  RunOptions options;
  options.policy = self().policy;
  options.tap = &tap_;
  options.rtpu = static_cast<std::uint8_t>(place_.me);
  options.guest = &place_.edge;
  options.stop = &place_.edge.rtpu_end().is_over();
  options.writer = &place_.writer;
  options.switch_peers = &place_.switching;
  return options;
}

void CyclingThread::make_loop() {
  clock_ = std::make_unique<BellClock>(Doorbell(place_.bell), head().running, place_.edge);
  job_clock_ = std::make_unique<ComputingClock>(*clock_);
  RunOptions how = options();
  how.events = &events_;
  executive_ = std::make_unique<Executive>(place_.tasks, *clock_, *job_clock_, how);
}

// The reaction `stop` of a task: all tasks of the rtpu go OFF, and the rtpu goes on.
void CyclingThread::answer_stop(Releases& releases, Nanoseconds now) noexcept {
  place_.edge.stop_all(releases.signals(), releases.settlement().stopped_by(), now);
  releases.settlement().forget_stop();
}

void CyclingThread::run_loop() {
  executive_->start(place_.origin);
  place_.edge.begin();
  while (executive_->run(kNever) == RunEnd::kTaskStopped) answer_stop(executive_->releases(), clock_->now());
}

void CyclingThread::make_threads(int ceiling) {
  ProcessorPlace processor;
  processor.cpu = static_cast<int>(self().cpu);
  processor.ceiling = ceiling;
  processor.base = ceiling - kBandWidth + 1;
  processor.bell = &place_.bell;
  if (ceiling > 0 && realtime_share() < 1) {
    processor.window = realtime_period();
    processor.share = share(place_.spec, place_.me, processor.window);
  }
  preemptive_ = std::make_unique<PreemptiveExecutor>(place_.tasks, options(), processor);
}

void CyclingThread::run_threads() {
  preemptive_->start(place_.origin);
  place_.edge.begin();
  while (preemptive_->run(kNever) == RunEnd::kTaskStopped)
    preemptive_->at_edge([this] { answer_stop(preemptive_->releases(), wall_.now()); });
}

}  // namespace chimera
