// SPDX-License-Identifier: Apache-2.0
// Replenishes and charges the capacity of deferrable and sporadic servers.
#include "chimera/schedule/server_state.h"

namespace chimera {

ServerState::ServerState(const ServerSpec& spec, Nanoseconds origin) noexcept
    : spec_(spec), left_(spec.capacity), end_(origin + spec.period) {
  CHIMERA_ASSERT(spec.capacity > Nanoseconds{} && spec.capacity <= spec.period);
  (void)pieces_.try_push({origin, spec.capacity});
}

void ServerState::activate(Nanoseconds now) noexcept {
  follow(now);
  if (is_deferrable()) return;
  while (pieces_.size() > 1 && pieces_[1].at <= now) {
    pieces_[1].amount += pieces_[0].amount;
    drop_first();
  }
  pieces_[0].at = std::max(pieces_[0].at, now);
}

void ServerState::follow(Nanoseconds now) noexcept {
  if (!is_deferrable() || now < end_) return;
  end_ += spec_.period * ((now - end_) / spec_.period + 1);
  left_ = std::min(left_, Nanoseconds{}) + spec_.capacity;
}

Nanoseconds ServerState::allowance(Nanoseconds now) const noexcept {
  if (is_deferrable()) return std::max(left_, Nanoseconds{});
  return pieces_[0].at <= now ? pieces_[0].amount : Nanoseconds{};
}

Nanoseconds ServerState::next_change(Nanoseconds now) const noexcept {
  if (is_deferrable()) return end_;
  return pieces_[0].at > now ? pieces_[0].at : kNever;
}

void ServerState::charge(Nanoseconds used) noexcept {
  if (is_deferrable()) {
    left_ -= used;
    return;
  }
  while (used > Nanoseconds{}) {
    Piece& first = pieces_[0];
    const Piece returned{first.at + spec_.period, std::min(used, first.amount)};
    used -= returned.amount;
    first.amount -= returned.amount;
    if (first.amount == Nanoseconds{}) drop_first();
    give_back(returned);
  }
}

Nanoseconds ServerState::deadline() const noexcept {
  return is_deferrable() ? end_ : pieces_[0].at + spec_.period;
}

Nanoseconds ServerState::total() const noexcept {
  if (is_deferrable()) return left_;
  Nanoseconds sum;
  for (const Piece& piece : pieces_) sum += piece.amount;
  return sum;
}

void ServerState::give_back(const Piece& piece) noexcept {
  if (!pieces_.empty()) {
    Piece& last = pieces_[pieces_.size() - 1];
    if (last.at == piece.at || pieces_.is_full()) {
      last.at = piece.at;
      last.amount += piece.amount;
      return;
    }
  }
  (void)pieces_.try_push(piece);
}

void ServerState::drop_first() noexcept {
  for (std::size_t i = 1; i < pieces_.size(); ++i) pieces_[i - 1] = pieces_[i];
  pieces_.pop_back();
}

}  // namespace chimera
