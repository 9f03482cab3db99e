// SPDX-License-Identifier: Apache-2.0
// Reads the progress of other rtpus in a switch, and publishes the progress of this one.
#include "chimera/rtpu/switch_links.h"

namespace chimera {

std::uint16_t SwitchLinks::living() const noexcept {
  std::uint32_t living = 1u << me_;
  for (std::uint32_t rtpu = 0; rtpu < others_.manager(); ++rtpu)
    if (rtpu != me_ && others_.at(rtpu) != nullptr) living |= 1u << rtpu;
  return static_cast<std::uint16_t>(living);
}

const SwitchProgress* SwitchLinks::progress(std::uint32_t context) const noexcept {
  const PeerSegment* there = others_.at(context);
  return there == nullptr ? nullptr : &there->block().head().switching;
}

void SwitchLinks::tell_adopted(std::uint16_t number) noexcept {
  if (others_.keeps_last_words()) return;
  others_.publish(tasks_);
  others_.block().head().switching.adopted.store(number, std::memory_order_release);  // SwitchProgress
  others_.ring_all();
}

void SwitchLinks::tell_over(const SwitchReceipt& receipt) noexcept {
  if (others_.keeps_last_words()) return;
  const auto is_mine = [this](TaskId task) { return tasks_.is_mine(task); };
  write_part(receipt, is_mine, others_.block().switch_part());
  others_.publish(tasks_);
  SwitchProgress& progress = others_.block().head().switching;
  progress.adopted.store(receipt.number, std::memory_order_release);  // SwitchProgress
  progress.over.store(receipt.number, std::memory_order_release);
  others_.ring_all();
}

// Publishes the states first, so that the manager's log and receipts follow the changes that they name.
void SwitchLinks::tell_takeover(const Takeover& takeover) noexcept {
  if (others_.keeps_last_words()) return;
  others_.publish(tasks_);
  others_.block().takeovers().put(takeover);
  if (takeover.ended != kNever) others_.ring_all();
}

// True if a manager has handled the request. This stays true after its death, because its successor takes the words
// over.
bool SwitchLinks::was_dealt_with(const BlockHead& head, std::uint32_t rtpu, std::uint16_t wish) const noexcept {
  const PeerSegment* const manager = mapped_.at(others_.manager());
  if (manager == nullptr) return false;
  const std::uint64_t dealt = manager->block().memory().wishes[rtpu].load(std::memory_order_relaxed);
  return dealt == wish_dealt_with(head.incarnation, wish);
}

bool SwitchLinks::is_wish_open() const noexcept {
  for (std::uint32_t rtpu = 0; rtpu < others_.manager(); ++rtpu) {
    const PeerSegment* const there = rtpu == me_ ? nullptr : others_.at(rtpu);
    if (rtpu != me_ && there == nullptr) continue;
    const BlockHead& head = rtpu == me_ ? others_.block().head() : there->block().head();
    const SwitchWish last = head.wish.wish();
    if (last.is_there() && !was_dealt_with(head, rtpu, last.number)) return true;
  }
  return false;
}

// Publishes a request for a switch, after the states that led to it.
void SwitchLinks::wish(const SwitchRequest& request, bool changes_nothing, Nanoseconds now) noexcept {
  if (others_.keeps_last_words()) return;
  BlockHead& head = others_.block().head();
  const OpenWish last = head.wish.read();  // only this thread writes it
  const bool is_open = last.wish.is_there() && !was_dealt_with(head, me_, last.wish.number);
  if (!is_new_wish(request.is_for(last.request()), changes_nothing, is_open)) return;
  others_.publish(tasks_);
  head.wish.write(last.wish.next(request), request.lists, now);
  others_.ring_all();
}

}  // namespace chimera
