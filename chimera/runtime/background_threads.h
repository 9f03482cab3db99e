// SPDX-License-Identifier: Apache-2.0
// Interface to the threads that run the background of components. On a machine without threads it is null, and a
// background runs before kill only.
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
