// SPDX-License-Identifier: Apache-2.0
// Counts the interrupts of timer 0 of the MPS2 boards, which comes every 3 ms, and compares them with timer 1, which
// runs freely: in QEMU a tick of the clock may be left out when an interrupt comes whose line is off.
#include "chimera/task/component.h"

using namespace chimera;

namespace {

constexpr std::uint32_t kPeriod = 75'000;  // cycles of 25 MHz

struct Timer {
  Out<std::int64_t> interrupts{"interrupts", "1", initial = 0};
  Out<std::int64_t> lost{"lost", "1", initial = 0, doc = "Periods of the timer without an interrupt."};

  void on(Cycle) {
    *interrupts = 0;
    start(timer(0), kPeriod - 1, kRuns | kInterrupts);
    start(timer(1), UINT32_MAX, kRuns);
  }
  bool sync(Cycle) {
    if ((timer(0).interrupts & 1) == 0) return false;
    timer(0).interrupts = 1;
    return true;
  }
  void cycle(Cycle) {
    ++*interrupts;
    *lost = (UINT32_MAX - timer(1).value) / kPeriod - *interrupts;
  }
  void off(Cycle) { timer(0).control = 0; }

 private:
  struct Registers {
    volatile std::uint32_t control, value, reload, interrupts;
  };
  static constexpr std::uint32_t kRuns = 1, kInterrupts = 8;
  static Registers& timer(unsigned n) {
    return *reinterpret_cast<Registers*>(std::uintptr_t{0x4000'0000} + 0x1000 * n);
  }
  static void start(Registers& timer, std::uint32_t reload, std::uint32_t control) {
    timer.reload = reload;
    timer.value = reload;
    timer.control = control;
  }
};
CHIMERA_COMPONENT(Timer, "fw_timer", "Counts the interrupts of a timer.", rate = 1000.0);

}  // namespace
