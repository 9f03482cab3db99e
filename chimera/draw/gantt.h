// SPDX-License-Identifier: Apache-2.0
// Shows which task holds a processor at each time: a row for each task, with releases and deadlines.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "chimera/base/time.h"

namespace chimera::draw {

struct GanttRow {
  std::string name;
  std::string note;  ///< beside the name, smaller; may be empty
  Nanoseconds period, deadline;  ///< released at 0 and every period, due `deadline` later
  bool is_late = false;          ///< drawn in the colour of faults
  std::vector<std::pair<Nanoseconds, Nanoseconds>> runs;  ///< from, to
};

struct Gantt {
  std::string title;
  std::string note;  ///< a line under the title; may be empty
  Nanoseconds length;
  std::vector<GanttRow> rows;
};

/// A whole SVG document with the pictures one below the other. Context: setup.
std::string svg(const std::vector<Gantt>& pictures);

}  // namespace chimera::draw
