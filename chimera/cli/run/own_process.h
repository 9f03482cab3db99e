// SPDX-License-Identifier: Apache-2.0
// Runs components in a process of its own. If a component ends that process, its parent reports how it ended.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace chimera::cli {

/// The longest that one object may take to be loaded, one state to be constructed, or the process to exit at the end.
inline constexpr int kMakingLimitSeconds = 10;
/// Limit of `off` and `kill` at the end, as in real time. It holds for all methods if the run was asked to end.
inline constexpr int kEndingLimitSeconds = 2;

/// The cause why a run did not come to its end.
struct BrokenRun {
  std::string task;  ///< whose method was under way; "": none was
  /// "the run ended by signal 11 (SIGSEGV) while it loaded /lib/gain.so, the component of task 'amp'",
  /// "arm.off did not return within 2 s: its hardware may not be off".
  std::string text;
};

/// Runs `work` in a child and returns its exit code; both write to the same files. When the child did not return from
/// its work (a signal, exit() in a component, an object that is not loaded or a method that does not return in time: it
/// is killed), `died` gets how it ended and the method under way, and returns the code. SIGINT and SIGTERM reach the
/// child once. Processes that the work left behind are killed.
/// Under a debugger, and when there is no memory or process, `work` runs in this process.
/// Requires: one thread, handlers of both signals set. Context: setup; may block.
int in_own_process(const std::function<int()>& work, const std::function<int(const BrokenRun&)>& died);

/// "ended by signal 11 (SIGSEGV)", "ended with status 3", of a status of waitpid(). Context: setup.
std::string end_text(int status);

}  // namespace chimera::cli
