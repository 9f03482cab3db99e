// SPDX-License-Identifier: Apache-2.0
// Aperiodic servers: a bounded share of the processor for a task with irregular events.
//   deferrable  capacity is available from the start of each period and lost at its end: an event is served at once,
// and
//               a server may run twice back to back (Strosnider, Lehoczky, Sha, IEEE Trans. Computers 44(1), 1995;
//               with earliest deadline: the deadline is the end of the period, Ghazalie & Baker, Real-Time Systems
//               9(1), 1995)
//   sporadic    used capacity returns one period after the server became active: never more than a periodic task
//               (Sprunt, Sha, Lehoczky, Real-Time Systems 1(1), 1989; with earliest deadline: the deadline is that
//               instant, Spuri & Buttazzo, Real-Time Systems 10(2), 1996)
// Under every policy a server ranks by its own period and deadline, not by those of its events.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"

namespace chimera {

enum class ServerKind : std::uint8_t { kDeferrable, kSporadic };

/// "deferrable". Context: any; wait-free.
constexpr const char* server_kind_name(ServerKind kind) noexcept {
  return kind == ServerKind::kDeferrable ? "deferrable" : "sporadic";
}

/// 0 < capacity <= period.
struct ServerSpec {
  ServerKind kind = ServerKind::kDeferrable;
  Nanoseconds capacity;
  Nanoseconds period;
};

}  // namespace chimera
