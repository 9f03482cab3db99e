// SPDX-License-Identifier: Apache-2.0
// Interface to the other contexts that take part in a switch: reads their progress, and shows them that of this one.
#pragma once

#include "chimera/runtime/plan/switch_agreement.h"
#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/runtime/plan/takeover.h"

namespace chimera {

/// Used by the thread that handles cycle boundaries. Context of everything: cycle boundary; wait-free.
class SwitchPeers {
 public:
  virtual SwitchPage& page() noexcept = 0;
  /// The living contexts, its own included. Bit c: context c.
  virtual std::uint16_t living() const noexcept = 0;
  /// Progress of another context that lives; null: not known yet.
  virtual const SwitchProgress* progress(std::uint32_t context) const noexcept = 0;
  /// A word of the page changed: the others must check it.
  virtual void ring() noexcept = 0;
  /// Shows the others the changes of this context.
  virtual void show() noexcept = 0;
  /// All jobs of this context use the bindings of that plan: shows the others the changes, then the number.
  virtual void tell_adopted(std::uint16_t number) noexcept = 0;
  /// Nothing is left to do for the plan: shows this context's part of the receipt, then the number.
  virtual void tell_over(const SwitchReceipt& receipt) noexcept = 0;
  /// A standby of this context took over, or could not. Called when it is ON, and anew when its first cycle was seen.
  virtual void tell_takeover(const Takeover& takeover) noexcept = 0;
  /// A task of this context asks for a switch: shows that to the context, or the manager, that plans.
  /// `changes_nothing`: the requested set is in force, or is being switched to.
  virtual void wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds now) noexcept = 0;
  /// A task or a reaction, of any context, has asked for a switch that waits for the present one to end.
  virtual bool is_wish_open() const noexcept = 0;

 protected:
  ~SwitchPeers() = default;
};

}  // namespace chimera
