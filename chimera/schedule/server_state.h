// SPDX-License-Identifier: Apache-2.0
// Computes how long a server may run, when its capacity returns, and its deadline. Pure bookkeeping: the executor that
// owns it runs the job.
//
//   deferrable  full at every multiple of its period from the origin on, due at the end of the period
//   sporadic    a queue of pieces of capacity, each with the instant from which it may be used. The server uses the
//               first piece, due one period after that instant. Used capacity joins the end of the queue with that due
//               time. When the server becomes active, all available capacity counts as available from now on. A piece
//               that returns while the server is active keeps its own instant. So every piece is a periodic task that
//               at worst comes late.
//
// Sprunt, Sha & Lehoczky 1989 count a server as active while jobs above its rank run. Here it is active only while an
// event waits or is served, which never returns capacity sooner. Used capacity returns to its own piece, as Stanovich,
// Baker, Wang & Harbour (RTAS 2010) require: one sum for all pieces can return too soon.
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
  /// Maximum number of separate pieces. Beyond it, the last two return together, at the later instant.
  static constexpr std::size_t kPieces = 16;

  ServerState() noexcept = default;
  /// Full at `origin`. Requires: 0 < capacity <= period.
  ServerState(const ServerSpec& spec, Nanoseconds origin) noexcept;

  /// Marks the server active: an event waits, and none waited before.
  void activate(Nanoseconds now) noexcept;
  /// Deferrable: begins the period that contains `now`. Call it when next_change() has come.
  void follow(Nanoseconds now) noexcept;
  /// The time that the server may run from now on; 0: not before next_change(). Requires: active, follow(now) was
  /// called.
  Nanoseconds allowance(Nanoseconds now) const noexcept;
  /// The next instant at which allowance or deadline change without a charge; kNever: none.
  Nanoseconds next_change(Nanoseconds now) const noexcept;
  /// Charges `used` of execution time. An excess reduces the capacity that returns later.
  void charge(Nanoseconds used) noexcept;
  /// The deadline of the capacity that the server uses now or next.
  Nanoseconds deadline() const noexcept;

  /// Capacity that is available or will return: always the whole. Deferrable: the rest of this period.
  Nanoseconds total() const noexcept;

 private:
  struct Piece {
    Nanoseconds at;  ///< usable from this instant on
    Nanoseconds amount;
  };
  bool is_deferrable() const noexcept { return spec_.kind == ServerKind::kDeferrable; }
  void give_back(const Piece& piece) noexcept;
  void drop_first() noexcept;

  ServerSpec spec_;
  Nanoseconds left_, end_;              // deferrable: rest and end of this period; left_ is negative after an excess
  FixedVector<Piece, kPieces> pieces_;  // sporadic: ascending by instant
};

}  // namespace chimera
