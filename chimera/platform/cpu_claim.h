// SPDX-License-Identifier: Apache-2.0
// The claim of a CPU for the SCHED_FIFO bands, one on the whole machine: two subsystems whose priorities know nothing
// of each other would break each other's promises.
#pragma once

#include <utility>

#include "chimera/base/result.h"

namespace chimera {

/// Held until this ends or its process dies, however it dies. Move-only. Not inherited by exec.
/// The claim is an abstract Unix socket "chimera-cpu-N": the machine is what shares a network namespace.
class CpuClaim {
 public:
  /// Refuses a CPU that is claimed already: by which process of which user, and what to do. Context: setup.
  static Result<CpuClaim> take(int cpu) noexcept;

  CpuClaim() noexcept = default;
  CpuClaim(CpuClaim&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  CpuClaim& operator=(CpuClaim&& other) noexcept;
  ~CpuClaim();

  bool is_held() const noexcept { return descriptor_ >= 0; }

 private:
  explicit CpuClaim(int descriptor) noexcept : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace chimera
