// SPDX-License-Identifier: Apache-2.0
// Finds the paths from sensors to actuators in a set of tasks, and the worst age of data on each.
#include <algorithm>

#include "chimera/analysis/schedule_parts.h"
#include "chimera/schedule/data_age.h"
#include "chimera/verify/board_links.h"

namespace chimera {
namespace {

constexpr std::size_t kMostPaths = 200;
constexpr std::size_t kMostSteps = 100'000;  // of the search, paths or not

class Walk {
 public:
  Walk(const Configuration& configuration, const SetWorks& set, const std::vector<WorkVerdict>& verdicts,
       SetSchedule& schedule)
      : configuration_(configuration), set_(set), verdicts_(verdicts), schedule_(schedule), next_(set.tasks.size()) {
    for (const ConfiguredVariable& variable : configuration.variables()) {
      if (variable.is_constant) continue;
      for (const PortRef& from : variable.producers)
        for (const PortRef& to : variable.consumers) link(place_of(from.task), place_of(to.task));
    }
    for (auto& next : next_) {
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
    }
  }

  void go() {
    for (std::size_t i = 0; i < set_.tasks.size(); ++i) {
      if (!is_hardware(i)) continue;
      path_ = {i};
      step();
    }
    std::stable_sort(schedule_.paths.begin(), schedule_.paths.end(),
                     [](const PathAge& a, const PathAge& b) { return a.age > b.age; });
  }

 private:
  std::size_t place_of(std::size_t task) const {
    const auto at = std::find(set_.tasks.begin(), set_.tasks.end(), task);
    return static_cast<std::size_t>(at - set_.tasks.begin());
  }
  void link(std::size_t from, std::size_t to) {
    if (from < next_.size() && to < next_.size()) next_[from].push_back(to);
  }
  bool is_hardware(std::size_t i) const { return configuration_.tasks()[set_.tasks[i]].is_hardware; }

  void step() {
    for (const std::size_t to : next_[path_.back()]) {
      if (++steps_ > kMostSteps || schedule_.paths.size() == kMostPaths) {
        schedule_.has_more_paths = true;
        return;
      }
      if (is_hardware(to)) {
        path_.push_back(to);
        keep();
        path_.pop_back();
      } else if (std::find(path_.begin(), path_.end(), to) == path_.end()) {
        path_.push_back(to);
        step();
        path_.pop_back();
      }
    }
  }

  void keep() {
    std::vector<ChainLink> chain;
    PathAge path;
    for (std::size_t k = 0; k < path_.size(); ++k) {
      const std::size_t i = path_[k];
      const Work& work = set_.works[i];
      // No event, no job: the age of what it passes on has no bound.
      const bool has_events = configuration_.spec().tasks[set_.tasks[i]].has_events;
      const bool is_promised = verdicts_[i].guarantee == Guarantee::kYes && !has_events;
      ChainLink link{.work = work, .response = is_promised ? verdicts_[i].response : kNever};
      if (k + 1 < path_.size()) {
        const std::size_t to = path_[k + 1];
        link.goes_before_next =
            i != to && goes_always_before(work, static_cast<std::uint32_t>(set_.tasks[i]), set_.works[to],
                                          static_cast<std::uint32_t>(set_.tasks[to]), set_.uses[work.rtpu]);
      }
      chain.push_back(link);
      path.tasks.push_back(set_.tasks[i]);
    }
    path.age = worst_data_age(chain);
    for (std::size_t k = 0; k + 1 < path_.size() && path.age != kNever; ++k)
      path.age += link_delay(configuration_.spec(), TaskId(path.tasks[k]), TaskId(path.tasks[k + 1]));
    schedule_.paths.push_back(std::move(path));
  }

  const Configuration& configuration_;
  const SetWorks& set_;
  const std::vector<WorkVerdict>& verdicts_;
  SetSchedule& schedule_;
  std::vector<std::vector<std::size_t>> next_;
  std::vector<std::size_t> path_;
  std::size_t steps_ = 0;
};

}  // namespace

void find_paths(const Configuration& configuration, const SetWorks& set, const std::vector<WorkVerdict>& verdicts,
                SetSchedule& schedule) {
  Walk(configuration, set, verdicts, schedule).go();
}

}  // namespace chimera
