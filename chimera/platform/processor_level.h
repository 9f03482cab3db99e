// SPDX-License-Identifier: Apache-2.0
// SCHED_FIFO levels of threads of this process, changed while they run, and what a thread has used of its processor.
// What such a thread starts, threads and processes, is ordinary (SCHED_RESET_ON_FORK); without CAP_SYS_NICE that cannot
// be taken back, so every change of a level says it again.
#pragma once

#include <sys/types.h>

#include <cstdint>

#include "chimera/base/time.h"

namespace chimera {

/// The calling thread, for the functions below. Context: setup.
pid_t this_thread() noexcept;

/// Runs `thread` (0: the calling one) at that SCHED_FIFO level. A thread that is lowered goes to the head of its new
/// level, one that is raised to the tail (sched(7)). False when the thread is gone or the right is missing.
/// Context: cycle; wait-free (one system call).
bool set_level(pid_t thread, int level) noexcept;

/// Runs `thread` below every real-time thread (SCHED_OTHER). Context: cycle; wait-free (one system call).
bool set_below_all(pid_t thread) noexcept;

/// The level at which `thread` runs; 0 when it is not a real-time thread, or gone. Context: cycle; wait-free (one
/// system call).
int level_of(pid_t thread) noexcept;

/// Execution time that `thread` has used; kNever when it is gone. Context: cycle; wait-free (one system call).
Nanoseconds used_by(pid_t thread) noexcept;

/// Execution time of the calling thread. Context: cycle; wait-free (one system call).
Nanoseconds used_by_this_thread() noexcept;

/// True when `thread` waits for something in the kernel; false too when it is gone. Context: cycle boundary; bounded (a
/// file of the kernel is read).
bool is_asleep(pid_t thread) noexcept;

/// How often the calling thread gave its processor away to wait for something, a page of memory too. Context: any;
/// wait-free (one system call).
std::uint64_t sleeps_of_this_thread() noexcept;

}  // namespace chimera
