// SPDX-License-Identifier: Apache-2.0
// Runs each set of toys on a clock that steps, and sends its records: "set SEED", "record KIND TASK AT A B".
#include <cstddef>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/record/tap_ring.h"
#include "firmware/boards/board.h"
#include "firmware/serial_text.h"
#include "tests/firmware/toys/toys.h"

namespace chimera::baked_toys {
namespace {

/// A clock that steps, for the executive and for its jobs.
class SteppedClock final : public Clock {
 public:
  Nanoseconds now() noexcept override { return now_; }
  WaitEnd wait_until(Nanoseconds instant) noexcept override {
    if (instant > now_) now_ = instant;
    return WaitEnd::kReached;
  }
  void advance(Nanoseconds span) noexcept { now_ += span; }

 private:
  Nanoseconds now_;
};

class SteppedJobClock final : public JobClock {
 public:
  explicit SteppedJobClock(SteppedClock& clock) noexcept : clock_(clock) {}
  Nanoseconds now() noexcept override { return clock_.now(); }
  void spend(Nanoseconds time) noexcept override { clock_.advance(time); }

 private:
  SteppedClock& clock_;
};

alignas(16) std::byte arena[64 * 1024];
alignas(TapRing) std::byte ring_bytes[sizeof(TapRing)];  // zeroed memory is an empty ring

void send(Message& text) {
  text << "\n";
  while (!firmware::uart().send(text.view())) firmware::uart().flush();
}

void run(const Set& each, Tap& tap, TapReader& reader) {
  Message head;
  head << "set " << each.seed;
  send(head);
  GivenMemory memory(arena);
  TaskSet set(*each.spec, ContextPlace{}, memory);
  Message refused("refused");
  if (!set.build(*each.components)) return send(refused);
  SteppedClock clock;
  SteppedJobClock job_clock(clock);
  RunOptions options;
  options.policy = each.run->policy;
  options.script = Script(each.run->acts);
  options.tap = &tap;
  Executive executive(set, clock, job_clock, options);
  if (!executive.start()) return send(refused);
  executive.run(each.run->duration);
  TapRecord record;
  while (reader.read({&record, 1}) == 1) {
    Message text;
    text << "record " << static_cast<int>(record.kind) << " " << record.task.index << " " << record.at.count << " "
         << record.a << " " << record.b;
    send(text);
  }
}

}  // namespace
}  // namespace chimera::baked_toys

int main() {
  using namespace chimera;
  firmware::begin_board();
  TapRing& ring = *reinterpret_cast<TapRing*>(baked_toys::ring_bytes);
  Tap tap(ring);
  TapReader reader(ring);
  for (const baked_toys::Set& each : baked_toys::kSets) baked_toys::run(each, tap, reader);
  firmware::uart().flush();
  return 0;
}
