// SPDX-License-Identifier: Apache-2.0
// Whether a run went as it should: its last lines and its exit code. docs/formats/run.md, "How a run went".
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/analysis/task_profile.h"
#include "chimera/base/time.h"

namespace chimera::cli {

/// The result of one rtpu. Plain value.
struct RtpuFate {
  std::string name;
  std::uint64_t restarts = 0;
  Nanoseconds restarted = kNever;  ///< since the start of the run, the last time; kNever: not known
  bool is_given_up = false;        ///< dead, and not started again
  std::string bad_end = {};        ///< how it ended although all was to be turned off in order; "": in order
  std::string not_real_time = {};  ///< not_real_time() of its rights; "": real time, or virtual
  Nanoseconds died = kNever;       ///< since the start, in virtual time, where no rtpu is restarted; kNever: not
};

/// A task of which `off` or `kill` failed or was never run. Plain value.
struct NotOff {
  std::string task;
  std::string text;  ///< `not_off_text` (chimera/text/not_off.h)
};

/// Plain value.
struct RunVerdict {
  std::uint64_t missed = 0;   ///< deadlines, but for those that may be missed
  std::uint64_t dropped = 0;  ///< releases
  std::uint64_t faults = 0;
  std::uint64_t restarts = 0;         ///< of rtpus
  bool is_flag_up = false;            ///< at the end
  bool is_strict = false;             ///< whatever is not clean is a failure
  std::vector<std::string> remarks;   ///< what was not clean: "20 deadlines missed (pi 12, motor 8)"
  std::vector<std::string> since;     ///< "servo: counted since its restart at 3.214 s"
  std::vector<std::string> not_off;   ///< tasks whose hardware may not be off
  std::vector<std::string> failures;  ///< what makes the run a failure, strict or not

  bool is_clean() const noexcept { return remarks.empty() && failures.empty(); }
  bool is_failure() const noexcept { return !failures.empty() || (is_strict && !is_clean()); }
  /// The last lines for people. Context of all: setup.
  std::string text() const;
  /// One JSON object: docs/formats/run.md.
  std::string json() const;
};

/// Facts from which a verdict is made. `faults_before`: of each task before all tasks were turned off. Later faults are
/// faults at the end of the run, where `off` and `kill` cannot be repeated.
struct RunFacts {
  std::span<const TaskProfile> tasks;
  std::span<const std::uint64_t> faults_before;
  std::span<const RtpuFate> rtpus;
  bool is_flag_up = false;
  bool is_strict = false;
  std::span<const NotOff> not_off = {};  ///< from the subsystem's events; judge_run() adds those of `tasks`
};
RunVerdict judge_run(const RunFacts& facts);

/// "0.200", in seconds.
std::string seconds_text(Nanoseconds time);
/// "refused at 0.200 s: off pid: not legal in state ERROR" and a line end; `what` may be empty.
std::string refused_line(Nanoseconds since_start, const std::string& what, const std::string& why);

}  // namespace chimera::cli
