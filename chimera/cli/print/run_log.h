// SPDX-License-Identifier: Apache-2.0
// The file of `chimera run --log`: the events of the run as lines, added as they come.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>

#include "chimera/cli/print/event_lines.h"
#include "chimera/cli/print/outlet.h"
#include "chimera/platform/descriptor.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// Never waits for the disk but in finish(). Context: setup.
class RunLog {
 public:
  RunLog(std::string path, OwnedDescriptor file)
      : path_(std::move(path)), file_(std::move(file)), outlet_(file_.fd) {}

  /// Events come in order. One that came before is left out.
  void add(const Json& event);
  /// Says once on `err` that lines are lost.
  void report_loss(std::FILE* err);
  /// Waits until all is written, `limit` at most. Returns the loss as one line; "": there is none.
  std::string finish(Nanoseconds limit);

 private:
  std::string loss() const;

  std::string path_;
  OwnedDescriptor file_;
  Outlet outlet_;
  EventLines lines_ = EventLines({}, true, INT64_MIN, true);
  std::uint64_t last_ = 0;  // number of the last event
  bool is_reported_ = false;
};

}  // namespace chimera::cli
