// SPDX-License-Identifier: Apache-2.0
// Moves the plan word and the turn word of a switch.
#include "chimera/runtime/plan/switch_agreement.h"

#include <algorithm>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

using Words = std::array<std::uint64_t, SwitchPage::kOrderWords>;

Words words_of(const SwitchOrder& order) noexcept {
  Words words{};
  words[0] = std::uint64_t{order.number} | std::uint64_t{order.members} << 16 | std::uint64_t{order.slow} << 32;
  words[1] = std::uint64_t{order.after} | std::uint64_t{order.constants} << 32;
  words[2] = static_cast<std::uint64_t>(order.until.count);
  words[3] = static_cast<std::uint64_t>(order.lead.count);
  std::copy(order.on.words.begin(), order.on.words.end(), words.begin() + 4);
  std::copy(order.target.words.begin(), order.target.words.end(), words.begin() + 4 + order.on.words.size());
  return words;
}

// FNV-1a over whole words: finds a torn or stray write, not an attacker.
std::uint64_t sum_of(const Words& words) noexcept {
  std::uint64_t sum = 0xcbf2'9ce4'8422'2325u;
  for (const std::uint64_t word : words) sum = (sum ^ word) * 0x0000'0100'0000'01b3u;
  return sum;
}

// Instants and lengths of time that may be added to each other: 73 years.
bool can_be_added(Nanoseconds time) noexcept { return time.count >= 0 && time.count <= INT64_MAX / 4; }

}  // namespace

std::optional<SwitchOrder> SwitchAgreement::order(const PlanWord& plan, std::size_t n_sets,
                                                  std::size_t n_tasks) const noexcept {
  Words words{};
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = page_->order[i].load(std::memory_order_relaxed);
  if (page_->order[words.size()].load(std::memory_order_relaxed) != sum_of(words)) return std::nullopt;
  SwitchOrder order;
  order.number = static_cast<std::uint16_t>(words[0]);
  order.members = static_cast<std::uint16_t>(words[0] >> 16);
  order.slow = static_cast<std::uint8_t>(words[0] >> 32);
  order.after = static_cast<std::uint32_t>(words[1]);
  order.constants = static_cast<std::uint32_t>(words[1] >> 32);
  order.until = {static_cast<std::int64_t>(words[2])};
  order.lead = {static_cast<std::int64_t>(words[3])};
  for (std::size_t i = 0; i < order.on.words.size(); ++i) {
    order.on.words[i] = words[4 + i];
    order.target.words[i] = words[4 + order.on.words.size() + i];
  }
  const bool is_sane = order.number == plan.number && order.number != 0 && order.members != 0 &&
                       (order.after < n_sets || order.after == UINT32_MAX) &&
                       (order.constants < n_sets || order.constants == UINT32_MAX) && words[0] >> 32 <= kSlowReasons;
  if (!is_sane || !can_be_added(order.until) || !can_be_added(order.lead)) return std::nullopt;
  if (!names_only(order.on, n_tasks) || !names_only(order.target, n_tasks)) return std::nullopt;
  return order;
}

std::optional<std::uint16_t> SwitchAgreement::run(std::uint16_t number) const noexcept {
  const TurnWord turn = TurnWord::of(page_->turn.load(std::memory_order_acquire));
  return turn.number == number ? std::optional(turn.run) : std::nullopt;
}

void SwitchAgreement::write(const SwitchOrder& order, const PlanWord& plan, std::uint16_t run) noexcept {
  const Words words = words_of(order);
  for (std::size_t i = 0; i < words.size(); ++i) page_->order[i].store(words[i], std::memory_order_relaxed);
  page_->order[words.size()].store(sum_of(words), std::memory_order_relaxed);
  page_->turn.store(TurnWord{order.number, run, order.members}.word(), std::memory_order_release);
  std::uint64_t before = page_->plan.load(std::memory_order_acquire);
  const std::uint64_t after = plan.word();
  while (!page_->plan.compare_exchange_weak(before, after, std::memory_order_acq_rel, std::memory_order_acquire)) {
  }
}

bool SwitchAgreement::hand_on(std::uint16_t number, std::uint16_t run) noexcept {
  return move_turn(number, run, static_cast<std::uint16_t>(run + 1));
}

bool SwitchAgreement::move_turn(std::uint16_t number, std::uint16_t from, std::uint16_t to) noexcept {
  std::uint64_t word = page_->turn.load(std::memory_order_acquire);
  for (;;) {
    TurnWord turn = TurnWord::of(word);
    if (turn.number != number || turn.run != from) return false;
    turn.run = to;
    if (page_->turn.compare_exchange_weak(word, turn.word(), std::memory_order_acq_rel, std::memory_order_acquire))
      return true;
  }
}

Nanoseconds SwitchAgreement::round_up(Nanoseconds instant) const noexcept {
  const std::int64_t since = (instant - origin_).count;
  const std::int64_t us = since <= 0 ? 0 : (since + 999) / 1000;
  return static_cast<std::uint64_t>(us) > PlanWord::kLatest ? kNever : origin_ + microseconds(us);
}

bool SwitchAgreement::propose(std::uint16_t number, Nanoseconds at) noexcept {
  const auto us = static_cast<std::uint64_t>((at - origin_).count / 1000);
  CHIMERA_ASSERT(at >= origin_ && us <= PlanWord::kLatest);
  return move(number, SwitchPhase::kPrepared, {number, SwitchPhase::kProposed, us});
}

bool SwitchAgreement::have_all_agreed(std::uint16_t number) const noexcept {
  const TurnWord turn = TurnWord::of(page_->turn.load(std::memory_order_acquire));
  return turn.number == number && turn.missing == 0;
}

bool SwitchAgreement::commit(std::uint16_t number, Nanoseconds at) noexcept {
  const auto us = static_cast<std::uint64_t>((at - origin_).count / 1000);
  CHIMERA_ASSERT(at >= origin_ && us <= PlanWord::kLatest);
  return move(number, SwitchPhase::kPrepared, {number, SwitchPhase::kCommitted, us});
}

bool SwitchAgreement::agree(std::uint16_t number, std::uint32_t context) noexcept {
  std::uint64_t word = page_->turn.load(std::memory_order_acquire);
  TurnWord turn;
  do {
    turn = TurnWord::of(word);
    if (turn.number != number) return false;
    turn.missing = static_cast<std::uint16_t>(turn.missing & ~(1u << context));
  } while (!page_->turn.compare_exchange_weak(word, turn.word(), std::memory_order_acq_rel, std::memory_order_acquire));
  if (turn.missing != 0) return false;
  const PlanWord now = plan();
  return move(number, SwitchPhase::kProposed, {number, SwitchPhase::kCommitted, now.at_us});
}

bool SwitchAgreement::abort(std::uint16_t number) noexcept {
  const PlanWord aborted{number, SwitchPhase::kAborted, 0};
  return move(number, SwitchPhase::kPrepared, aborted) || move(number, SwitchPhase::kProposed, aborted);
}

bool SwitchAgreement::move(std::uint16_t number, SwitchPhase from, PlanWord to) noexcept {
  std::uint64_t word = page_->plan.load(std::memory_order_acquire);
  for (;;) {
    const PlanWord now = PlanWord::of(word);
    if (now.number != number || now.phase != from) return false;
    if (page_->plan.compare_exchange_weak(word, to.word(), std::memory_order_acq_rel, std::memory_order_acquire))
      return true;
  }
}

}  // namespace chimera
