// SPDX-License-Identifier: Apache-2.0
// A connection to a running subsystem that outlives its manager: lost, it is made again.
#pragma once

#include <optional>
#include <string>

#include "chimera/control/client.h"

namespace chimera::desk {

/// Move-only. Context: setup; blocks.
class ControlLine {
 public:
  /// Connects at its first question. `path` is the socket's.
  explicit ControlLine(std::string path) : path_(std::move(path)) {}

  /// The result of one request. When the manager dies meanwhile it is sent again to the next one, for at most
  /// `patience`, and not much longer once request_stop() was called. An error of the door comes with its words, its
  /// `where` as place.
  Result<control::Json> ask(std::string_view method, const control::Json& parameters,
                            Nanoseconds patience = seconds(5));
  /// The parameters of the next notification; nothing when none comes until `instant` (CLOCK_MONOTONIC), or when the
  /// connection is lost: is_connected() tells.
  std::optional<control::Json> notification(Nanoseconds instant);
  bool is_connected() const noexcept { return client_.has_value(); }

 private:
  std::string path_;
  std::optional<control::Client> client_;
};

}  // namespace chimera::desk
