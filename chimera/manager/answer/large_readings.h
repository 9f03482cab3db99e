// SPDX-License-Identifier: Apache-2.0
// Readings whose values are too large for one step of the loop: 4 MiB of numbers take half a second.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chimera/control/pieces.h"
#include "chimera/manager/state/manager_state.h"
#include "chimera/text/value_renderer.h"

namespace chimera::manager {

/// Bytes of values above which the readings are made in pieces.
inline constexpr std::size_t kLargeReadings = std::size_t{1} << 14;

/// The present size of the values of these variables. Context: setup.
std::size_t bytes_of(const ManagerState& state, const std::vector<VariableId>& variables);

/// {name: reading} as readings_json() makes them. Reads a variable only after those before it have been sent, so that
/// it holds at most one value. Context: setup.
class LargeReadings final : public control::Pieces {
 public:
  /// The readings stand between `begin`, which is not empty, and `end`. `state` outlives it.
  LargeReadings(const ManagerState& state, std::vector<VariableId> variables, std::string begin, std::string end)
      : state_(state), variables_(std::move(variables)), begin_(std::move(begin)), end_(std::move(end)) {}
  bool append_to(std::string& text) override;

 private:
  void begin_reading(std::string& text);
  void go_on_with_reading(std::string& text);

  const ManagerState& state_;
  std::vector<VariableId> variables_;
  std::string begin_, end_;
  std::size_t next_ = 0;  // of variables_
  VariableReading reading_;
  std::optional<ValueRenderer> text_, value_;  // parts of reading_ that are not written yet
};

}  // namespace chimera::manager
