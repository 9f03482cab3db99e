// SPDX-License-Identifier: Apache-2.0
// Collects samples of watched variables, draws them and writes them down.
#include "chimera/cli/run/watch_plot.h"

#include <algorithm>

#include "chimera/base/hosted/wording.h"

namespace chimera::cli {

void WatchPlot::add_sample(Nanoseconds at, std::span<const Probe> probes) {
  if (first_.empty()) {
    for (const Probe& probe : probes) {
      first_.push_back(curves_.size());
      const auto names = number_names(probe), units = number_units(probe);
      for (std::size_t n = 0; n < names.size(); ++n) curves_.push_back({names[n], units[n], {}, 0, true});
    }
    first_.push_back(curves_.size());
  }
  samples_.push_back(at);
  for (std::size_t p = 0; p < probes.size(); ++p) {
    const Seen seen = probes[p].sample();
    if (points_ + seen.numbers.size() > kMostPoints) return;
    const std::size_t n = std::min(seen.numbers.size(), first_[p + 1] - first_[p]);
    for (std::size_t i = 0; i < n; ++i) curves_[first_[p] + i].points.push_back({to_seconds(at), seen.numbers[i]});
    points_ += n;
  }
}

draw::Plot WatchPlot::plot(const std::string& title) const {
  draw::Plot plot;
  plot.title = title;
  plot.curves = curves_;
  return plot;
}

std::string WatchPlot::csv() const {
  std::string text = "t(s)";
  for (const draw::Curve& curve : curves_) text += "," + curve.name + "(" + curve.unit + ")";
  text += "\n";
  std::vector<std::size_t> next(curves_.size());
  for (const Nanoseconds at : samples_) {
    text += formatted("%.9f", to_seconds(at));
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      const auto& points = curves_[c].points;
      const bool is_there = next[c] < points.size() && points[next[c]].at == to_seconds(at);
      text += is_there ? formatted(",%.17g", points[next[c]++].value) : std::string(",");
    }
    text += "\n";
  }
  return text;
}

}  // namespace chimera::cli
