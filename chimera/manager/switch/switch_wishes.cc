// SPDX-License-Identifier: Apache-2.0
// Carries out the requests of tasks, one switch at a time.
#include "chimera/manager/switch/switch_wishes.h"

#include "chimera/control/receipt/switch_reason.h"
#include "chimera/runtime/hosted/asked_set.h"

namespace chimera::manager {
namespace {

// Checks the words: a dead or faulty rtpu may have left any value.
bool is_in_range(const OpenWish& open, RtpuId rtpu, const ApplicationSpec& spec) {
  const SwitchWish& wish = open.wish;
  const bool is_set = wish.set < spec.sets.size();
  const bool is_lists = wish.set == SwitchWish::kLists && open.lists.are_there() &&
                        names_only(open.lists.plus, spec.tasks.size()) &&
                        names_only(open.lists.minus, spec.tasks.size());
  return wish.is_there() && (is_set || is_lists) && wish.by < spec.tasks.size() && spec.tasks[wish.by].rtpu == rtpu &&
         wish.cause > SwitchCause::kScript && wish.cause <= SwitchCause::kFault;
}

}  // namespace

// The open request of an rtpu, even of a dead one: its request is then all the more important.
std::optional<SwitchWishes::Open> SwitchWishes::read(RtpuId rtpu) const noexcept {
  if (!state_.peers[rtpu].is_there()) return std::nullopt;
  const BlockHead& head = state_.peers[rtpu].block().head();
  const OpenWish open = head.wish.read();
  const std::uint64_t dealt = state_.own.block().memory().wishes[rtpu.index].load(std::memory_order_relaxed);
  if (!is_in_range(open, rtpu, state_.spec()) || dealt == wish_dealt_with(head.incarnation, open.wish.number))
    return std::nullopt;
  return Open{rtpu, head.incarnation, open};
}

const SwitchWishes::Open* SwitchWishes::find_last() {
  const Open* last = nullptr;
  for (std::optional<Open>& seen : seen_) {
    const RtpuId rtpu(static_cast<std::size_t>(&seen - seen_.data()));
    if (const auto now = read(rtpu)) seen = now;
    if (seen && (last == nullptr || seen->wish.at >= last->wish.at)) last = &*seen;
  }
  return last;
}

void SwitchWishes::deal_with_all() noexcept {
  for (std::optional<Open>& seen : seen_) {
    if (!seen) continue;
    const std::uint64_t dealt = wish_dealt_with(seen->incarnation, seen->wish.wish.number);
    state_.own.block().memory().wishes[seen->rtpu.index].store(dealt, std::memory_order_relaxed);
    seen.reset();
  }
}

void SwitchWishes::look(Nanoseconds now) {
  if (state_.is_ending()) return;
  const Open* const last = find_last();
  if (last == nullptr) return;
  const SwitchRequest request = last->wish.request();
  const bool is_coming = switches_.leads_to(request);
  if (!is_coming && (!switches_.is_free() || !state_.logic.is_settled())) return;
  if (!is_coming) ask(request, now);
  deal_with_all();  // last, so that a successor finds the request if this manager dies before
}

void SwitchWishes::ask(SwitchRequest request, Nanoseconds now) {
  const ApplicationSpec& spec = state_.spec();
  const std::string by = control::asked_by(request, spec);
  TaskBits target = request.lists.are_there() ? TaskBits() : tasks_of(spec, request.set);
  if (request.lists.are_there()) {
    const AskedSet asked = asked_set(spec, state_.tasks_on(), request.lists);
    if (!asked) return tell_refused(lists_text(request.lists, spec), by, asked.text(), now);
    target = asked.tasks;
    request.set = set_of(spec, target);
  }
  switches_.ask(request, target, Asker{}, kSwitchPatience, now, [this, by](const SwitchOutcome& outcome) {
    const SwitchReceipt& receipt = outcome.receipt;
    if (receipt.end == SwitchEnd::kRefused)
      tell_refused("to " + control::set_text(receipt.after, state_.spec()), by,
                   control::reason_text(receipt, state_.spec()), receipt.asked);
  });
}

void SwitchWishes::tell_refused(const std::string& what, const std::string& by, const std::string& why,
                                Nanoseconds at) {
  state_.tell("switch", TaskId{}, RtpuId{}, "switch " + what + ", asked for by " + by + ", is refused: " + why, at);
}

}  // namespace chimera::manager
