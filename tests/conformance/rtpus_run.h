// SPDX-License-Identifier: Apache-2.0
// For tests: one run of toys on several rtpus in virtual time, with what it left on its tap.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/virtual/virtual_rtpus.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {

class RtpusRun {
 public:
  /// The acts outlive it.
  RtpusRun(VirtualPeers& peers, std::span<const ScriptAct> acts, const VirtualOptions& how = {}) {
    RunOptions options;
    options.script = Script(acts);
    options.tap = listened_.tap();
    rtpus_ = std::make_unique<VirtualRtpus>(peers, options, how);
  }

  Result<void> start() { return rtpus_->start(); }
  RunEnd run(Nanoseconds duration) { return rtpus_->run(duration); }
  RunEnd run_to(Nanoseconds until) { return rtpus_->run_to(until); }
  void shut_down() { rtpus_->shut_down(); }
  Nanoseconds now() const { return rtpus_->now(); }
  std::vector<RefusedSignal> refused() { return rtpus_->refused(); }
  /// The records since the last call.
  std::vector<TapRecord> records() { return listened_.records(); }

 private:
  Listened listened_;
  std::unique_ptr<VirtualRtpus> rtpus_;
};

}  // namespace chimera::toy
