// SPDX-License-Identifier: Apache-2.0
// The real-time thread of a unit: cycles all tasks in one loop, or takes the edges of those that have threads of their
// own.
#pragma once

#include <atomic>
#include <memory>
#include <string_view>
#include <thread>

#include "chimera/platform/clock.h"
#include "chimera/platform/wake.h"
#include "chimera/rtpu/rtpu_control.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/background_writer.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera {

/// Leaves what a unit says of itself in its block, cut to the room there is. Context: setup.
void publish_phase(BlockHead& head, std::string_view text, PeerPhase phase) noexcept;

/// What a unit's real-time thread works with; all of it outlives the thread.
struct CyclingPlace {
  const ApplicationSpec& spec;
  std::uint32_t me;
  std::int32_t priority;  ///< the highest level any unit may have: ApplicationSettings
  TaskSet& tasks;
  RtpuControl& edge;
  PeerLinks& others;
  SwitchPeers& switching;
  BackgroundWriter& writer;  ///< runs what components do beside their cycles
  Nanoseconds origin;  ///< of the grid of releases that all units share
  std::atomic<std::uint32_t>& bell;
  int over;  ///< descriptor of a WakeEvent, rung when the thread has ended
};

/// Started and joined by the main thread.
class CyclingThread {
 public:
  /// Context: setup.
  explicit CyclingThread(const CyclingPlace& place);
  CyclingThread(const CyclingThread&) = delete;
  CyclingThread& operator=(const CyclingThread&) = delete;

  /// Takes real-time rights, says in the block what was granted, and cycles until the edge is over. Context: setup.
  void start();
  /// All tasks are killed and nothing cycles any more. Any thread.
  bool has_ended() const noexcept { return has_ended_; }
  /// Context: setup; blocks until it has ended.
  void join() { thread_.join(); }

 private:
  void run();
  const RtpuSpec& self() const { return place_.spec.rtpus[place_.me]; }
  BlockHead& head() const { return place_.others.block().head(); }
  RunOptions options();
  void answer_stop(Releases& releases, Nanoseconds now) noexcept;
  void make_loop();
  void run_loop();
  void make_threads(int ceiling);
  void run_threads();

  const CyclingPlace place_;
  Tap tap_;
  LinuxClock wall_;
  std::unique_ptr<BellClock> clock_;
  std::unique_ptr<ComputingClock> job_clock_;
  std::unique_ptr<Executive> executive_;
  std::unique_ptr<PreemptiveExecutor> preemptive_;  // one of the two
  std::atomic<bool> has_ended_{false};  // stored last by the thread, loaded by the main thread before it joins
  std::thread thread_;
};

}  // namespace chimera
