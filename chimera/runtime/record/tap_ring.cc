// SPDX-License-Identifier: Apache-2.0
// Appends records to the ring of the tap, and reads them with a count of those that were lost.
#include "chimera/runtime/record/tap_ring.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

#include "chimera/table/shared_copy.h"

namespace chimera {

namespace {

static_assert(std::is_trivially_copyable_v<TapRecord> && (kTapRecords & (kTapRecords - 1)) == 0);

constexpr std::uint64_t kWhole = kTapRecords - 2;  // this many records behind the head are never being overwritten
constexpr int kTries = 4;

const std::byte* place(const TapRing& ring, std::uint64_t number) noexcept {
  return reinterpret_cast<const std::byte*>(&ring.records[number % kTapRecords]);
}

using Words = std::array<std::uint64_t, sizeof(TapRecord) / 8>;

constexpr auto kStore = CHIMERA_WORDWISE_COPY ? std::memory_order_release : std::memory_order_relaxed;
constexpr auto kLoad = CHIMERA_WORDWISE_COPY ? std::memory_order_acquire : std::memory_order_relaxed;

void load(TapRecord& record, const std::byte* from) noexcept {
  Words words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = shared_copy::word(from + 8 * i).load(kLoad);
  std::memcpy(static_cast<void*>(&record), words.data(), sizeof record);
}

constexpr std::uint64_t oldest(std::uint64_t head) noexcept { return head > kWhole ? head - kWhole : 0; }

}  // namespace

// Word by word in both builds: four moves out of registers, where a copy would be a call.
inline void Tap::append(std::uint64_t at, std::uint64_t b, std::uint64_t a_and_task, std::uint64_t rest) noexcept {
  // SYNC: pairs with the fence in read(): a reader that copies a byte of this record sees the head of before it.
  shared_copy::release_fence();
  std::byte* to = reinterpret_cast<std::byte*>(&ring_->records[head_ % kTapRecords]);
  shared_copy::word(to).store(at, kStore);
  shared_copy::word(to + 8).store(b, kStore);
  shared_copy::word(to + 16).store(a_and_task, kStore);
  shared_copy::word(to + 24).store(rest, kStore);
  // SYNC: pairs with the acquire in read(): the record is whole before it is counted.
  ring_->head.store(++head_, std::memory_order_release);
}

void Tap::append(const TapRecord& record) noexcept {
  const auto words = std::bit_cast<Words>(record);
  append(words[0], words[1], words[2], words[3]);
}

void Tap::append_row(const chimera_slot& slot, std::uint32_t payload_bytes, TaskId task, std::uint8_t rtpu,
                     std::uint32_t row) noexcept {
  const std::uint32_t n = payload_bytes / 8;
  const auto at = static_cast<std::uint64_t>(slot.published_ns);
  const std::uint64_t of_task = std::uint64_t{task.index} << 32;
  const std::uint64_t rest = std::uint64_t{row} << 32 | std::uint64_t{rtpu} << 8;
  append(at, slot.sequence, of_task | n, rest | static_cast<std::uint64_t>(TapKind::kGroup));
  const auto* payload = reinterpret_cast<const std::byte*>(&slot + 1);
  for (std::uint32_t i = 0; i < n; ++i) {
    std::uint64_t value;
    std::memcpy(&value, payload + 8 * i, sizeof value);
    append(at, value, of_task | i, rest | static_cast<std::uint64_t>(TapKind::kValue));
  }
}

TapReader::TapReader(const TapRing& ring, bool from_oldest) noexcept : ring_(&ring) {
  const std::uint64_t head = ring.head.load(std::memory_order_acquire);
  next_ = from_oldest ? oldest(head) : head;
}

std::size_t TapReader::read(std::span<TapRecord> out) noexcept {
  if (ring_ == nullptr) return 0;
  std::uint64_t head = ring_->head.load(std::memory_order_acquire);
  for (int i = 0; i < kTries; ++i) {
    if (head < next_) next_ = head;  // no writer counts back: begin again with what it will write next
    const std::uint64_t begin = std::max(next_, oldest(head));
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(head - begin, out.size()));
    for (std::size_t k = 0; k < n; ++k) load(out[k], place(*ring_, begin + k));
    shared_copy::acquire_fence();
    head = ring_->head.load(std::memory_order_acquire);
    const std::uint64_t end = begin + n;
    const std::uint64_t valid = std::clamp(oldest(head), begin, end);  // records before it may be overwritten
    lost_ += valid - next_;
    next_ = end;
    std::copy(out.begin() + static_cast<std::ptrdiff_t>(valid - begin), out.begin() + static_cast<std::ptrdiff_t>(n),
              out.begin());
    if (valid < end || n == 0) return static_cast<std::size_t>(end - valid);
  }
  return 0;
}

}  // namespace chimera
