// SPDX-License-Identifier: Apache-2.0
// Fails on a microcontroller in the way that its input names: 1 hangs, 2 uses up the stack, 3 writes where no memory
// is, 4 executes no instruction. 5 hangs in this run and in the next two.
#include "chimera/task/component.h"

using namespace chimera;

namespace {

std::uint32_t fill_stack(std::uint32_t depth) {
  volatile std::uint32_t words[32];
  words[depth % 32] = depth;
  return depth == UINT32_MAX ? 0 : fill_stack(depth + 1) + words[depth % 32];
}

struct Fault {
  In<std::int64_t> way{"way", "1"};
  Out<std::int64_t> cycles{"cycles", "1", initial = 0};

  void cycle(Cycle) {
    ++*cycles;
    volatile std::uint32_t& runs_to_hang = word_at(0x2001'0004);  // outlives a reset
    if (*way == 5) runs_to_hang = 3;
    if (runs_to_hang > 0 && runs_to_hang <= 3) {
      runs_to_hang = runs_to_hang - 1;
      hang();
    }
    switch (*way) {
      case 1: hang(); break;
      case 2: *cycles = fill_stack(0); break;
      case 3: word_at(0x6f00'0000) = 1; break;
      case 4: asm volatile(".short 0xde00"); break;
      default: break;
    }
  }

 private:
  static volatile std::uint32_t& word_at(std::uintptr_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
  }
  static void hang() {
    for (volatile bool for_ever = true; for_ever;) {
    }
  }
};
CHIMERA_COMPONENT(Fault, "fw_fault", "Fails on a microcontroller.", rate = 100.0);

}  // namespace
