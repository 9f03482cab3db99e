// SPDX-License-Identifier: Apache-2.0
// `chimera run`, as asked for; and as it goes in one process: in virtual time, or in real time for debugging.
#pragma once

#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chimera/cli/files/file_refusal.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/cli/run/application.h"
#include "chimera/runtime/record/tap_record.h"
#include "chimera/verify/setting.h"

namespace chimera::cli {

struct RunRequest {
  std::string file;
  Nanoseconds duration = kNever;     ///< until a signal of the operating system ends it
  Nanoseconds start_limit = kNever;  ///< real time: tasks that are not ON after it end the run
  bool virtual_time = false;
  bool one_process = false;           ///< real time without other processes
  bool preemptive = false;            ///< virtual time only
  std::optional<std::uint64_t> seed;  ///< virtual time only
  Nanoseconds quantum = milliseconds(1);
  int priority = 80;                  ///< SCHED_FIFO, real time only; 0: as an ordinary process
  std::vector<std::string> may_miss;  ///< real time: tasks that need not be guaranteed to keep their deadlines
  std::vector<Setting> settings;      ///< values in the place of those of the file
  std::vector<std::string> at;        ///< timed acts, script_text.h
  std::vector<std::string> expect;    ///< expectation.h
  std::vector<std::string> watch;     ///< state variables to print while it runs
  Nanoseconds every;                  ///< how often; 0: every second, into a picture at the shortest period
  std::string svg;                    ///< draw them to this file instead; virtual time only
  std::string csv;                    ///< write them as a table to this file instead; virtual time only
  std::string digest;                 ///< write digest.h to this file; virtual time only, and jobs take no time
  std::string profile;                ///< save the profile into this file at the end; "": not
  std::string log;                    ///< add the events to this file as they come; "": not
  bool json = false;
  bool strict = false;  ///< a run that was not clean (run_verdict.h) is no success

  /// Watched values go to files, and are not printed.
  bool keeps_samples() const noexcept { return !svg.empty() || !csv.empty(); }
};

/// Takes the tap's records in order while the run goes on. Context: setup thread.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  /// `origin` is that of the grid of releases, `start` the beginning of the run; kNever: its first release on record.
  virtual void begin(const ApplicationSpec& spec, Nanoseconds origin, Nanoseconds start) = 0;
  virtual void on_records(std::span<const TapRecord> records) = 0;
  /// `lost` records were overwritten before they were read; `missed` of those before the first that was read.
  virtual void end(std::uint64_t lost, std::uint64_t missed) = 0;
};

/// Runs in this process and reports on `out` and `err`; answers the exit code: kOk when it ran to its end and every
/// expectation holds. `sink` may be null. Blocks for the duration.
int run(const RunRequest& request, const Workplace& workplace, RecordSink* sink, std::FILE* out, std::FILE* err);

/// Asks a running run() or attend() to end; for signal handlers.
void request_stop() noexcept;
bool stop_is_requested() noexcept;

}  // namespace chimera::cli
