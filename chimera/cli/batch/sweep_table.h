// SPDX-License-Identifier: Apache-2.0
// The outcome of a sweep as a table, for people and for programs, and as a picture.
#pragma once

#include <string>
#include <vector>

#include "chimera/cli/batch/measured_run.h"
#include "chimera/cli/batch/value_list.h"
#include "chimera/draw/plot.h"

namespace chimera::cli {

struct SweepTable {
  std::string subsystem;
  std::vector<ValueList> lists;
  std::vector<std::string> expectations;
  std::vector<MeasuredRun> runs;  ///< the last list varies fastest

  /// The value of list `list` in run `run`, as its index.
  std::size_t index_of(std::size_t run, std::size_t list) const;
  /// Every run came to its end and met every expectation.
  bool is_good() const;
};

/// All of them. Context: setup.
std::string text(const SweepTable& table);
std::string csv(const SweepTable& table);
std::string json(const SweepTable& table);
/// Every measure over the first list, a curve for each combination of the others.
draw::Plot plot(const SweepTable& table);

}  // namespace chimera::cli
