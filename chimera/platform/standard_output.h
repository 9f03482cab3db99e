// SPDX-License-Identifier: Apache-2.0
// Whether what a program printed has reached its place. A write that fails is an error of the program, not a signal
// that ends it, and is told where it still can be. docs/decisions/0023-exit-code-of-a-run.md.
#pragma once

#include <cstdio>

#include "chimera/base/message.h"

namespace chimera {

/// First of all in a program: descriptors 0, 1 and 2 that are closed are taken, so that nothing else gets their numbers
/// and is written into; reading and writing them fails as before. A file that may not grow further is an error of the
/// write, and no signal (SIGXFSZ). Context: setup.
void hold_standard_streams() noexcept;

/// In place of a reason of the system: the bytes are there, and nobody takes them.
inline constexpr int kNobodyReads = -1;

/// "No space left on device", for a number of the system. Context: any; wait-free.
const char* why_lost_text(int why) noexcept;

/// Flushes `stream`. Why something that was printed to it is lost, then and ever after; 0: nothing is. Of other streams
/// than the standard ones only what is lost now. Context: cycle boundary; may block.
int flush_and_look(std::FILE* stream) noexcept;

/// Somebody has told of the loss already: report_lost_output() says nothing. Context: any.
void loss_is_told() noexcept;

/// Last of all in a program: tells on standard error when standard output is lost. `code`, or 1 in the place of 0 when
/// one of the two is. Context: cycle boundary; may block.
int report_lost_output(int code) noexcept;

}  // namespace chimera
