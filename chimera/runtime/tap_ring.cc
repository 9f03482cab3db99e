// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/tap_ring.h"

#include <algorithm>
#include <type_traits>

#include "chimera/table/shared_copy.h"

namespace chimera {

namespace {

static_assert(std::is_trivially_copyable_v<TapRecord> && (kTapRecords & (kTapRecords - 1)) == 0);

constexpr std::uint64_t kWhole = kTapRecords - 2;  // so many behind the head are never being overwritten
constexpr int kTries = 4;

const std::byte* place(const TapRing& ring, std::uint64_t number) noexcept {
  return reinterpret_cast<const std::byte*>(&ring.records[number % kTapRecords]);
}

constexpr std::uint64_t oldest(std::uint64_t head) noexcept { return head > kWhole ? head - kWhole : 0; }

}  // namespace

void Tap::append(const TapRecord& record) noexcept {
  // SYNC: pairs with the fence in read(): whoever copies a byte of this record sees the head of before it.
  shared_copy::release_fence();
  shared_copy::copy_in(reinterpret_cast<std::byte*>(&ring_->records[head_ % kTapRecords]), &record, sizeof record);
  // SYNC: pairs with the acquire in read(): the record is whole before it is counted.
  ring_->head.store(++head_, std::memory_order_release);
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
    for (std::size_t k = 0; k < n; ++k) shared_copy::copy_out(&out[k], place(*ring_, begin + k), sizeof(TapRecord));
    shared_copy::acquire_fence();
    head = ring_->head.load(std::memory_order_acquire);
    const std::uint64_t end = begin + n;
    const std::uint64_t valid = std::clamp(oldest(head), begin, end);  // before it: perhaps overwritten meanwhile
    lost_ += valid - next_;
    next_ = end;
    std::copy(out.begin() + static_cast<std::ptrdiff_t>(valid - begin), out.begin() + static_cast<std::ptrdiff_t>(n),
              out.begin());
    if (valid < end || n == 0) return static_cast<std::size_t>(end - valid);
  }
  return 0;
}

}  // namespace chimera
