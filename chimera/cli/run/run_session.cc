// SPDX-License-Identifier: Apache-2.0
// The loop of a run and its report, over a RunTarget.
#include "chimera/cli/run/run_session.h"

#include <algorithm>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/platform/standard_streams.h"

namespace chimera::cli {

int RunSession::run() {
  if (const auto started = target_.start(); !started) return target_.refuse(started.error());
  return report(watch());
}

RunEnd RunSession::watch() {
  Nanoseconds next_line = request_.watch.empty() ? kNever : every_;
  while (next_line < target_.printed_until()) next_line += every_;
  for (;;) {
    const Nanoseconds next = std::min(next_line, request_.duration);
    const std::optional<RunEnd> end = target_.advance(next);
    const bool is_due = next == next_line && (!end || *end == RunEnd::kTime);
    if (is_due || (end && target_.shows_values_at(*end)))
      show_values(end && *end != RunEnd::kTime ? target_.now() : next);
    if (end) return *end;
    if (is_due) next_line += every_;
  }
}

void RunSession::show_values(Nanoseconds at) {
  if (request_.watch.empty() || target_.draws(at) || request_.json) return;
  std::string line = "t " + seconds_text(at) + " s";
  const std::vector<Reading> readings = target_.read(request_.watch);
  for (std::size_t i = 0; i < readings.size(); ++i)
    line += "  " + request_.watch[i] + " " + (readings[i].seen.is_written ? readings[i].seen.text : "not written yet");
  std::fprintf(out_, "%s\n", plain_line(line).c_str());
  (void)flush_and_look(out_);
}

int RunSession::report(RunEnd end) {
  RunReport report;
  report.end = end;
  report.ran = std::min(target_.now(), request_.duration);
  std::vector<std::string> names = request_.watch;
  for (const Expectation& expectation : expectations_) names.push_back(expectation.variable());
  const std::vector<Reading> readings = target_.read(names);
  const std::size_t watched = request_.watch.size();
  for (std::size_t i = 0; i < watched; ++i) report.variables.push_back({names[i], readings[i].unit, readings[i].json});
  for (std::size_t i = 0; i < expectations_.size(); ++i) report.judge(expectations_[i], readings[watched + i].seen);
  target_.finish(report);
  print(report, request_.json, out_);
  (void)flush_and_look(out_);
  const bool is_saved = save_profile(report, request_.profile, err_);
  return target_.is_output_complete(report) && is_saved ? report.code() : kRefused;
}

}  // namespace chimera::cli
