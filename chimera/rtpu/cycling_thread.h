// SPDX-License-Identifier: Apache-2.0
// The real-time thread of an rtpu. It cycles all tasks in one loop; on a preemptive rtpu it runs the cycle boundaries
// of tasks that have their own threads.
#pragma once

#include <atomic>
#include <memory>
#include <string_view>
#include <thread>

#include "chimera/platform/clock.h"
#include "chimera/platform/thread.h"
#include "chimera/platform/wake.h"
#include "chimera/rtpu/rtpu_control.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/hosted/background_writer.h"
#include "chimera/runtime/hosted/descriptor_events.h"
#include "chimera/runtime/preemptive/preemptive_executor.h"

namespace chimera {

/// Writes the phase of the rtpu and a text to its block; cuts the text to the room in the block. Context: setup.
void publish_phase(BlockHead& head, std::string_view text, PeerPhase phase) noexcept;

/// All that the real-time thread of an rtpu works with; it outlives the thread.
struct CyclingPlace {
  const ApplicationSpec& spec;
  std::uint32_t me;
  std::int32_t priority;  ///< the highest level that any rtpu may have: ApplicationSettings
  TaskSet& tasks;
  RtpuControl& edge;
  PeerLinks& others;
  SwitchPeers& switching;
  BackgroundWriter& writer;  ///< runs the background methods of components
  Nanoseconds origin;  ///< of the grid of releases that all rtpus share
  std::atomic<std::uint32_t>& bell;
  int over;  ///< descriptor of a WakeEvent, rung when the thread has ended
  std::uint64_t room;  ///< bytes of other processes that this process maps later, at most
};

/// The main thread starts and joins it.
class CyclingThread {
 public:
  /// Context: setup.
  explicit CyclingThread(const CyclingPlace& place);
  CyclingThread(const CyclingThread&) = delete;
  CyclingThread& operator=(const CyclingThread&) = delete;

  /// Requests real-time rights, writes the granted ones to the block, and cycles until the control ends the loop.
  /// Context: setup.
  void start();
  /// Its id; 0: it has not begun. Any thread.
  pid_t thread() const noexcept { return thread_id_; }
  /// True if all tasks are killed and no task cycles any more. Any thread.
  bool has_ended() const noexcept { return has_ended_; }
  /// True if the thread is gone without has_ended(): a component ended it. Any thread; one system call.
  bool is_gone() const noexcept;
  /// Context: setup; blocks until the thread has ended.
  void join() { thread_.join(); }

 private:
  void run();
  const RtpuSpec& self() const { return place_.spec.rtpus[place_.me]; }
  /// -1: any CPU, because the tasks of a board run there.
  int own_cpu() const { return self().link.is_there() ? -1 : static_cast<int>(self().cpu); }
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
  DescriptorEvents events_;  // of the loop without preemption
  std::unique_ptr<BellClock> clock_;
  std::unique_ptr<ComputingClock> job_clock_;
  std::unique_ptr<Executive> executive_;
  std::unique_ptr<PreemptiveExecutor> preemptive_;  // one of the two
  std::atomic<pid_t> thread_id_{0};  // stored first by the thread
  std::atomic<bool> has_ended_{false};  // stored last by the thread, loaded by the main thread before it joins
  std::thread thread_;
};

}  // namespace chimera
