// SPDX-License-Identifier: Apache-2.0
// Keeps the switch that is under way, and receipts until they are filed, in memory that outlives the manager.
#include "chimera/manager/state/switch_journal.h"

#include <algorithm>
#include <new>
#include <type_traits>

#include "chimera/base/assert.h"

namespace chimera::manager {
namespace {

static_assert(std::is_trivially_copyable_v<BegunSwitch>);
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

// The reader comes after the death of the writer and sees its last stores. The stores are ordered for this, and pair
// with nothing else.
constexpr auto kAfterAll = std::memory_order_release;
constexpr auto kRelaxed = std::memory_order_relaxed;

constexpr std::uint32_t number_of(std::uint64_t begun) noexcept { return static_cast<std::uint32_t>(begun / 2); }

}  // namespace

SwitchJournal::SwitchJournal(std::span<std::byte> bytes) noexcept {
  CHIMERA_ASSERT(bytes.size() >= sizeof(Pages));
  pages_ = std::launder(reinterpret_cast<Pages*>(bytes.data()));  // zeroed bytes are an empty journal
}

void SwitchJournal::take_over(std::span<const std::byte> left) {
  CHIMERA_ASSERT(left.size() >= sizeof(Pages));
  Pages& from = *std::launder(reinterpret_cast<Pages*>(const_cast<std::byte*>(left.data())));  // is only read
  const std::uint64_t begun = from.begun.load(kRelaxed);
  std::uint32_t last = std::max(from.last.load(kRelaxed), number_of(begun));
  bool is_over = begun == 0;
  for (const LineJournal::Line& line : LineJournal(from.lines).unfiled()) {
    const auto number = static_cast<std::uint32_t>(line.number);
    last = std::max(last, number);
    is_over = is_over || number == number_of(begun);
    (void)put(number, line.text);
  }
  if (!is_over) {
    pages_->slots[0] = from.slots[begun % 2];
    pages_->begun.store(std::uint64_t{number_of(begun)} * 2, kAfterAll);
  }
  pages_->last.store(last, kAfterAll);
}

void SwitchJournal::begin(const BegunSwitch& begun) noexcept {
  CHIMERA_ASSERT(pages_->begun.load(kRelaxed) == 0);
  const std::uint32_t number = next();
  pages_->slots[0] = begun;
  pages_->begun.store(std::uint64_t{number} * 2, kAfterAll);
  pages_->last.store(number, kAfterAll);
}

void SwitchJournal::change(const BegunSwitch& begun) noexcept {
  const std::uint64_t other = pages_->begun.load(kRelaxed) ^ 1;
  pages_->slots[other % 2] = begun;
  pages_->begun.store(other, kAfterAll);
}

std::optional<BegunSwitch> SwitchJournal::begun() const {
  const std::uint64_t begun = pages_->begun.load(kRelaxed);
  if (begun == 0) return std::nullopt;
  BegunSwitch found = pages_->slots[begun % 2];
  found.number = number_of(begun);
  return found;
}

void SwitchJournal::forget() noexcept {
  const std::uint32_t number = number_of(pages_->begun.load(kRelaxed));
  if (pages_->last.load(kRelaxed) == number) pages_->last.store(number - 1, kAfterAll);
  pages_->begun.store(0, kAfterAll);
}

bool SwitchJournal::put(std::uint32_t number, std::string_view text) noexcept {
  const bool fits = lines().put(number, text);
  if (number == next()) pages_->last.store(number, kAfterAll);
  if (number == number_of(pages_->begun.load(kRelaxed))) pages_->begun.store(0, kAfterAll);
  return fits;
}

}  // namespace chimera::manager
