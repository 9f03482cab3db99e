// SPDX-License-Identifier: Apache-2.0
// Writes the lamps of the MPS2 boards, and reads what a safe write left behind the RAM of the image.
#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct Lamp {
  In<bool> lamp{"lamp", "1"};
  Out<std::int64_t> safe_word{"safe_word", "1", initial = 0};

  void cycle(Cycle) {
    word_at(0x4002'8000) = *lamp ? 1 : 0;
    *safe_word = word_at(0x2001'0000);
  }

 private:
  static volatile std::uint32_t& word_at(std::uintptr_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
  }
};
CHIMERA_COMPONENT(Lamp, "fw_lamp", "Writes the lamps of a board.", rate = 100.0);

}  // namespace
