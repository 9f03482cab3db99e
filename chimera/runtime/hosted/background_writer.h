// SPDX-License-Identifier: Apache-2.0
// Runs the background of components in threads without real-time rights: a disk that is full, slow or stalled costs no
// cycle. One thread for each instance, so that the stalled disk of one does not delay another.
#pragma once

#include <cstdint>
#include <memory>

#include "chimera/base/time.h"
#include "chimera/runtime/background_threads.h"

namespace chimera {

/// Context of everything: setup, or where init and kill run; may block. Called by one thread at a time.
class BackgroundWriter final : public BackgroundThreads {
 public:
  /// Each instance is called once in each interval `every`; remove() waits at most `limit`.
  explicit BackgroundWriter(Nanoseconds every = milliseconds(10), Nanoseconds limit = seconds(1)) noexcept;
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;
  /// Calls remove() for each that is left.
  ~BackgroundWriter();

  [[nodiscard]] bool add(void* instance, chimera_background background, std::uint32_t tag = 0) override;
  /// Tag of the instance whose call has been under way longest, if that is longer than `longer_than`; 0: none is. Any
  /// thread.
  std::uint32_t longest(Nanoseconds longer_than) const;

  End remove(void* instance, chimera_fault& fault) override;

 private:
  struct Worker;
  End end(Worker& worker, chimera_fault& fault) const;

  Nanoseconds every_, limit_;
  struct Workers;  // not here: files that include this need no threads and locks
  std::unique_ptr<Workers> workers_;
};

}  // namespace chimera
