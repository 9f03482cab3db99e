// SPDX-License-Identifier: Apache-2.0
// Copies the tasks of a configuration and replaces what belongs to the machine of the description.
#include "chimera/bake/application.h"

#include <cstring>

namespace chimera::bake {

std::string declared_name(const ConfiguredPort& port) { return port.name.substr(0, port.name.find('[')); }

BakedApplication::BakedApplication(const Configuration& configuration, const Target& target,
                                   const RecordedProfile* profile)
    : configuration_(configuration), spec_(configuration.spec()) {
  ports_.reserve(spec_.tasks.size());
  for (std::size_t t = 0; t < spec_.tasks.size(); ++t) {
    TaskSpec task = spec_.tasks[t];
    std::vector<PortSpec>& ports = ports_.emplace_back(task.ports.begin(), task.ports.end());
    for (std::size_t p = 0; p < ports.size(); ++p) {
      if (ports[p].kind != CHIMERA_RESOURCE) continue;
      const auto* texts = target.resource(task.name, declared_name(configuration_.tasks()[t].ports[p]));
      if (texts == nullptr || ports[p].instance >= texts->texts.size()) continue;  // refused by resource_refusals()
      const std::string& text = texts->texts[ports[p].instance].text;
      std::vector<std::byte>& bytes = texts_.emplace_back(text.size());
      if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
      ports[p].value = bytes;
    }
    task.ports = ports;
    if (profile == nullptr) task.budget = task.min_time = {};
    tasks_.push_back(task);
  }
  spec_.tasks = tasks_;
  const std::span<const SwitchPlan> plans = plans_.emplace(spec_, profile).all();
  if (!plans.empty()) spec_.plans = plans.data();
}

}  // namespace chimera::bake
