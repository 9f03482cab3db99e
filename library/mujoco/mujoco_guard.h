// SPDX-License-Identifier: Apache-2.0
// Protects a control loop from MuJoCo. By default MuJoCo writes warnings to MUJOCO_LOG.TXT in the working directory,
// ends the process on an error, and resets a diverged state silently.
#pragma once

#include <mujoco/mujoco.h>

namespace chimera::library {

/// Replaces MuJoCo's process-wide warning and error handlers: no file, no exit. Context: setup.
void install_mujoco_handlers() noexcept;

/// Calls `part` of a step. Returns false if MuJoCo raised an error (mujoco_error() has the text), or found a number in
/// the state that is NaN or too large; it has then reset the state. Context: cycle; wait-free.
bool guarded(void (*part)(const mjModel*, mjData*), const mjModel* model, mjData* state) noexcept;

/// Calls `part(with)`. Returns false if MuJoCo raised an error; what `part` had allocated is then lost. Context: setup.
bool guarded_setup(void (*part)(void*), void* with) noexcept;

/// Text of the last error of guarded() and guarded_setup() in this thread; empty without one.
const char* mujoco_error() noexcept;

}  // namespace chimera::library
