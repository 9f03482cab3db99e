// SPDX-License-Identifier: Apache-2.0
// The bench behind a server of the control protocol: one descriptor to wait for, one time, one function to serve all.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "chimera/base/result.h"
#include "chimera/control/control_server.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"
#include "chimera/web/bench.h"

namespace chimera::web {

/// Context: setup; may block on the disk.
class BenchServer {
 public:
  BenchServer(BenchFacts facts, std::function<void(const std::string&)> tell)
      : bench_(std::move(facts), clock_, std::move(tell)) {}
  BenchServer(const BenchServer&) = delete;
  BenchServer& operator=(const BenchServer&) = delete;

  Result<void> open();
  /// Readable when serve() has something to do.
  int descriptor() const noexcept { return watched_.descriptor(); }
  /// Time when serve() is due even if nothing is readable.
  Nanoseconds next_due() const noexcept { return std::min(server_->next_due(), bench_.next_due()); }
  void serve();
  /// Takes over the server's end of a page.
  void enter(int connected);
  Bench& bench() noexcept { return bench_; }

 private:
  LinuxClock clock_;
  Bench bench_;
  std::unique_ptr<control::ControlServer> server_;
  DescriptorSet watched_;
};

}  // namespace chimera::web
