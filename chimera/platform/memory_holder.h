// SPDX-License-Identifier: Apache-2.0
// A second process that shares the memory of this one, does nothing, and gives that memory back after its death.
//
// Linux takes the memory of a killed process down before its pidfd becomes readable: milliseconds when it is locked,
// on the processor and at the priority of whichever thread ends last, even a SCHED_FIFO one. Memory that somebody else
// still has is not taken down: the death is known at once, and the work is done later by somebody with time
// (docs/design/guard.md).
#pragma once

namespace chimera {

/// From now on this process dies quickly. The memory holder has no descriptor of this process, takes no signal but
/// SIGKILL, runs only when nothing else wants to (SCHED_IDLE), and ends some milliseconds after this process, however
/// that ends. False when the system grants no second process: then everything is as without. Once per process, by its
/// first thread, before it has secrets to close. Context: setup.
bool start_memory_holder() noexcept;

}  // namespace chimera
