// SPDX-License-Identifier: Apache-2.0
// Counts the interrupts of timer 0 of the MPS2 boards, which comes every 3 ms, and compares them with the time.
#include "chimera/task/component.h"

using namespace chimera;

namespace {

constexpr std::int64_t kPeriod = 3'000'000;  // ns

struct Timer {
  Out<std::int64_t> interrupts{"interrupts", "1", initial = 0};
  Out<std::int64_t> lost{"lost", "1", initial = 0, doc = "Periods of the timer without an interrupt."};

  void on(Cycle) {
    *interrupts = 0;
    timer().reload = 74'999;  // 75,000 cycles of 25 MHz
    timer().value = 74'999;
    timer().control = kRuns | kInterrupts;
  }
  bool sync(Cycle) {
    if ((timer().interrupts & 1) == 0) return false;
    timer().interrupts = 1;
    return true;
  }
  void cycle(Cycle c) {
    if (++*interrupts == 1) first_ = c.now().count;
    *lost = (c.now().count - first_ + kPeriod / 2) / kPeriod + 1 - *interrupts;
  }
  void off(Cycle) { timer().control = 0; }

 private:
  struct Registers {
    volatile std::uint32_t control, value, reload, interrupts;
  };
  static constexpr std::uint32_t kRuns = 1, kInterrupts = 8;
  static Registers& timer() { return *reinterpret_cast<Registers*>(std::uintptr_t{0x4000'0000}); }

  std::int64_t first_ = 0;
};
CHIMERA_COMPONENT(Timer, "fw_timer", "Counts the interrupts of a timer.", rate = 1000.0);

}  // namespace
