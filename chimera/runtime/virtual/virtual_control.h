// SPDX-License-Identifier: Apache-2.0
// The control of one real-time unit of several in virtual time: takes in at the edges of the unit what the others
// changed and sent and what the script wants of the unit, and shows the others what the edges changed.
#pragma once

#include <vector>

#include "chimera/runtime/boundary_listener.h"
#include "chimera/runtime/context_tap.h"
#include "chimera/runtime/script.h"
#include "chimera/runtime/virtual/virtual_peers.h"

namespace chimera {

/// Context of everything not marked: edge.
class VirtualControl final : public BoundaryListener {
 public:
  /// Of the rtpu, which has joined the peers. Both outlive this; room for `n_acts` acts. Context: setup.
  VirtualControl(VirtualPeers& peers, RtpuId rtpu, std::size_t n_acts);
  /// From now on changes of the flag that came from elsewhere are recorded there. Context: setup.
  void record_on(ContextTap& tap) noexcept { tap_ = &tap; }

  /// The next edge carries it out.
  void hand_over(const ScriptAct& act) noexcept;
  /// The reaction `stop` of a task: the next edge turns all tasks of the rtpu OFF.
  void stop_all() noexcept;
  /// Reads states and groups of other contexts as they are now.
  void follow(Nanoseconds now) noexcept;

  void take(BoundarySignals& signals, Nanoseconds now) noexcept override;
  void publish() noexcept override;
  void told(const SignalReport&, Nanoseconds) noexcept override {}
  void missed(TaskId, const MissCause::Verdict&, Nanoseconds) noexcept override {}
  void hangs(TaskWord, Nanoseconds, Nanoseconds) noexcept override {}
  void gave_way(TaskId, Nanoseconds, Nanoseconds) noexcept override {}
  void show(const Task&) noexcept override {}

 private:
  void take_posts() noexcept;
  void turn_all_off(BoundarySignals& signals, Nanoseconds now) noexcept;

  VirtualPeers& peers_;
  RtpuId rtpu_;
  TaskSet& tasks_;
  ContextTap* tap_ = nullptr;
  std::vector<ScriptAct> acts_;  // to be carried out by the next edge
  std::uint64_t followed_ = 0;   // VirtualPeers::look(), then
  bool stops_all_ = false;
  bool is_flag_known_up_ = false;  // as it was recorded, or published, last
};

}  // namespace chimera
