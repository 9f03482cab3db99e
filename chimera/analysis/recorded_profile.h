// SPDX-License-Identifier: Apache-2.0
// Measured times of tasks in a file: `chimera profile --save` writes it, `chimera schedule --profile` reads it.
// The format is docs/formats/profile.md.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/analysis/task_profile.h"
#include "chimera/base/result.h"
#include "chimera/base/time.h"

namespace chimera {

/// One task. Times of the method `cycle`, transfers included; all 0 without samples.
struct RecordedTask {
  std::string task;
  std::uint64_t samples = 0;  ///< cycles that were measured
  Nanoseconds worst, mean;    ///< execution time
  Nanoseconds response;       ///< longest, from release to end
  Nanoseconds jitter;         ///< latest start minus earliest, each counted from its release
};

struct RecordedProfile {
  std::string subsystem;
  std::vector<RecordedTask> tasks;

  /// The task of that name with at least one sample; nullptr: there is none.
  const RecordedTask* find(std::string_view task) const;
};

/// The measured times of the tasks. A task whose cycles took no measurable time has no samples. Context: setup.
RecordedProfile recorded(const std::string& subsystem, std::span<const TaskProfile> tasks);

/// The file's text, with a line end. Context: setup.
std::string to_json(const RecordedProfile& profile);

/// Reads such a text. Refuses, naming the place in it ("$.tasks[2].worst_ns"): what is no JSON, an unknown, missing or
/// repeated key or task, another version, a number out of range, a mean above the worst. Context: setup.
Result<RecordedProfile> parse_recorded_profile(std::string_view json);

/// Replaces the file at `path` by the profile, in one step: no reader finds half of it. Refuses, and leaves the file as
/// it was: a folder that cannot be written, a path that is no ordinary file. Context: setup; may block.
Result<void> write_recorded_profile(const std::string& path, const RecordedProfile& profile);
/// Refuses if write_recorded_profile() would, as far as it is known before. Context: setup; may block.
Result<void> may_write_recorded_profile(const std::string& path);

/// Reads the file at `path`; refuses one above the size limit unread. Context: setup; may block.
Result<RecordedProfile> read_recorded_profile(const std::string& path);

}  // namespace chimera
