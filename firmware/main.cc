// SPDX-License-Identifier: Apache-2.0
// Runs the baked application on the chip.
#include <cstddef>

#include "firmware/application.h"
#include "firmware/boards/board.h"
#include "firmware/boot/kept.h"

extern "C" std::byte image_rest_begin[], image_rest_end[];  // from the linker script: RAM without variables and stacks

int main() {
  using namespace chimera::firmware;
  const Boot boot = take_up(reset_record());
  begin_board();
  Image image({image_rest_begin, image_rest_end}, boot);
  return image.run();
}
