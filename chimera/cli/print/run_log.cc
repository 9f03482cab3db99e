// SPDX-License-Identifier: Apache-2.0
// Adds a line to the log of a run for each event.
#include "chimera/cli/print/run_log.h"

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/platform/standard_streams.h"

namespace chimera::cli {

/// Flushes each line: what waits for the thread that writes is whole lines.
void RunLog::add(const Json& event) {
  const std::uint64_t number = event["number"].as_uint64();
  if (outlet_.stream() == nullptr || number <= last_) return;
  last_ = number;
  std::fputs(for_terminal(lines_.add(event)).c_str(), outlet_.stream());
  std::fflush(outlet_.stream());
}

std::string RunLog::loss() const {
  const int why = outlet_.why_lost();
  return why == 0 ? "" : path_ + ": events are lost: " + why_lost_text(why);
}

void RunLog::report_loss(std::FILE* err) {
  if (const std::string lost = loss(); !lost.empty() && !std::exchange(is_reported_, true))
    std::fprintf(err, "%s; the run goes on, and its exit code is 1\n", lost.c_str());
}

std::string RunLog::finish(Nanoseconds limit) {
  outlet_.finish(limit);
  return loss();
}

}  // namespace chimera::cli
