// SPDX-License-Identifier: Apache-2.0
// The scheduling records of a running subsystem, over a connection of their own: docs/formats/control.md, `tap`.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "chimera/cli/run/control_line.h"
#include "chimera/cli/run/run.h"
#include "chimera/runtime/application_spec.h"

namespace chimera::cli {

/// The names in a running subsystem, as a specification that has nothing else. Movable.
class TaskNames {
 public:
  /// From the answer of `status`.
  static TaskNames of(const Json& status);
  /// The configurations, too, from the answer of `describe`: their names, without tasks.
  void add_configurations(const Json& described);
  /// Points into this.
  ApplicationSpec spec() const noexcept;

  std::string subsystem;
  std::deque<std::string> tasks, rtpus, configurations;

 private:
  std::vector<TaskSpec> task_specs_;
  std::vector<RtpuSpec> rtpu_specs_;
  std::vector<NamedSet> sets_;
};

/// Context: setup; blocks.
class RecordLine {
 public:
  /// `names` outlives it.
  RecordLine(const std::string& socket, const TaskNames& names) : names_(names), line_(socket) {}

  enum class From : unsigned char { kOldest, kNow };
  Result<void> subscribe(From from);
  /// Hands what comes until `instant` to `sink`; returns with the first, or earlier when a signal came.
  void poll(Nanoseconds instant, RecordSink& sink);
  /// Hands on what is there, and ends.
  void finish(RecordSink& sink);

 private:
  const TaskNames& names_;
  ControlLine line_;
  std::uint64_t lost_ = 0, missed_ = 0;
};

}  // namespace chimera::cli
