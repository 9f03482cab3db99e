// SPDX-License-Identifier: Apache-2.0
// Takes up what tasks ask for, one switch at a time.
#include "chimera/manager/switch_wishes.h"

#include "chimera/control/switch_reason.h"

namespace chimera::manager {
namespace {

// As where one context carries its switches out itself.
constexpr Nanoseconds kPatience = seconds(10);

// A word says anything when its unit has died or writes where it should not.
bool is_in_range(const SwitchWish& wish, RtpuId rtpu, const ApplicationSpec& spec) {
  return wish.is_there() && wish.set < spec.sets.size() && wish.by < spec.tasks.size() &&
         spec.tasks[wish.by].rtpu == rtpu && wish.cause > SwitchCause::kScript && wish.cause <= SwitchCause::kFault;
}

}  // namespace

// Also of a unit that is dead: what it asked for is to come about all the more.
std::optional<SwitchWishes::Open> SwitchWishes::read(RtpuId rtpu) const noexcept {
  if (!world_.peers[rtpu].is_there()) return std::nullopt;
  const BlockHead& head = world_.peers[rtpu].block().head();
  const SwitchWish wish = SwitchWish::of(head.wish.word.load(std::memory_order_acquire));  // SwitchWishWords
  const std::uint64_t dealt = world_.own.block().memory().wishes[rtpu.index].load(std::memory_order_relaxed);
  if (!is_in_range(wish, rtpu, world_.spec()) || dealt == wish_dealt_with(head.incarnation, wish.number))
    return std::nullopt;
  return Open{rtpu, head.incarnation, wish, Nanoseconds{head.wish.at.load(std::memory_order_relaxed)}};
}

const SwitchWishes::Open* SwitchWishes::find_last() {
  const Open* last = nullptr;
  for (std::optional<Open>& seen : seen_) {
    const RtpuId rtpu(static_cast<std::size_t>(&seen - seen_.data()));
    if (const auto now = read(rtpu)) seen = now;
    if (seen && (last == nullptr || seen->at >= last->at)) last = &*seen;
  }
  return last;
}

void SwitchWishes::deal_with_all() noexcept {
  for (std::optional<Open>& seen : seen_) {
    if (!seen) continue;
    const std::uint64_t dealt = wish_dealt_with(seen->incarnation, seen->wish.number);
    world_.own.block().memory().wishes[seen->rtpu.index].store(dealt, std::memory_order_relaxed);
    seen.reset();
  }
}

void SwitchWishes::look(Nanoseconds now) {
  if (world_.is_ending()) return;
  const Open* const last = find_last();
  if (last == nullptr) return;
  const bool is_coming = switches_.leads_to(last->wish.set);
  if (!is_coming && (!switches_.is_free() || !world_.logic.is_settled())) return;
  if (!is_coming) ask(*last, now);
  deal_with_all();  // only now: a manager that dies in between leaves the wish to its successor
}

void SwitchWishes::ask(const Open& open, Nanoseconds now) {
  const SwitchRequest request{open.wish.set, open.wish.cause, TaskId(std::uint32_t{open.wish.by})};
  const std::string by = control::asked_by(request, world_.spec());
  switches_.ask(request, Asker{}, kPatience, now, [this, by](const SwitchOutcome& outcome) {
    if (outcome.receipt.end != SwitchEnd::kRefused) return;
    const std::string to(world_.spec().sets[outcome.receipt.after].name);
    world_.tell("switch", TaskId{}, RtpuId{},
                "switch to '" + to + "', asked for by " + by +
                    ", is refused: " + control::reason_text(outcome.receipt, world_.spec()),
                outcome.receipt.asked);
  });
}

}  // namespace chimera::manager
