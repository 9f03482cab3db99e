// SPDX-License-Identifier: Apache-2.0
// The outputs that `chimera run` makes from the records of the tap: a trace file and a timeline.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "chimera/cli/run/run.h"

/// Context: setup thread.
class RecordFiles final : public chimera::cli::RecordSink {
 public:
  /// `trace` empty: no file; `unit` 0: no timeline.
  RecordFiles(const std::string& trace, chimera::Nanoseconds unit, chimera::Nanoseconds duration);
  ~RecordFiles() override;

  bool is_open() const noexcept { return why_.empty(); }
  const std::string& why() const noexcept { return why_; }
  void begin(const chimera::ApplicationSpec& spec, chimera::Nanoseconds origin,
             chimera::Nanoseconds start) override;
  void on_records(std::span<const chimera::TapRecord> records) override;
  void end(std::uint64_t lost, std::uint64_t missed) override;
  /// Prints the timeline and closes the file; false when something was lost or could not be written.
  bool finish(std::FILE* out, std::FILE* err);

 private:
  struct Trace;
  void print_timelines(std::FILE* out) const;
  std::unique_ptr<Trace> trace_;
  std::string why_;
  chimera::Nanoseconds unit_, duration_, start_;
  chimera::Nanoseconds first_release_ = chimera::kNever;
  std::vector<chimera::TapRecord> kept_;  ///< for the timeline
  std::vector<std::string> names_, rtpus_;
  std::uint64_t lost_ = 0, missed_ = 0;
  int write_error_ = 0;  ///< errno of the first failure that was seen
};
