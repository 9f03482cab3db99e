// SPDX-License-Identifier: Apache-2.0
// Shows which task ran at each time, one letter for each interval: the form in which the literature prints schedules.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/runtime/record/tap_record.h"

namespace chimera::draw {

/// `letters` has one letter per interval, '.' for an idle one; `legend` has the letter of each task, one line per task.
struct Timeline {
  std::string letters;
  std::vector<std::pair<char, std::string>> legend;
};

/// Reads the kRun records of [origin, origin + duration), in intervals of length `unit`. If several tasks ran in an
/// interval, it shows the longest, and on a tie the first by id. The letter of a task is the first letter of its name,
/// as a capital, if these all differ; otherwise all tasks are A, B, C, ... in order. Requires: unit > 0; at most
/// 10,000,000 intervals are drawn. Context: setup.
Timeline timeline(std::span<const TapRecord> records, std::span<const std::string> tasks, Nanoseconds origin,
                  Nanoseconds unit, Nanoseconds duration);

/// The letters in lines of 60, each after the number of its first interval, then the legend. Context: setup.
std::string text(const Timeline& timeline);

}  // namespace chimera::draw
