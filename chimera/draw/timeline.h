// SPDX-License-Identifier: Apache-2.0
// Who ran when, one letter for each unit of time: the form in which the literature prints schedules.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/runtime/tap_record.h"

namespace chimera::draw {

/// `letters` has one letter per unit, '.' where nobody ran; `legend` tells whose they are, one per task.
struct Timeline {
  std::string letters;
  std::vector<std::pair<char, std::string>> legend;
};

/// What the kRun records of [origin, origin + duration) say. A unit in which several tasks ran shows the one that
/// ran longest, of equals the first by id. The letter of a task is its first as a capital where no two tasks
/// share one; otherwise all tasks are A, B, C, ... in order. Requires: unit > 0; at most 10,000,000 units are drawn.
/// Context: setup.
Timeline timeline(std::span<const TapRecord> records, std::span<const std::string> tasks, Nanoseconds origin,
                  Nanoseconds unit, Nanoseconds duration);

/// The letters in lines of 60, each after the number of its first unit, then the legend. Context: setup.
std::string text(const Timeline& timeline);

}  // namespace chimera::draw
