// SPDX-License-Identifier: Apache-2.0
// Keeps the switch that is under way, and receipts until they are filed, in memory that outlives the manager.
#include "chimera/manager/state/switch_journal.h"

#include <algorithm>
#include <cstring>
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

constexpr std::uint32_t bytes_of(std::uint32_t length) noexcept {
  return (static_cast<std::uint32_t>(sizeof(SwitchJournal::Entry)) + length + 3) / 4 * 4;
}

constexpr std::uint32_t number_of(std::uint64_t begun) noexcept { return static_cast<std::uint32_t>(begun / 2); }

}  // namespace

SwitchJournal::SwitchJournal(std::span<std::byte> bytes) noexcept {
  CHIMERA_ASSERT(bytes.size() >= sizeof(Pages));
  pages_ = std::launder(reinterpret_cast<Pages*>(bytes.data()));  // zeroed bytes are an empty journal
}

SwitchJournal::Entry& SwitchJournal::entry_at(std::uint32_t at) const noexcept {
  return *reinterpret_cast<Entry*>(pages_->text + at);
}

/// Calls `visit` for each entry inside the text; stops at damaged entries.
template <class Visit>
void SwitchJournal::visit(Visit&& visit) const {
  const std::uint32_t end = std::min<std::uint32_t>(pages_->end.load(kRelaxed), sizeof pages_->text);
  for (std::uint32_t at = 0; at + sizeof(Entry) <= end;) {
    Entry& entry = entry_at(at);
    if (entry.length > end - at - sizeof(Entry)) return;
    visit(entry, std::string_view(pages_->text + at + sizeof(Entry), entry.length));
    at += bytes_of(entry.length);
  }
}

void SwitchJournal::take_over(std::span<const std::byte> left) {
  CHIMERA_ASSERT(left.size() >= sizeof(Pages));
  Pages& from = *std::launder(reinterpret_cast<Pages*>(const_cast<std::byte*>(left.data())));  // is only read
  SwitchJournal before(*this);
  before.pages_ = &from;
  const std::uint64_t begun = from.begun.load(kRelaxed);
  std::uint32_t last = std::max(from.last.load(kRelaxed), number_of(begun));
  bool is_over = begun == 0;
  before.visit([&](const Entry& entry, std::string_view text) {
    last = std::max(last, entry.number);
    is_over = is_over || entry.number == number_of(begun);
    if (entry.is_filed.load(kRelaxed) == 0) (void)put(entry.number, text);
  });
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
  const std::uint32_t at = pages_->end.load(kRelaxed);
  const bool fits = text.size() <= sizeof pages_->text - sizeof(Entry) &&
                    bytes_of(static_cast<std::uint32_t>(text.size())) <= sizeof pages_->text - at;
  if (fits) {
    const auto length = static_cast<std::uint32_t>(text.size());
    ::new (pages_->text + at) Entry{number, length, {0}};
    std::memcpy(pages_->text + at + sizeof(Entry), text.data(), length);
    pages_->end.store(at + bytes_of(length), kAfterAll);
  }
  if (number == next()) pages_->last.store(number, kAfterAll);
  if (number == number_of(pages_->begun.load(kRelaxed))) pages_->begun.store(0, kAfterAll);
  return fits;
}

std::vector<SwitchJournal::Receipt> SwitchJournal::unfiled() const {
  std::vector<Receipt> found;
  visit([&](const Entry& entry, std::string_view text) {
    if (entry.is_filed.load(kRelaxed) == 0) found.push_back({entry.number, text});
  });
  return found;
}

void SwitchJournal::filed(std::uint32_t number) noexcept {
  bool are_all = true;
  visit([&](Entry& entry, std::string_view) {
    if (entry.number == number) entry.is_filed.store(1, kAfterAll);
    are_all = are_all && entry.is_filed.load(kRelaxed) != 0;
  });
  if (are_all) pages_->end.store(0, kAfterAll);
}

}  // namespace chimera::manager
