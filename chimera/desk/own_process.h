// SPDX-License-Identifier: Apache-2.0
// Work that runs components, in a process of its own: whatever they do to it, somebody is left who says what it was.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace chimera::desk {

/// The longest that one object may take to be loaded, or one state to be constructed.
inline constexpr int kMakingLimitSeconds = 10;

/// Runs `work` in a child and returns its exit code; both write to the same files. When the child did not return from
/// its work (a signal, exit() in a component, an object that is not loaded within 10 s: it is killed), `died` is told
/// how and what was under way ("ended by signal 11 (SIGSEGV) while it loaded /lib/gain.so, the component of task
/// 'amp'") and gives the code. SIGINT and SIGTERM reach the child once; when it has not ended 10 s later and does what
/// it did then, it is killed. Under a debugger, and when there is no memory or process, `work` runs in this process.
/// Requires: one thread, handlers of both signals set. Context: setup; may block.
int in_own_process(const std::function<int()>& work, const std::function<int(const std::string&)>& died);

/// "ended by signal 11 (SIGSEGV)", "ended by itself with exit code 3", of a status of waitpid(). Context: setup.
std::string end_text(int status);

}  // namespace chimera::desk
