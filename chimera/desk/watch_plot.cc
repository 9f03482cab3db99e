// SPDX-License-Identifier: Apache-2.0
#include "chimera/desk/watch_plot.h"

#include <algorithm>

namespace chimera::desk {
namespace {

// Numbers of one element: of a struct all those of its fields.
std::vector<std::string> names_of(const Probe& probe) {
  std::vector<std::string> ends;
  if (probe.form.type != CHIMERA_STRUCT) ends.emplace_back();
  for (const FieldDescriptor& field : probe.form.fields)
    for (std::uint32_t i = 0; i < field.count && field.type != CHIMERA_STRING; ++i)
      ends.push_back("." + field.name + (field.count == 1 ? "" : "[" + std::to_string(i) + "]"));
  std::vector<std::string> names;
  for (std::uint32_t e = 0; e < probe.form.count; ++e)
    for (const std::string& end : ends)
      names.push_back(probe.name + (probe.form.is_scalar ? "" : "[" + std::to_string(e) + "]") + end);
  return names;
}

std::vector<std::string> units_of(const Probe& probe) {
  std::vector<std::string> units;
  if (probe.form.type != CHIMERA_STRUCT) units.push_back(probe.form.unit);
  for (const FieldDescriptor& field : probe.form.fields)
    if (field.type != CHIMERA_STRING) units.insert(units.end(), field.count, field.unit);
  return units;
}

}  // namespace

void WatchPlot::take(Nanoseconds at, std::span<const Probe> probes) {
  if (first_.empty()) {
    for (const Probe& probe : probes) {
      first_.push_back(curves_.size());
      const auto units = units_of(probe);
      std::size_t n = 0;
      for (const std::string& name : names_of(probe)) curves_.push_back({name, units[n++ % units.size()], {}, 0, true});
    }
    first_.push_back(curves_.size());
  }
  for (std::size_t p = 0; p < probes.size(); ++p) {
    const Seen seen = probes[p].look();
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

}  // namespace chimera::desk
