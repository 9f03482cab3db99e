// SPDX-License-Identifier: Apache-2.0
// Keeps lines one behind the other in a ring. No line wraps: an entry without a line fills the end of the ring.
#include "chimera/manager/state/line_journal.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "chimera/base/assert.h"

namespace chimera::manager {
namespace {

// The reader comes after the death of the writer and sees its last stores. The stores are ordered for this, and pair
// with nothing else.
constexpr auto kInOrder = std::memory_order_release;
constexpr auto kAnyOrder = std::memory_order_relaxed;

constexpr std::uint64_t entry_bytes(std::uint64_t length) noexcept {
  return (sizeof(LineJournal::Entry) + length + sizeof(LineJournal::Entry) - 1) / sizeof(LineJournal::Entry) *
         sizeof(LineJournal::Entry);
}

}  // namespace

LineJournal::LineJournal(std::span<std::byte> bytes) noexcept
    : head_(std::launder(reinterpret_cast<Head*>(bytes.data()))),
      text_(reinterpret_cast<char*>(bytes.data()) + kHeadBytes),
      size_(bytes.size() - kHeadBytes) {
  CHIMERA_ASSERT(bytes.size() > kHeadBytes && bytes.size() % kHeadBytes == 0);
}

/// Calls `visit` with each entry, its line, and the position after it; stops at a damaged entry.
template <class Visit>
void LineJournal::visit(Visit&& visit) const {
  const std::uint64_t end = head_->end.load(kAnyOrder);
  std::uint64_t at = head_->begin.load(kAnyOrder);
  if (at % sizeof(Entry) != 0 || end - at > size_) return;
  while (at != end) {
    const std::uint64_t place = at % size_;
    Entry& entry = *reinterpret_cast<Entry*>(text_ + place);
    const std::uint64_t step = entry_bytes(entry.length);
    if (step > end - at || step > size_ - place) return;
    at += step;
    visit(entry, std::string_view(text_ + place + sizeof(Entry), entry.length), at);
  }
}

std::uint64_t LineJournal::take_over(std::span<const std::byte> left) {
  const LineJournal before({const_cast<std::byte*>(left.data()), left.size()});  // is only read
  std::uint64_t last = 0;
  for (const Line& line : before.unfiled()) {
    (void)put(line.number, line.text);
    last = std::max(last, line.number);
  }
  return last;
}

void LineJournal::write(std::uint64_t at, const Entry& entry, std::string_view text) noexcept {
  char* const place = text_ + at % size_;
  ::new (place) Entry{entry.number, entry.length, {entry.is_filed.load(kAnyOrder)}};
  std::copy(text.begin(), text.end(), place + sizeof(Entry));
}

bool LineJournal::put(std::uint64_t number, std::string_view text) noexcept {
  if (text.size() > size_) return false;
  std::uint64_t at = head_->end.load(kAnyOrder);
  const std::uint64_t needed = entry_bytes(text.size()), rest = size_ - at % size_, gap = needed > rest ? rest : 0;
  const bool is_empty = head_->begin.load(kAnyOrder) == at;
  if (needed > size_ || (!is_empty && at - head_->begin.load(kAnyOrder) + gap + needed > size_)) return false;
  if (gap > 0 && is_empty) head_->begin.store(at + gap, kInOrder);  // empty as before: `end` lies below it
  else if (gap > 0) write(at, {0, static_cast<std::uint32_t>(gap - sizeof(Entry)), {1}}, {});
  at += gap;
  write(at, {number, static_cast<std::uint32_t>(text.size()), {0}}, text);
  head_->end.store(at + needed, kInOrder);
  return true;
}

std::vector<LineJournal::Line> LineJournal::unfiled() const {
  std::vector<Line> found;
  visit([&](const Entry& entry, std::string_view text, std::uint64_t) {
    if (entry.is_filed.load(kAnyOrder) == 0) found.push_back({entry.number, text});
  });
  return found;
}

void LineJournal::filed(std::uint64_t number) noexcept {
  std::uint64_t begin = head_->begin.load(kAnyOrder);
  bool are_all = true;
  visit([&](Entry& entry, std::string_view, std::uint64_t after) {
    if (entry.number == number) entry.is_filed.store(1, kInOrder);
    are_all = are_all && entry.is_filed.load(kAnyOrder) != 0;
    if (are_all) begin = after;
  });
  head_->begin.store(begin, kInOrder);
}

}  // namespace chimera::manager
