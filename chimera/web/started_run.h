// SPDX-License-Identifier: Apache-2.0
// `start` and `output`: a `chimera run FILE` in a session of its own, which goes on when chimera-web ends.
#pragma once

#include <string>

#include "chimera/control/rpc_response.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/process.h"

namespace chimera::web {

/// Context: setup; may block on the disk.
class StartedRun {
 public:
  static constexpr std::size_t kShown = std::size_t{16} << 10;    ///< bytes of an answer of `output`
  static constexpr std::size_t kMaxBytes = std::size_t{4} << 20;  ///< of the file, while chimera-web runs

  /// `program`: of chimera. `folder`: of the file with the output, or "".
  StartedRun(std::string program, std::string folder) : program_(std::move(program)), folder_(std::move(folder)) {}

  /// Runs FILE. Refuses while the process that it started before lives.
  control::RpcResponse start(const std::string& file);
  control::RpcResponse output() const;

  /// Readable when the process has ended; -1: none runs.
  int descriptor() const noexcept { return process_.pidfd(); }
  /// Collects a process that has ended, and bounds its output, at most once a second.
  void serve(Nanoseconds now);

 private:
  std::string program_, folder_;
  Process process_;
  OwnedDescriptor output_;
  pid_t pid_ = 0;  // of the last process
  std::string ended_;
  Nanoseconds bounded_at_{INT64_MIN / 2};
};

}  // namespace chimera::web
