// SPDX-License-Identifier: Apache-2.0
// The configuration that a task or a reaction of one context asked for last. The words are a state, not a message, and
// outlive the process that carries the request out. docs/formats/processes.md, docs/design/switch.md.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/runtime/plan/switch_request.h"

namespace chimera {

/// SwitchWishWords::word: bits 0-15 number, 16-31 set, 32-47 the task that asked, 48-55 cause. Plain value.
struct SwitchWish {
  static constexpr std::uint16_t kLists = UINT16_MAX;
  std::uint16_t number = 0;  ///< 0: no request yet; differs from the number of the request before
  std::uint16_t set = 0;     ///< in ApplicationSpec::sets, or kLists
  std::uint16_t by = 0;
  SwitchCause cause = SwitchCause::kRequest;

  constexpr bool is_there() const noexcept { return number != 0; }
  constexpr std::uint64_t word() const noexcept {
    return std::uint64_t{static_cast<std::uint8_t>(cause)} << 48 | std::uint64_t{by} << 32 | std::uint64_t{set} << 16 |
           number;
  }
  /// The word may hold anything: check `set`, `by` and `cause` before use.
  static constexpr SwitchWish of(std::uint64_t word) noexcept {
    return {static_cast<std::uint16_t>(word), static_cast<std::uint16_t>(word >> 16),
            static_cast<std::uint16_t>(word >> 32), static_cast<SwitchCause>(word >> 48 & 0xffu)};
  }
  /// The next value of the word, for a request by a task of this context.
  constexpr SwitchWish next(const SwitchRequest& request) const noexcept {
    const auto follows = static_cast<std::uint16_t>(number == UINT16_MAX ? 1 : number + 1);
    return {follows, static_cast<std::uint16_t>(request.set), static_cast<std::uint16_t>(request.by.index),
            request.cause};
  }
  constexpr bool operator==(const SwitchWish&) const noexcept = default;
};

/// A request as it is read: whole.
struct OpenWish {
  SwitchWish wish;
  Nanoseconds at;    ///< when it was asked for, on the clock of all
  TaskLists lists;   ///< where `wish.set` is kLists

  SwitchRequest request() const noexcept {
    const bool has_lists = wish.set == SwitchWish::kLists;
    return {has_lists ? UINT32_MAX : wish.set, wish.cause, TaskId(std::uint32_t{wish.by}),
            has_lists ? lists : TaskLists()};
  }
};

/// Only its context writes it. `word` is 0 while the others are written, and is written last, with release. A reader
/// that loads a new value of the others, with acquire, sees by `word` that a write has begun: `word` is 0 or differs.
class SwitchWishWords {
 public:
  /// Context: any process; wait-free. Of a context that has died anywhere, too: then maybe none is there.
  SwitchWish wish() const noexcept { return SwitchWish::of(word_.load(std::memory_order_acquire)); }
  /// Reads all words; returns no request while they are written. Context: any process; wait-free.
  OpenWish read() const noexcept {
    OpenWish read{wish(), Nanoseconds{at_.load(std::memory_order_acquire)}, {}};
    for (std::size_t i = 0; i < kWords; ++i) {
      read.lists.plus.words[i] = lists_[i].load(std::memory_order_acquire);
      read.lists.minus.words[i] = lists_[kWords + i].load(std::memory_order_acquire);
    }
    if (word_.load(std::memory_order_relaxed) != read.wish.word()) read.wish = {};
    return read;
  }
  /// Context: its own; wait-free.
  void write(const SwitchWish& next, const TaskLists& lists, Nanoseconds at) noexcept {
    word_.store(0, std::memory_order_relaxed);
    at_.store(at.count, std::memory_order_release);
    for (std::size_t i = 0; i < kWords; ++i) {
      lists_[i].store(lists.plus.words[i], std::memory_order_release);
      lists_[kWords + i].store(lists.minus.words[i], std::memory_order_release);
    }
    word_.store(next.word(), std::memory_order_release);
  }

 private:
  static constexpr std::size_t kWords = kMaxSwitchedTasks / 64;
  std::atomic<std::uint64_t> word_{0};
  std::atomic<std::int64_t> at_{0};
  std::atomic<std::uint64_t> lists_[2 * kWords] = {};
};

/// Memory of the process that carries requests out, for one context: the last request dealt with, and its incarnation.
constexpr std::uint64_t wish_dealt_with(std::uint32_t incarnation, std::uint16_t number) noexcept {
  return std::uint64_t{incarnation} << 32 | number;
}

/// True if a request is new. The last request stands: one that changes nothing is dropped, unless it replaces a
/// different one that has not been dealt with yet.
constexpr bool is_new_wish(bool is_for_the_same, bool changes_nothing, bool is_last_open) noexcept {
  return is_last_open ? !is_for_the_same : !changes_nothing;
}

}  // namespace chimera
