// SPDX-License-Identifier: Apache-2.0
// Threads for work that no cycle waits for.
#pragma once

#include <functional>

namespace chimera {

/// Starts a thread without real-time rights, on any CPU, whatever the calling thread has. No signal reaches it, and
/// nobody waits for its end. False when the system has none. Context: setup.
bool start_ordinary_thread(std::function<void()> work);

}  // namespace chimera
