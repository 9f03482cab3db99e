// SPDX-License-Identifier: Apache-2.0
// The data about switches that must outlive the manager: the switch under way, its requester, and the receipts that are
// not on the disk yet. It lies in the manager's own block; the successor reads it. docs/formats/processes.md.
//
//   begin -> change... -> put                a switch that was begun
//   begin -> forget                          a switch that was never announced
//   put                                      a request that was refused
//   put -> filed                             its receipt is on the disk
//
// The last store of each call completes it. A manager that is killed before this store has not made the call.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "chimera/manager/state/asker.h"
#include "chimera/manager/state/line_journal.h"
#include "chimera/runtime/hosted/rtpu_block.h"
#include "chimera/runtime/switch/switch_orders.h"

namespace chimera::manager {

/// A switch that is under way. Plain value.
struct BegunSwitch : OrderedSwitch {
  Asker asked_by;      ///< kNone: a task or reaction asked for it
  Asker cancelled_by;  ///< kNone: it was not cancelled
};

/// One writer. Context: setup; never blocks.
class SwitchJournal {
 public:
  struct Pages {
    std::atomic<std::uint32_t> last{0};   ///< last number in use
    std::atomic<std::uint64_t> begun{0};  ///< number of the switch under way, twice, and its index in `slots`
    BegunSwitch slots[2];
    alignas(64) std::byte lines[LineJournal::kHeadBytes + (128 << 10)];  ///< the LineJournal of receipts
  };
  static_assert(sizeof(Pages) <= kJournalBytes);

  /// Uses the journal of a block that this process owns.
  explicit SwitchJournal(std::span<std::byte> bytes) noexcept;
  /// Copies the journal of a dead predecessor into this empty one. Leaves out data that is inconsistent.
  void take_over(std::span<const std::byte> left);

  /// The number of the next switch or refusal.
  std::uint32_t next() const noexcept { return pages_->last.load(std::memory_order_relaxed) + 1; }
  /// Records that the switch is under way; its number is next(). Requires: none is.
  void begin(const BegunSwitch& begun) noexcept;
  /// Replaces the record of the switch under way, except its number.
  void change(const BegunSwitch& begun) noexcept;
  std::optional<BegunSwitch> begun() const;
  /// Removes the switch under way, which was never announced: the next one gets its number.
  void forget() noexcept;
  /// Keeps a receipt. The switch of that number is no longer under way; if the number is next(), it is now used. False
  /// if there is no room: then only the present manager has the receipt.
  bool put(std::uint32_t number, std::string_view text) noexcept;
  /// Receipts that are not filed, in the order of put().
  std::vector<LineJournal::Line> unfiled() const { return lines().unfiled(); }
  LineJournal lines() const noexcept { return LineJournal(pages_->lines); }

 private:
  Pages* pages_;
};

}  // namespace chimera::manager
