// SPDX-License-Identifier: Apache-2.0
// The listener of one rtpu of several in virtual time. At the cycle boundaries it brings in changes and signals of the
// others and acts of the script. Then it shows the others the changes of this rtpu.
#pragma once

#include <vector>

#include "chimera/runtime/cycle/script.h"
#include "chimera/runtime/life/boundary_listener.h"
#include "chimera/runtime/record/context_tap.h"
#include "chimera/runtime/virtual/virtual_peers.h"

namespace chimera {

/// Context of everything not marked: cycle boundary.
class VirtualControl final : public BoundaryListener {
 public:
  /// Serves the rtpu, which has joined the peers. Both outlive this; room for `n_acts` acts. Context: setup.
  VirtualControl(VirtualPeers& peers, RtpuId rtpu, std::size_t n_acts);
  /// From now on `tap` records changes of the flag that came from elsewhere. Context: setup.
  void record_on(ContextTap& tap) noexcept { tap_ = &tap; }

  /// The next cycle boundary carries the act out.
  void hand_over(const ScriptAct& act) noexcept;
  /// The reaction `stop` of a task: the next cycle boundary turns all tasks of the rtpu OFF.
  void stop_all() noexcept;
  /// Reads states and groups of other contexts as they are now.
  void follow(Nanoseconds now) noexcept;

  void take(BoundarySignals& signals, Nanoseconds now) noexcept override;
  void publish() noexcept override;
  void told(const SignalReport&, Nanoseconds) noexcept override {}
  void missed(TaskId, const MissCause::Verdict&, Nanoseconds) noexcept override {}
  void hangs(TaskWord, Nanoseconds, Nanoseconds, Nanoseconds) noexcept override {}
  void gave_way(TaskId, Nanoseconds, Nanoseconds) noexcept override {}
  void show(const Task&) noexcept override {}

 private:
  void take_posts() noexcept;
  void turn_all_off(BoundarySignals& signals, Nanoseconds now) noexcept;

  VirtualPeers& peers_;
  RtpuId rtpu_;
  TaskSet& tasks_;
  ContextTap* tap_ = nullptr;
  std::vector<ScriptAct> acts_;  // to be carried out by the next cycle boundary
  std::uint64_t followed_ = 0;   // result of VirtualPeers::look() at the last follow()
  bool stops_all_ = false;
  bool is_flag_known_up_ = false;  // as it was recorded, or published, last
};

}  // namespace chimera
