// SPDX-License-Identifier: Apache-2.0
// Runs what components do beside their cycles, in threads without real-time rights: a disk that is full, slow or
// stalled costs no cycle. One thread for each instance, so that the stalled disk of one does not hold up another.
#pragma once

#include <cstdint>
#include <memory>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"

namespace chimera {

/// Context of everything: setup, or where init and kill run; may block. Called by one thread at a time.
class BackgroundWriter {
 public:
  /// Each instance is called `every` so often; remove() waits at most `limit`.
  explicit BackgroundWriter(Nanoseconds every = milliseconds(10), Nanoseconds limit = seconds(1)) noexcept;
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;
  /// As remove() for each that is left.
  ~BackgroundWriter();

  /// From now on `background` is called with `instance`, until it answers with a fault. False when the system gives no
  /// thread. `tag` is for longest().
  [[nodiscard]] bool add(void* instance, chimera_background background, std::uint32_t tag = 0);

  /// Tag of the one whose call has been under way longest, when that is longer than `longer_than`; 0: none is. Any
  /// thread.
  std::uint32_t longest(Nanoseconds longer_than) const;

  enum class End {
    kDone,    ///< called once more, and never again
    kFault,   ///< it answered with a fault, now or before: `fault` says which
    kStalled  ///< it has not returned: the instance must stay as it is for ever; `fault` says so
  };
  /// Calls it a last time and ends its thread. Requires: add() was given `instance`.
  End remove(void* instance, chimera_fault& fault);

 private:
  struct Worker;
  End end(Worker& worker, chimera_fault& fault) const;

  Nanoseconds every_, limit_;
  struct Workers;  // not here: a header that cycles include is compiled where there are no threads
  std::unique_ptr<Workers> workers_;
};

}  // namespace chimera
