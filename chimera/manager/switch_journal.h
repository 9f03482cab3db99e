// SPDX-License-Identifier: Apache-2.0
// What must not be forgotten of switches when the manager dies: which one is under way, who asked, and the receipts
// that are not on the disk yet. In the manager's own block; read by its successor. docs/formats/processes.md.
//
//   begin -> change... -> put                a switch that was begun
//   begin -> forget                          nobody was told of it
//   put                                      a request that was refused
//   put -> filed                             its receipt is on the disk
//
// Each is done by one store, the last one: who is killed in the middle has not done it.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "chimera/manager/asker.h"
#include "chimera/runtime/hosted/rtpu_block.h"
#include "chimera/runtime/switch/switch_orders.h"

namespace chimera::manager {

/// A switch that is under way. Plain value.
struct BegunSwitch : OrderedSwitch {
  Asker asked_by;      ///< kNone: a task or reaction did
  Asker cancelled_by;  ///< kNone: it was not
};

/// One writer. Context: setup; never blocks.
class SwitchJournal {
 public:
  struct Pages {
    std::atomic<std::uint32_t> last{0};   ///< number that was given out last
    std::atomic<std::uint64_t> begun{0};  ///< number of the switch under way, twice, and which of `slots` tells of it
    std::atomic<std::uint32_t> end{0};    ///< of `text`, which has an Entry before each receipt
    BegunSwitch slots[2];
    alignas(64) char text[128 << 10];
  };
  struct Entry {
    std::uint32_t number, length;
    std::atomic<std::uint32_t> is_filed;
  };
  struct Receipt {
    std::uint32_t number;
    std::string_view text;
  };
  static_assert(sizeof(Pages) <= kJournalBytes);

  /// Over the journal of a block that this process owns.
  explicit SwitchJournal(std::span<std::byte> bytes) noexcept;
  /// Into an empty one: what a dead predecessor left in its block. What does not fit together is left out.
  void take_over(std::span<const std::byte> left);

  /// The number of the next switch or refusal.
  std::uint32_t next() const noexcept { return pages_->last.load(std::memory_order_relaxed) + 1; }
  /// The switch is under way; its number is next(). Requires: none is.
  void begin(const BegunSwitch& begun) noexcept;
  /// Of the one that is under way, but for its number.
  void change(const BegunSwitch& begun) noexcept;
  std::optional<BegunSwitch> begun() const;
  /// Nobody was told of the one under way: the next one gets its number.
  void forget() noexcept;
  /// Keeps a receipt. The switch of that number is not under way any more; a number that is next() is given out.
  /// False: there is no room, and only the present manager knows it.
  bool put(std::uint32_t number, std::string_view text) noexcept;
  /// In the order in which they were put, but for those that are filed.
  std::vector<Receipt> unfiled() const;
  void filed(std::uint32_t number) noexcept;

 private:
  Entry& entry_at(std::uint32_t at) const noexcept;
  template <class Visit>
  void visit(Visit&& visit) const;

  Pages* pages_;
};

}  // namespace chimera::manager
