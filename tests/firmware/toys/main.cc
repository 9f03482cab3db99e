// SPDX-License-Identifier: Apache-2.0
// Runs each set of toys on a clock that steps, and sends its records: "set SEED", "record KIND TASK AT A B".
#include <new>

#include "chimera/base/setup_memory.h"
#include "chimera/runtime/executive/executive.h"
#include "chimera/runtime/record/tap_ring.h"
#include "firmware/boards/board.h"
#include "firmware/serial_text.h"
#include "tests/firmware/toys/toys.h"

namespace chimera::baked_toys {
namespace {

/// Computing on a clock that steps.
class TwinClock final : public JobClock {
 public:
  explicit TwinClock(VirtualClock& clock) noexcept : clock_(clock) {}
  Nanoseconds now() noexcept override { return clock_.now(); }
  void spend(Nanoseconds time) noexcept override { clock_.advance(time); }

 private:
  VirtualClock& clock_;
};

alignas(16) std::byte arena[64 * 1024];
constinit TapRing ring{};

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
  VirtualClock clock;
  TwinClock job_clock(clock);
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
  Tap tap(baked_toys::ring);
  TapReader reader(baked_toys::ring);
  for (const baked_toys::Set& each : baked_toys::kSets) baked_toys::run(each, tap, reader);
  firmware::uart().flush();
  return 0;
}
