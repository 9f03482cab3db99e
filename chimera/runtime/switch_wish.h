// SPDX-License-Identifier: Apache-2.0
// The configuration that a task or a reaction of one context asked for last, as words that outlive whoever carries it
// out: a state, not a message. docs/formats/processes.md, docs/decisions/0057-requests-over-processes.md.
#pragma once

#include <atomic>
#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/runtime/switch_request.h"

namespace chimera {

/// SwitchWishWords::word: bits 0-15 number, 16-31 set, 32-47 the task that asked, 48-55 cause. Plain value.
struct SwitchWish {
  std::uint16_t number = 0;  ///< 0: nothing was asked for yet; another one than that of the wish before
  std::uint16_t set = 0;     ///< in ApplicationSpec::sets
  std::uint16_t by = 0;
  SwitchCause cause = SwitchCause::kRequest;

  constexpr bool is_there() const noexcept { return number != 0; }
  constexpr std::uint64_t word() const noexcept {
    return std::uint64_t{static_cast<std::uint8_t>(cause)} << 48 | std::uint64_t{by} << 32 | std::uint64_t{set} << 16 |
           number;
  }
  /// May be anything: `set`, `by` and `cause` are to be held against what there is.
  static constexpr SwitchWish of(std::uint64_t word) noexcept {
    return {static_cast<std::uint16_t>(word), static_cast<std::uint16_t>(word >> 16),
            static_cast<std::uint16_t>(word >> 32), static_cast<SwitchCause>(word >> 48 & 0xffu)};
  }
  /// The next wish: of a request by a task of this context.
  constexpr SwitchWish next(const SwitchRequest& request) const noexcept {
    const auto follows = static_cast<std::uint16_t>(number == UINT16_MAX ? 1 : number + 1);
    return {follows, static_cast<std::uint16_t>(request.set), static_cast<std::uint16_t>(request.by.index),
            request.cause};
  }
  constexpr bool operator==(const SwitchWish&) const noexcept = default;
};

/// Written by its context alone: `at` first, then `word` with release; loaded with acquire.
struct SwitchWishWords {
  std::atomic<std::uint64_t> word{0};
  std::atomic<std::int64_t> at{0};  ///< when it was asked for, on the clock of all; relaxed, published by `word`
};

/// What whoever carries wishes out remembers of one context: the wish that it has dealt with, and of which incarnation.
constexpr std::uint64_t wish_dealt_with(std::uint32_t incarnation, std::uint16_t number) noexcept {
  return std::uint64_t{incarnation} << 32 | number;
}

/// Does a context ask anew? The last request stands: one that changes nothing is dropped, unless it takes another one
/// back that nobody has dealt with.
constexpr bool is_new_wish(std::uint32_t set, bool changes_nothing, bool is_last_open,
                           std::uint32_t last_set) noexcept {
  return is_last_open ? set != last_set : !changes_nothing;
}

}  // namespace chimera
