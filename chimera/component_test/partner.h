// SPDX-License-Identifier: Apache-2.0
// The program at the other end of the device of a component, during a trial (docs/formats/component-test.md).
#pragma once

#include <string>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/platform/process.h"

namespace chimera::component_test {

/// The running program; the destructor ends it. Context: setup; may block. Movable.
class Partner {
 public:
  /// Starts `program` and waits at most `patience` for its first line. Refuses if none comes.
  static Result<Partner> start(const std::string& program, Nanoseconds patience);
  Partner(Partner&&) noexcept = default;
  Partner& operator=(Partner&&) = delete;
  ~Partner();

  const std::string& line() const noexcept { return line_; }

 private:
  explicit Partner(Process process) noexcept : process_(std::move(process)) {}

  Process process_;
  std::string line_;
};

}  // namespace chimera::component_test
