// SPDX-License-Identifier: Apache-2.0
// The simulated keeper: starts processes, notices deaths, holds what outlives the manager.
#pragma once

#include <vector>

#include "tests/subsystem/world.h"

namespace chimera::simulated {

class Keeper {
 public:
  explicit Keeper(ManagerState& world);

  /// Everything for the first time.
  void begin();
  /// A message of the manager; nothing when it lives.
  void start(RtpuId rtpu);
  /// The process is gone; noticed a little later.
  void dies(RtpuId rtpu);
  void manager_dies();
  /// As the keeper page says.
  bool is_alive(RtpuId rtpu) const noexcept { return alive_[rtpu.index]; }
  std::uint32_t incarnation(RtpuId rtpu) const noexcept { return incarnations_[rtpu.index]; }
  /// Dies again and again when started.
  void set_crasher(RtpuId rtpu, int times) noexcept { crasher_ = rtpu, crashes_ = times; }

  subsystem::Begun memory;  ///< what the manager remembers

 private:
  void start_now(RtpuId rtpu);

  ManagerState& world_;
  std::vector<bool> alive_;
  std::vector<std::uint32_t> incarnations_;
  RtpuId crasher_;
  int crashes_ = 0;
};

}  // namespace chimera::simulated
