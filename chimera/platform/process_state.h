// SPDX-License-Identifier: Apache-2.0
// What the kernel and the machine know about processes: numbers, users, states, open descriptors, threads.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chimera/base/time.h"

namespace chimera {

/// Numbers of the calling process, of its parent, of its session, of its real user. Context: any; wait-free.
pid_t own_process_id() noexcept;
pid_t parent_process_id() noexcept;
pid_t own_session() noexcept;
uid_t own_user() noexcept;

/// The name of `user` in /etc/passwd, otherwise the number. Asks no other directory of users: its server may be far
/// away. Context: setup; reads a local file.
std::string user_name(std::uint32_t user);

/// Bytes in a page of memory. Context: any.
std::uint64_t page_bytes() noexcept;

/// State of the main thread of a process. A stop by a signal or a debugger stops all threads.
struct ProcessState {
  /// As `ps` shows it. R: runs or is ready to run, S: waits, D: waits for a disk, T and t: stopped; 0: not known.
  char letter = 0;
  Nanoseconds used;  ///< processor time of the main thread, in steps of 10 ms
  pid_t tracer = 0;  ///< the debugger that holds the process; 0: none
};

/// Read from /proc; all 0 if there is no such process. Context: setup; never blocks.
ProcessState process_state(pid_t pid) noexcept;

/// The numbers among the names in a folder of the kernel: processes in /proc, threads in /proc/PID/task. Context:
/// setup.
std::vector<pid_t> numbers_in(const std::string& folder);

/// Open descriptors of this process, each as "7 -> /dev/null".
struct Descriptors {
  std::vector<std::string> names{};
};

/// Context: setup; may block.
Descriptors open_descriptors();
/// Number of threads of this process. Context: setup; may block.
std::uint32_t threads();
/// Writes the first name of `after` that is not in `before` to `text`, zero-terminated. Without such a name `text`
/// stays as it is. Context: setup.
void name_first_new(const Descriptors& before, const Descriptors& after, std::span<char> text);

}  // namespace chimera
