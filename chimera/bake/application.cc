// SPDX-License-Identifier: Apache-2.0
// Copies the tasks of a configuration and replaces what belongs to the machine of the description.
#include "chimera/bake/application.h"

#include <algorithm>
#include <cstring>

#include "chimera/bake/room.h"

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
    for (PortSpec& port : ports) fit(port, configuration_.spec());
    task.ports = ports;
    const auto is_for_it = [&task](const EventLine& event) { return event.task.text == task.name; };
    task.has_events = task.has_events || std::ranges::any_of(target.events, is_for_it);
    if (profile == nullptr) task.budget = task.min_time = {};
    tasks_.push_back(task);
  }
  spec_.tasks = tasks_;
  operators_.assign(spec_.operators.begin(), spec_.operators.end());
  for (GivenSpec& given : operators_) fit(given, configuration_.spec());
  spec_.operators = operators_;
  constants_.assign(spec_.constants.begin(), spec_.constants.end());
  for (std::size_t c = 0; c < constants_.size(); ++c) fit(constants_[c], ConstantId(c), spec_);
  spec_.constants = constants_;
  const std::span<const SwitchPlan> plans = plans_.emplace(spec_, profile).all();
  if (!plans.empty()) spec_.plans = plans.data();
}

std::vector<ScriptAct> BakedApplication::acts(std::span<const ScriptAct> acts) const {
  std::vector<ScriptAct> fitted(acts.begin(), acts.end());
  for (ScriptAct& act : fitted) {
    if (act.kind != ScriptAct::Kind::kSet) continue;
    const std::size_t room = spec_.operators[act.operator_index].value.size();
    if (act.value.size() > room) act.value = act.value.first(room);
  }
  return fitted;
}

}  // namespace chimera::bake
