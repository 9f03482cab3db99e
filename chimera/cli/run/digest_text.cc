// SPDX-License-Identifier: Apache-2.0
// Writes the lines of a digest in the order of seconds and tasks.
#include "chimera/cli/run/digest_text.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <utility>

namespace chimera::cli {

std::string DigestText::text(const ApplicationSpec& spec) const {
  std::vector<DigestLine> sorted = lines_;
  std::ranges::sort(sorted, {}, [](const DigestLine& line) { return std::pair(line.second, line.task.index); });
  std::string text = "second task publications faults hash\n";
  for (const DigestLine& line : sorted) {
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, " %" PRIu64 " %" PRIu64 " %016" PRIx64 "\n", line.publications, line.faults,
                  line.hash);
    text += std::to_string(line.second) + " " + std::string(spec.tasks[line.task.index].name) + numbers;
  }
  return text;
}

}  // namespace chimera::cli
