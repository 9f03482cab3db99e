// SPDX-License-Identifier: Apache-2.0
// Threads for what components do beside their cycles, as the calls of methods see them. On a machine without threads
// there are none (null), and a background runs before kill alone.
#pragma once

#include <cstdint>

#include "chimera/task/abi.h"

namespace chimera {

/// Context of everything: setup, or where init and kill run; may block. Called by one thread at a time.
class BackgroundThreads {
 public:
  /// From now on `background` is called with `instance`, until it answers with a fault. False when the system gives no
  /// thread. `tag` is the TaskWord of the task that runs there.
  [[nodiscard]] virtual bool add(void* instance, chimera_background background, std::uint32_t tag) = 0;

  enum class End {
    kDone,    ///< called once more, and never again
    kFault,   ///< it answered with a fault, now or before: `fault` says which
    kStalled  ///< it has not returned: the instance must stay as it is for ever; `fault` says so
  };
  /// Calls it a last time and ends its thread. Requires: add() was given `instance`.
  virtual End remove(void* instance, chimera_fault& fault) = 0;

 protected:
  ~BackgroundThreads() = default;
};

}  // namespace chimera
