// SPDX-License-Identifier: Apache-2.0
// Analyses the schedule of a description and prints text, JSON or a picture.
#include "chimera/cli/files/schedule.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "chimera/cli/files/schedule_text.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {
namespace {

Result<void> write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (file) return {};
  return Error{ErrorCode::kSystem, {std::string("cannot be written: ") + std::strerror(errno)}, {path}};
}

ScheduleOptions options_of(const ScheduleRequest& request, const std::optional<RecordedProfile>& profile) {
  ScheduleOptions options;
  if (profile) options.profile = &*profile;
  if (request.dispatch == "preemptive") options.dispatch = Dispatch::kPreemptive;
  if (request.dispatch == "executive") options.dispatch = Dispatch::kExecutive;
  return options;
}

}  // namespace

CommandResult schedule(const ScheduleRequest& request, const Workplace& workplace) {
  const auto library = workplace.library(request.file);
  if (!library) return file_refusal(library.error(), request.json);
  Verdict verdict = verify(read_description_file(request.file), *library, Overload::kTold);
  if (verdict.configuration) {
    auto set = with_settings(*verdict.configuration, *library, request.settings, Overload::kTold);
    if (!set) return file_refusal(set.error(), request.json);
    verdict.configuration = *std::move(set);
  }
  CommandResult output;
  if (!request.json) output.err = verdict.report.text();
  if (!verdict.configuration) {
    output.code = kRefused;
    if (request.json) output.out = verdict.report.json() + "\n";
    return output;
  }
  std::optional<RecordedProfile> profile;
  if (!request.profile.empty()) {
    auto read = read_recorded_profile(request.profile);
    if (!read) return file_refusal(read.error(), request.json);
    profile = *std::move(read);
  }
  const ScheduleReport report = schedule_report(*verdict.configuration, options_of(request, profile));
  if (!request.svg.empty())
    if (auto written = write_file(request.svg, draw::svg(schedule_pictures(*verdict.configuration, report))); !written)
      return file_refusal(written.error(), request.json);
  output.code = report.fits() ? kOk : kRefused;
  if (request.json) {
    output.out = schedule_json(*verdict.configuration, report) + "\n";
    return output;
  }
  for (const std::string& note : report.notes) output.err += "note: " + note + "\n";
  output.out = schedule_text(*verdict.configuration, report);
  return output;
}

}  // namespace chimera::cli
