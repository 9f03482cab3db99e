// SPDX-License-Identifier: Apache-2.0
// The program at the other end of a component's device, for the time of a trial (docs/formats/component-test.md).
#pragma once

#include <string>

#include "chimera/base/result.h"
#include "chimera/base/time.h"
#include "chimera/platform/process.h"

namespace chimera::component_test {

/// Context: setup; may block. Movable; ends the program with it.
class Partner {
 public:
  /// Starts `program` and waits for the line that it says first, at most `patience`. Refuses when there is none.
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
