// SPDX-License-Identifier: Apache-2.0
// How long a server may run, when capacity comes back, and by when it is due. Pure bookkeeping; whoever owns it runs
// the job.
//
//   deferrable  full at every multiple of its period from the origin on, due at the end of the period
//   sporadic    a queue of pieces of capacity, each with the instant from which it may be used. Used is the first one,
//               due one period after that instant, and what was used of it joins the end of the queue for then. One
//               that becomes active counts whatever is there as there from now on; a piece that comes back while it is
//               active keeps its own instant. So every piece is a periodic task that at worst comes late.
//
// Sprunt, Sha & Lehoczky 1989 let a server count as active from when jobs above its rank began; here it is active only
// while an event waits or is served, which never brings capacity back sooner. What was used is returned to the piece
// it came from, as Stanovich, Baker, Wang & Harbour (RTAS 2010) ask: one sum for all of them can come back too soon.
#pragma once

#include <algorithm>
#include <cstdint>

#include "chimera/base/assert.h"
#include "chimera/base/fixed.h"
#include "chimera/base/time.h"
#include "chimera/task/server_spec.h"

namespace chimera {

/// The capacity of one server. Context: cycle; wait-free; no allocation.
class ServerState {
 public:
  /// Pieces of capacity kept apart; when there are more, the last two come back together, at the later instant.
  static constexpr std::size_t kPieces = 16;

  ServerState() noexcept = default;
  /// Full at `origin`. Requires: 0 < capacity <= period.
  ServerState(const ServerSpec& spec, Nanoseconds origin) noexcept;

  /// An event waits, and none did.
  void activate(Nanoseconds now) noexcept;
  /// Deferrable: begins the period that `now` lies in. To be called when next_change() has come.
  void follow(Nanoseconds now) noexcept;
  /// How long it may run from now on; 0: not before next_change(). Requires: active, follow(now) was called.
  Nanoseconds allowance(Nanoseconds now) const noexcept;
  /// When allowance or deadline change by themselves; kNever: not before something is charged.
  Nanoseconds next_change(Nanoseconds now) const noexcept;
  /// It ran for so long. More than was allowed is made up for by capacity to come.
  void charge(Nanoseconds used) noexcept;
  /// Of what it runs on now, or runs on next.
  Nanoseconds deadline() const noexcept;

  /// Capacity that is there or will come back: always the whole. Deferrable: what is left in this period.
  Nanoseconds total() const noexcept;

 private:
  struct Piece {
    Nanoseconds at;  ///< from when on it may be used
    Nanoseconds amount;
  };
  bool is_deferrable() const noexcept { return spec_.kind == ServerKind::kDeferrable; }
  void give_back(const Piece& piece) noexcept;
  void drop_first() noexcept;

  ServerSpec spec_;
  Nanoseconds left_, end_;              // deferrable: of this period; left_ below 0: was exceeded
  FixedVector<Piece, kPieces> pieces_;  // sporadic: ascending by instant
};

}  // namespace chimera
