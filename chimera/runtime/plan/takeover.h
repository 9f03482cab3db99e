// SPDX-License-Identifier: Apache-2.0
// Record of one takeover: a task was to go ON in place of one that failed, without a request. Plain data in memory that
// outlives its context; the filer of receipts makes a receipt of it. docs/formats/receipt.md.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/table/shared_copy.h"

namespace chimera {

/// kAborted: the standby could not go ON. `at`: the standby was ON. `ended`: its first cycle was seen, or none came, or
/// it could not go ON. `flag`: how long no task stood in for the loss.
struct Takeover : SwitchResult {
  static constexpr std::uint32_t kVariablesKept = 16, kSaid = 160;

  std::uint32_t number = 0;        ///< among those of its context, from 1 in the order of their first reports
  std::uint32_t set = kNoSet;      ///< that was in force, in ApplicationSpec::sets, with standbys for their primaries
  TaskId from;                     ///< the task that failed
  bool was_death = false;          ///< its process died; else it is in ERROR
  char said[kSaid + 1] = {};       ///< by the method that failed
  Nanoseconds lost = kNever;       ///< its loss was found
  TaskPart standby;
  std::uint32_t n_variables = 0;   ///< handed over; only kVariablesKept of them are kept
  std::array<VariablePart, kVariablesKept> variables;

  std::span<const VariablePart> kept() const noexcept {
    return std::span(variables).first(std::min(n_variables, kVariablesKept));
  }
  std::span<VariablePart> kept() noexcept {
    return std::span(variables).first(std::min(n_variables, kVariablesKept));
  }
};

/// Writes the takeover as a receipt, whose lists have room for two tasks and all variables. Context: any; wait-free.
inline void write_receipt(const Takeover& takeover, SwitchReceipt& receipt) noexcept {
  static_cast<SwitchResult&>(receipt) = takeover;
  receipt.before = receipt.after = takeover.set;
  receipt.cause = SwitchCause::kStandby;
  receipt.by = takeover.standby.task;
  receipt.in_place_of = takeover.from;
  receipt.was_death = takeover.was_death;
  receipt.task = takeover.end == SwitchEnd::kDone ? TaskId() : takeover.standby.task;
  const char* const end = std::find(takeover.said, takeover.said + Takeover::kSaid, '\0');
  receipt.said.assign({takeover.said, static_cast<std::size_t>(end - takeover.said)});
  receipt.asked = takeover.lost;
  receipt.armed = takeover.at;
  receipt.tasks = {receipt.tasks.data(), 2};
  receipt.tasks[0] = takeover.standby;
  receipt.tasks[1] = {};
  receipt.tasks[1].task = takeover.from;
  receipt.tasks[1].move = TaskMove::kLeaves;
  receipt.variables = {receipt.variables.data(), takeover.kept().size()};
  std::copy(takeover.kept().begin(), takeover.kept().end(), receipt.variables.begin());
}

/// Keeps a receipt of a takeover that is over, if there is room. Context: cycle boundary; wait-free.
inline void keep_receipt(const Takeover& takeover, SwitchReceipts& receipts) noexcept {
  if (takeover.ended == kNever) return;
  const std::uint32_t number = receipts.next_number();
  if (!receipts.has_room()) return receipts.leave_out();
  SwitchReceipt& receipt = receipts.add();
  receipt.number = number;
  write_receipt(takeover, receipt);
}

/// The last takeovers of one context. One writer. A reader detects that a place was written anew while it read.
class TakeoverRing {
 public:
  static constexpr std::uint32_t kKept = 16;

  /// Takeover `number` is the next one, or an earlier one that is reported anew. No effect if it is no longer kept.
  /// Context: cycle boundary; wait-free.
  void put(const Takeover& takeover) noexcept {
    if (takeover.number < oldest()) return;
    Place& place = places_[takeover.number % kPlaces];
    place.over.store(0, std::memory_order_relaxed);
    // SYNC: pairs with the fence in read(): a reader that copies a byte of this takeover sees that none is over here.
    shared_copy::release_fence();
    place.takeover = takeover;
    const bool is_over = takeover.ended != kNever;
    // SYNC: each release pairs with the acquire of the same word in read().
    if (is_over) place.over.store(takeover.number, std::memory_order_release);
    const bool is_new = takeover.number > last_.load(std::memory_order_relaxed);
    if (is_new) last_.store(takeover.number, std::memory_order_release);
  }
  /// The lowest number that is kept; takeovers from there on can be read. Context: setup.
  std::uint32_t oldest() const noexcept {
    const std::uint32_t last = last_.load(std::memory_order_acquire);
    return last <= kKept ? 1 : last - kKept + 1;
  }
  /// False: the takeover has not begun, or is not over and its context lives, or another one replaced it during the
  /// read. Context: setup.
  bool read(std::uint32_t number, bool is_alive, Takeover& to) const noexcept {
    if (number < oldest() || number > last_.load(std::memory_order_acquire)) return false;
    const Place& place = places_[number % kPlaces];
    if (is_alive && place.over.load(std::memory_order_acquire) != number) return false;
    to = place.takeover;
    shared_copy::acquire_fence();  // SYNC: the copy is not later than the loads behind it
    const bool was_over = place.over.load(std::memory_order_relaxed) == number;
    return to.number == number && (was_over || !is_alive);
  }

 private:
  struct Place {
    std::atomic<std::uint32_t> over{0};  // number of the takeover in it that is over
    Takeover takeover;
  };
  static constexpr std::uint32_t kPlaces = kKept + 1;  // none that can be read is where the next one is written
  std::atomic<std::uint32_t> last_{0};
  std::array<Place, kPlaces> places_;
};

}  // namespace chimera
