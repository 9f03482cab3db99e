// SPDX-License-Identifier: Apache-2.0
// The questions of a run to its own subsystem, answered as results. control::Client deals with a lost connection.
#pragma once

#include <optional>
#include <string>

#include "chimera/control/client.h"

namespace chimera::cli {

/// Move-only. Context: setup; blocks.
class ControlLine {
 public:
  /// Connects at its first question. `path` is the socket's.
  explicit ControlLine(std::string path) : client_(control::Client::at(std::move(path))) {}

  /// The result of one request within `limit`. A refusal comes with its words, its `where` as place; without an answer
  /// the code is kSystem and the place the socket.
  Result<Json> ask(std::string_view method, const Json& parameters, Nanoseconds limit = control::kCallLimit);
  /// The parameters of the next notification; nothing when none comes until `instant` (CLOCK_MONOTONIC), or when the
  /// connection is lost: then is_connected() is false.
  std::optional<Json> notification(Nanoseconds instant);
  bool is_connected() const noexcept { return client_.is_connected(); }

 private:
  control::Client client_;
};

}  // namespace chimera::cli
