// SPDX-License-Identifier: Apache-2.0
// Compares the known part of an image with the memories of the target.
#include "chimera/bake/refusals.h"
#include "chimera/base/hosted/wording.h"

namespace chimera::bake {
namespace {

std::string kib(std::size_t bytes) { return formatted("%.1f KiB", static_cast<double>(bytes) / 1024); }

void refuse(const char* what, std::size_t need, const MemoryRange& range, const char* parts, const char* remedy,
            Report& report) {
  if (need <= range.bytes) return;
  report.add({.rule = "table-limit",
              .at = range.at,
              .message = std::string(parts) + " need at least " + kib(need) + "; '" + what + "' has " +
                         kib(range.bytes),
              .found = kib(need),
              .expected = "at most " + kib(range.bytes),
              .remedy = remedy});
}

}  // namespace

void refuse_memory(const MemoryNeed& need, const Target& target, Report& report) {
  refuse("flash", need.flash_bytes(), target.flash, "the tables of the tasks",
         "use fewer tasks and configurations, or a chip with more flash", report);
  refuse("ram", need.ram_bytes(), target.ram, "stacks, records, ports and values of the tasks",
         "use fewer tasks and smaller lists, smaller stacks, or a chip with more RAM", report);
}

}  // namespace chimera::bake
