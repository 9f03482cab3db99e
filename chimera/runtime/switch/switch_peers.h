// SPDX-License-Identifier: Apache-2.0
// What the tasks of one context know of the other contexts that take part in a switch, and what they tell them.
#pragma once

#include "chimera/runtime/switch/switch_agreement.h"
#include "chimera/runtime/switch/switch_receipt.h"
#include "chimera/runtime/takeover.h"

namespace chimera {

/// Asked by the thread that takes the edges. Context of everything: cycle boundary; wait-free.
class SwitchPeers {
 public:
  virtual SwitchPage& page() noexcept = 0;
  /// The contexts that live, bit c: context c; the own one among them.
  virtual std::uint16_t living() const noexcept = 0;
  /// Of another context that lives; null: it is not known yet.
  virtual const SwitchProgress* progress(std::uint32_t context) const noexcept = 0;
  /// A word of the page changed: the others are to look at it.
  virtual void ring() noexcept = 0;
  /// What changed is shown to the others.
  virtual void show() noexcept = 0;
  /// All jobs of this context use the bindings of that plan: what changed is shown to the others, then the number.
  virtual void tell_adopted(std::uint16_t number) noexcept = 0;
  /// Nothing is left to do for the plan: the part of this context in its receipt is shown, then the number.
  virtual void tell_over(const SwitchReceipt& receipt) noexcept = 0;
  /// A standby of this context took over, or could not: told when it is ON, and anew when its first cycle was seen.
  virtual void tell_takeover(const Takeover& takeover) noexcept = 0;
  /// A task of this context asks for a switch: whoever plans is to see it. `changes_nothing`: it is for what is in
  /// force, or is being switched to.
  virtual void wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds now) noexcept = 0;
  /// A task or a reaction, of any context, has asked for a switch that waits for the present one to end.
  virtual bool is_wish_open() const noexcept = 0;

 protected:
  ~SwitchPeers() = default;
};

}  // namespace chimera
