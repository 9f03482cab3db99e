// SPDX-License-Identifier: Apache-2.0
// Subscribes to the scheduling records of a subsystem and converts them.
#include "chimera/cli/run/record_line.h"

#include <algorithm>

#include "chimera/platform/clock.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

constexpr Nanoseconds kLastRecords = milliseconds(50);  // those of the end are on their way

std::size_t index_of(const std::deque<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

TaskNames TaskNames::of(const Json& status) {
  TaskNames made;
  made.subsystem = text_at(status, "subsystem");
  for (const Json& task : status.at("tasks")) made.tasks.push_back(text_at(task, "task"));
  for (const Json& rtpu : status.at("rtpus")) made.rtpus.push_back(text_at(rtpu, "name"));
  for (const std::string& name : made.tasks) made.task_specs_.emplace_back().name = name;
  for (const std::string& name : made.rtpus) made.rtpu_specs_.emplace_back().name = name;
  return made;
}

void TaskNames::add_configurations(const Json& described) {
  for (const Json& set : described["configurations"])
    sets_.push_back({configurations.emplace_back(text_at(set, "name")), {}});
}

ApplicationSpec TaskNames::spec() const noexcept {
  ApplicationSpec spec;
  spec.name = subsystem;
  spec.tasks = task_specs_;
  spec.rtpus = rtpu_specs_;
  spec.sets = sets_;
  return spec;
}

Result<void> RecordLine::subscribe(From from) {
  Json wanted = {{"to", "tap"}, {"variables", Json::array()}};
  if (from == From::kOldest) wanted["since"] = 0;
  const auto answer = line_.ask("subscribe", wanted);
  if (!answer) return answer.error();
  return {};
}

void RecordLine::poll(Nanoseconds instant, RecordSink& sink) {
  if (!line_.is_connected() && !subscribe(From::kNow)) {
    LinuxClock().wait_until(std::min(instant, LinuxClock().now() + milliseconds(10)));
    return;
  }
  const auto heard = line_.notification(instant);
  if (!heard || !heard->contains("records")) return;
  const bool is_first = whole_at(*heard, "first") == 0;
  (is_first ? missed_ : lost_) += static_cast<std::uint64_t>(whole_at(*heard, "lost"));
  std::vector<TapRecord> records;
  for (const Json& row : (*heard)["records"]) {
    TapRecord record;
    const auto kind = std::find(kTapKinds.begin(), kTapKinds.end(), row[1].as_string());
    if (kind == kTapKinds.end()) continue;
    record.at = {row[0].as_int64()};
    record.kind = static_cast<TapKind>(kind - kTapKinds.begin());
    const std::string task = row[2].is_string() ? row[2].as_string() : "";
    const std::size_t index = index_of(names_.tasks, task);
    if (index < names_.tasks.size()) record.task = TaskId(index);
    record.a = static_cast<std::uint32_t>(row[3].as_uint64());
    record.b = row[4].as_int64();
    record.rtpu = static_cast<std::uint8_t>(index_of(names_.rtpus, text_at(*heard, "rtpu")));
    records.push_back(record);
  }
  sink.on_records(records);
}

void RecordLine::finish(RecordSink& sink) {
  const Nanoseconds until = LinuxClock().now() + kLastRecords;
  while (line_.is_connected() && LinuxClock().now() < until) poll(until, sink);
  sink.end(lost_, missed_);
}

}  // namespace chimera::cli
