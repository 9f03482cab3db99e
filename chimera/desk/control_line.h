// SPDX-License-Identifier: Apache-2.0
// One connection of this face to a running subsystem: docs/formats/control.md.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "chimera/base/result.h"
#include "chimera/base/time.h"

namespace chimera::desk {

/// Move-only. Context: setup; blocks.
class ControlLine {
 public:
  /// Connects at its first question. `path` is the socket's.
  explicit ControlLine(std::string path) : path_(std::move(path)) {}
  ControlLine(ControlLine&& other) noexcept
      : path_(std::move(other.path_)), socket_(std::exchange(other.socket_, -1)), heard_(std::move(other.heard_)) {}
  ~ControlLine() { hang_up(); }

  /// The answer to one request. When the manager dies meanwhile the request is sent again to the next one, for at most
  /// `patience`. An error of the door comes with its words, its `where` as place.
  Result<nlohmann::json> ask(const std::string& method, const nlohmann::json& parameters,
                             Nanoseconds patience = seconds(5));
  /// The parameters of the next notification; nothing when none comes until `instant` (CLOCK_MONOTONIC), or when the
  /// connection is lost: is_connected() tells. A signal ends the wait early.
  std::optional<nlohmann::json> notification(Nanoseconds instant);
  bool is_connected() const noexcept { return socket_ >= 0; }

 private:
  bool connect();
  void hang_up() noexcept;
  bool send(const std::string& line);
  std::optional<nlohmann::json> line(Nanoseconds instant);

  std::string path_;
  int socket_ = -1;
  std::string heard_;  ///< bytes of lines not taken yet
  int last_id_ = 0;
};

}  // namespace chimera::desk
