// SPDX-License-Identifier: Apache-2.0
// Who had which unit of time, from what a run left on its tap.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "chimera/runtime/tap_record.h"

namespace chimera::toy {

/// The task that had most of each unit, named by a letter of `names`; '.' where none had one of `parts` of it.
inline std::string timeline(const std::vector<TapRecord>& records, Nanoseconds origin, Nanoseconds unit,
                            const std::string& names, std::size_t length, int parts = 5) {
  std::vector<std::vector<std::int64_t>> share(length, std::vector<std::int64_t>(names.size()));
  for (const TapRecord& r : records) {
    if (r.kind != TapKind::kRun) continue;
    std::int64_t at = (r.at - origin).count, left = r.b;
    while (left > 0 && at / unit.count < static_cast<std::int64_t>(length)) {
      const std::int64_t cell = at / unit.count, part = std::min(left, (cell + 1) * unit.count - at);
      share[static_cast<std::size_t>(cell)][r.task.index] += part;
      at += part;
      left -= part;
    }
  }
  std::string line;
  for (const auto& cell : share) {
    const auto most = std::max_element(cell.begin(), cell.end());
    line += *most * parts < unit.count ? '.' : names[static_cast<std::size_t>(most - cell.begin())];
  }
  return line;
}

}  // namespace chimera::toy
