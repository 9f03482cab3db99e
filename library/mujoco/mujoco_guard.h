// SPDX-License-Identifier: Apache-2.0
// Keeps MuJoCo's habits away from a control loop: by itself it writes warnings to MUJOCO_LOG.TXT in the working
// directory, ends the process on an error, and resets a state that blew up without a word.
#pragma once

#include <mujoco/mujoco.h>

namespace chimera::library {

/// Takes over MuJoCo's process-wide warning and error handlers: no file, no exit. Context: setup.
void install_mujoco_handlers() noexcept;

/// Calls `part` of a step. False when MuJoCo raised an error in it (mujoco_error() has the text) or found a number
/// that is none, or too large, in the state; it has then reset the state. Context: cycle; wait-free.
bool guarded(void (*part)(const mjModel*, mjData*), const mjModel* model, mjData* state) noexcept;

/// Text of the last error of this thread's guarded(), empty when there was none.
const char* mujoco_error() noexcept;

}  // namespace chimera::library
