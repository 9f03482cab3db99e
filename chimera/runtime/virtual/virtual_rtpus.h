// SPDX-License-Identifier: Apache-2.0
// Several rtpus in virtual time, in one process and on one clock: each with its own tasks, policy and processor.
// docs/formats/virtual-time.md has the rules.
//
// Order of things at one instant, over all rtpus: ends of jobs with their publications, the script (deaths first),
// deaths of rtpus whose primary tasks are silent for too long (silence.h), cycle boundaries with their signals,
// releases, starts of jobs with their inputs; each in the order of the rtpus. A job reads at its start the values that
// others have published up to then, and publishes at its end. Effects of that at the same instant need another round.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "chimera/runtime/job/silence.h"
#include "chimera/runtime/virtual/stepped_processor.h"
#include "chimera/runtime/virtual/virtual_control.h"
#include "chimera/runtime/virtual/virtual_executor.h"
#include "chimera/runtime/virtual/virtual_peers.h"
#include "chimera/runtime/virtual/virtual_switches.h"

namespace chimera {

/// One thread; a run repeats exactly.
class VirtualRtpus {
 public:
  /// Runs the rtpus that have joined `peers`, each with its own policy. An rtpu is preemptive if its spec or `how` says
  /// so. All arguments outlive this. Requires: preemptive where a task has a server; no listener. Context: setup.
  VirtualRtpus(VirtualPeers& peers, const RunOptions& options, const VirtualOptions& how);
  VirtualRtpus(const VirtualRtpus&) = delete;
  VirtualRtpus& operator=(const VirtualRtpus&) = delete;
  ~VirtualRtpus();

  /// Spawns all tasks in the order of constants and turns the start set ON in data-flow order, each over all rtpus;
  /// what their methods spend is the origin of the grid. Refuses as TaskLife::start. Context: setup.
  Result<void> start();
  /// Runs to that instant, counted from the origin, where the run may go on as if it had not been interrupted.
  /// Context: cycle.
  RunEnd run_to(Nanoseconds until) noexcept;
  /// As run_to(), and is over there: a job under way is finished (executive) or cut (preemptive). Context: cycle.
  RunEnd run(Nanoseconds duration) noexcept;
  /// off and kill for every task that is not on a dead rtpu. Context: setup.
  void shut_down();

  /// Context: any.
  Nanoseconds now() const noexcept { return now_; }
  Nanoseconds origin() const noexcept { return origin_; }
  /// In order of time. Context: setup, between runs.
  std::vector<RefusedSignal> refused();
  /// Receipts of all switches that the script or a task asked for. Context: setup, between runs.
  const SwitchReceipts& receipts() noexcept { return switches_.receipts(); }

 private:
  struct Rtpu;

  Result<void> spawn_all();
  Result<void> turn_on_all();
  SignalReport signal(TaskId task, Signal signal);
  Rtpu& rtpu_of(TaskId task) noexcept;
  void take_acts() noexcept;
  void act(const ScriptAct& act, Rtpu*& last) noexcept;
  void lower_flag(const ScriptAct& act) noexcept;
  void die(RtpuId rtpu) noexcept;
  void look_for_silence() noexcept;
  void stop_rtpus() noexcept;
  void take_edges() noexcept;
  bool take_edge(Rtpu& rtpu) noexcept;
  bool begin_jobs() noexcept;
  bool is_due(const Rtpu& rtpu) const noexcept;
  Nanoseconds next_event() noexcept;
  bool is_anything_left() noexcept;

  VirtualPeers& peers_;
  const std::atomic<bool>* stop_;  // as RunOptions::stop
  Script script_;
  HeapMemory memory_;  // behind switches_
  VirtualSwitches switches_;
  std::vector<std::unique_ptr<Rtpu>> rtpus_;  // with tasks, in the order of the rtpus
  std::vector<Silence> silences_;             // for the sake of standbys
  std::vector<RefusedSignal> of_dead_;        // signals for tasks of dead rtpus
  Nanoseconds now_, origin_;
};

}  // namespace chimera
