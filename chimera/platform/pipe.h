// SPDX-License-Identifier: Apache-2.0
// A pipe to a child, and what the child says first through it.
#pragma once

#include <string>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/platform/owned_descriptor.h"

namespace chimera {

/// Both ends are close-on-exec; reading never blocks. Movable; closes. Context: setup.
struct Pipe {
  /// Refuses with the system's reason.
  static Result<Pipe> open() noexcept;

  /// The first line that comes, without its end and cut after 200 bytes; empty when none came within `patience`, or
  /// when the last writer closed. Context: setup; blocks.
  std::string first_line(Nanoseconds patience) const;

  OwnedDescriptor reading, writing;
};

}  // namespace chimera
