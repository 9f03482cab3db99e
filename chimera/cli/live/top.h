// SPDX-License-Identifier: Apache-2.0
// The screen of `chimera top` as a pure function of what it shows.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "chimera/text/json.h"

namespace chimera::cli {

enum class TopOrder : char {
  kFile = 'o', kName = 'n', kExecution = 'e', kBudget = 'b', kJitter = 'j', kMissed = 'm', kAge = 'a'
};

/// The view that the user has chosen.
struct TopView {
  std::size_t width = 80, height = 24;
  TopOrder order = TopOrder::kFile;
  std::size_t skipped = 0;  ///< tasks scrolled out at the top
  bool is_help = false;     ///< what the columns mean instead of the tasks
  bool has_keys = true;     ///< the last line names the keys
};

struct TopLine {
  enum class Look : char { kPlain, kHeading, kAlarm, kFaint };
  std::string text;  ///< exactly `width` columns
  Look look = Look::kPlain;
};

/// The order that a key asks for; nullopt when it is no such key.
std::optional<TopOrder> order_of_key(int key);

/// Exactly `height` lines, one less without `has_keys`: the headline, a line for each rtpu, the tasks, the keys. Rate
/// and execution time are those since `previous` (an earlier `status` of the same subsystem, or null: since the
/// start). A task in ERROR, or that missed a deadline since `previous`, is an alarm; so is an rtpu that is dead. What
/// does not fit is counted. Below 80 columns the budget is left out, then jitter, rate and execution time. Context:
/// setup.
std::vector<TopLine> top_lines(const Json& status, const Json& previous, const TopView& view);

/// The meaning of the columns and keys: exactly `height` lines. Context: setup.
std::vector<TopLine> help_lines(const TopView& view);

/// The end of scrolling: the largest `skipped` that still shows a task on every line.
std::size_t most_skipped(const Json& status, const TopView& view);

}  // namespace chimera::cli
