// SPDX-License-Identifier: Apache-2.0
// Watched variables over the time of a run as a picture or a table: `chimera run --virtual --watch q --every '10 ms'
// --svg q.svg --csv q.csv`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/cli/run/application.h"
#include "chimera/draw/plot.h"

namespace chimera::cli {

/// Context: setup.
class WatchPlot {
 public:
  static constexpr std::size_t kMostPoints = 1'000'000;  ///< of all curves together; more are left out

  /// The values of `probes` at `at`; the same probes at each call. One that was not written yet has no point.
  void add_sample(Nanoseconds at, std::span<const Probe> probes);
  /// A curve for each number: "q[0]". Context: setup.
  draw::Plot plot(const std::string& title) const;
  /// A heading "t(s),q[0](rad),..." and a line for each sample; what was not written then is empty. Context: setup.
  std::string csv() const;

 private:
  std::vector<draw::Curve> curves_;
  std::vector<std::size_t> first_;  ///< curve of each probe
  std::vector<Nanoseconds> samples_;
  std::size_t points_ = 0;
};

}  // namespace chimera::cli
