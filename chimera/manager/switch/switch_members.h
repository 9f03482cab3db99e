// SPDX-License-Identifier: Apache-2.0
// The rtpus for SwitchOrders: read from their segments and from the keeper's page.
#pragma once

#include <vector>

#include "chimera/manager/state/manager_state.h"
#include "chimera/runtime/switch/switch_orders.h"

namespace chimera::manager {

/// Context: setup.
class ShownMembers final : public SwitchMembers, private MadeConstants {
 public:
  /// `state` outlives this object.
  explicit ShownMembers(ManagerState& state) noexcept : state_(state) {}

  SwitchPage& page() noexcept override { return state_.page.switching; }
  std::uint16_t living() const noexcept override;
  TaskStatus status(TaskId task) const noexcept override;
  bool is_kept_off(TaskId task) const noexcept override { return state_.logic.is_kept_off(task); }
  Profile profile(TaskId task) const noexcept override { return state_.profile(task); }
  bool needs_gaps(TaskId task) const noexcept override;
  const MadeConstants& constants() noexcept override { return *this; }
  bool is_busy_with(std::uint32_t context, std::uint16_t plan) const noexcept override;
  bool read_part(std::uint32_t context, std::uint16_t plan, SwitchReceipt& part) const noexcept override;
  void ring() noexcept override { state_.announce(); }

 private:
  bool differ(ConstantId constant, std::uint32_t a, std::uint32_t b) const noexcept override;
  std::vector<std::byte> value(ConstantId constant, std::uint32_t producer) const;

  ManagerState& state_;
};

}  // namespace chimera::manager
