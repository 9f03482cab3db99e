// SPDX-License-Identifier: Apache-2.0
// Reads and writes the file of a recorded profile, with limits on every value that is read.
#include "chimera/analysis/recorded_profile.h"

#include <algorithm>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/platform/file.h"
#include "chimera/text/json.h"
#include "chimera/text/json_cursor.h"
#include "chimera/text/json_text.h"

namespace chimera {
namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kMostBytes = 256 * 1024;
constexpr std::size_t kNesting = 4;
constexpr std::size_t kMostTasks = 256;
constexpr std::size_t kMostName = 100;
constexpr std::int64_t kLongestPeriod = 3'600'000'000'000;  // the longest period there is
constexpr std::uint64_t kMostSamples = std::uint64_t{1} << 53;

std::uint64_t count_at(const JsonCursor& at, std::uint64_t most) {
  const Json& json = at.value();
  if (!json.is_whole() || json.as_int64() < 0 || json.as_uint64() > most)
    at.refuse("expected a whole number from 0 to " + std::to_string(most));
  return json.as_uint64();
}

Nanoseconds time_at(const JsonCursor& at, std::string_view key) {
  return {static_cast<std::int64_t>(count_at(at.at(key), kLongestPeriod))};
}

std::string name_at(const JsonCursor& at) {
  std::string name = at.text();
  if (name.empty() || name.size() > kMostName) at.refuse("expected a name of 1 to 100 bytes");
  return name;
}

RecordedTask task_at(const JsonCursor& at) {
  at.expect_keys({"task", "samples", "worst_ns", "mean_ns", "response_ns", "jitter_ns"}, {});
  RecordedTask task;
  task.task = name_at(at.at("task"));
  task.samples = count_at(at.at("samples"), kMostSamples);
  task.worst = time_at(at, "worst_ns");
  task.mean = time_at(at, "mean_ns");
  task.response = time_at(at, "response_ns");
  task.jitter = time_at(at, "jitter_ns");
  if (task.mean > task.worst) at.at("mean_ns").refuse("is above worst_ns");
  if (task.samples > 0 && task.worst.count == 0) at.at("worst_ns").refuse("is 0 with samples");
  return task;
}

RecordedProfile profile_at(const JsonCursor& at) {
  at.expect_keys({"version", "subsystem", "tasks"}, {});
  if (at.at("version").whole() != kVersion) at.at("version").refuse("expected 1");
  RecordedProfile profile;
  profile.subsystem = name_at(at.at("subsystem"));
  const JsonCursor tasks = at.at("tasks");
  const std::size_t n = tasks.size(kMostTasks);
  for (std::size_t i = 0; i < n; ++i) {
    RecordedTask task = task_at(tasks.at(i));
    for (const RecordedTask& other : profile.tasks)
      if (other.task == task.task) tasks.at(i).at("task").refuse("task '" + task.task + "' comes twice");
    profile.tasks.push_back(std::move(task));
  }
  return profile;
}

Nanoseconds bounded(Nanoseconds time) { return {std::clamp<std::int64_t>(time.count, 0, kLongestPeriod)}; }

Error bad(const std::string& message, std::string_view where) {
  return {ErrorCode::kBadInput, {std::string_view(message)}, {where}};
}

}  // namespace

const RecordedTask* RecordedProfile::find(std::string_view task) const {
  for (const RecordedTask& recorded : tasks)
    if (recorded.task == task && recorded.samples > 0) return &recorded;
  return nullptr;
}

RecordedProfile recorded(const std::string& subsystem, std::span<const TaskProfile> tasks) {
  RecordedProfile made{subsystem, {}};
  for (const TaskProfile& task : tasks) {
    const Spread& cycle = task.profile.execution[CHIMERA_CYCLE];
    const Spread& delay = task.profile.start_delay;
    RecordedTask row{.task = task.task, .samples = 0, .worst = {}, .mean = {}, .response = {}, .jitter = {}};
    if (cycle.count > 0 && cycle.max.count > 0) {
      row.samples = std::min(cycle.count, kMostSamples);
      row.worst = bounded(cycle.max);
      row.mean = std::min(bounded(cycle.mean()), row.worst);
      row.response = task.profile.response.count == 0 ? Nanoseconds{} : bounded(task.profile.response.max);
      row.jitter = delay.count == 0 ? Nanoseconds{} : bounded(delay.max - delay.min);
    }
    made.tasks.push_back(std::move(row));
  }
  return made;
}

std::string to_json(const RecordedProfile& profile) {
  std::string rows;
  for (const RecordedTask& task : profile.tasks)
    rows += (rows.empty() ? "\n    " : ",\n    ") + spaced_json({{"task", task.task},
                                                                 {"samples", task.samples},
                                                                 {"worst_ns", task.worst.count},
                                                                 {"mean_ns", task.mean.count},
                                                                 {"response_ns", task.response.count},
                                                                 {"jitter_ns", task.jitter.count}});
  return "{\n  \"version\": 1,\n  \"subsystem\": " + json_string(profile.subsystem) + ",\n  \"tasks\": [" + rows +
         (rows.empty() ? "" : "\n  ") + "]\n}\n";
}

Result<RecordedProfile> parse_recorded_profile(std::string_view json) {
  try {
    const Json tree = read_json(json, kMostBytes, kNesting);
    return profile_at(JsonCursor(tree, "$"));
  } catch (const JsonRefusal& refusal) {
    return bad(refusal.message, "profile");
  }
}

Result<void> write_recorded_profile(const std::string& path, const RecordedProfile& profile) {
  auto part = PartFile::open(path);
  return part ? part->put(to_json(profile)) : part.error();
}

Result<void> may_write_recorded_profile(const std::string& path) {
  const auto part = PartFile::open(path);
  return part ? Result<void>() : part.error();
}

Result<RecordedProfile> read_recorded_profile(const std::string& path) {
  const auto read = read_ordinary(path, kMostBytes + 1);
  if (!read) return read.error();
  const std::string& text = *read;
  if (text.size() > kMostBytes) return bad("is larger than 256 KiB", path);
  auto profile = parse_recorded_profile(text);
  if (!profile)
    return bad("is no recorded profile: " + std::string(profile.error().message.view()) +
                   "; `chimera profile --save FILE` writes one",
               path);
  return profile;
}

}  // namespace chimera
