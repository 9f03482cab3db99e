// SPDX-License-Identifier: Apache-2.0
// What clients read of a legal model: the names, types and links that were solved, as texts.
#include "chimera/verify/configuration.h"

#include "chimera/verify/parts.h"
#include "chimera/verify/solve.h"
#include "chimera/verify/values.h"

namespace chimera {
namespace {

ConfiguredPort configured(const LinkedPort& port) {
  ConfiguredPort out;
  out.declared = port.index;
  out.instance = port.instance;
  out.kind = port.declared->kind;
  out.name = port.name;
  out.variable = port.variable;
  out.at = port.at;
  if (port.is(CHIMERA_RESOURCE)) return out;
  out.type = type_text(port);
  out.unit = port.unit_text.empty() ? "1" : port.unit_text;
  out.shape = shape_text(port.extents);
  return out;
}

ConfiguredTask configured(const TaskModel& task) {
  ConfiguredTask out;
  out.name = task.name();
  out.component = task.component->name;
  out.doc = task.component->doc;
  out.at = task.draft->name.at;
  out.rtpu = task.rtpu;
  out.rate_hz = task.rate_hz;
  out.is_aperiodic = task.component->is_aperiodic();
  out.has_event_source = task.component->event_source;
  out.is_hardware = task.has_resource();
  if (task.draft->standby_for) out.standby_for = task.draft->standby_for->text;
  for (const LinkedPort& port : task.ports) out.ports.push_back(configured(port));
  return out;
}

ConfiguredVariable configured(const Model& model, const VariableModel& variable) {
  ConfiguredVariable out;
  out.name = variable.name;
  out.is_constant = variable.is_constant;
  out.is_given = variable.given != nullptr;
  out.producers = variable.producers;
  out.consumers = variable.consumers;
  const LinkedPort* port = !variable.producers.empty()   ? &model.port(variable.producers[0])
                           : !variable.consumers.empty() ? &model.port(variable.consumers[0])
                                                         : nullptr;
  if (variable.given != nullptr)
    out.at = variable.given->name.at;
  else if (port != nullptr)
    out.at = port->at;
  if (port == nullptr) return out;  // given and used by nobody
  const ConfiguredPort like = configured(*port);
  out.type = like.type;
  out.unit = like.unit;
  out.shape = like.shape;
  return out;
}

}  // namespace

std::shared_ptr<const Configuration::Parts> make_parts(const Model& model) {
  auto parts = std::make_shared<Configuration::Parts>();
  parts->draft = model.draft;
  parts->start = model.start;
  parts->utilisation = model.utilisation;
  parts->init_order = model.init_order;
  for (const TaskModel& task : model.tasks) parts->tasks.push_back(configured(task));
  for (const VariableModel& variable : model.variables) parts->variables.push_back(configured(model, variable));
  for (const SetModel& set : model.sets) parts->sets.push_back({set.name, set.at, set.order});
  fill_spec(model, *parts);
  return parts;
}

const std::string& Configuration::file() const noexcept { return parts_->draft.file; }
const std::string& Configuration::subsystem() const noexcept { return parts_->draft.subsystem.text; }
std::span<const ConfiguredTask> Configuration::tasks() const noexcept { return parts_->tasks; }
std::span<const ConfiguredVariable> Configuration::variables() const noexcept { return parts_->variables; }
const ConfiguredVariable& Configuration::variable(VariableId id) const noexcept {
  return parts_->variables[parts_->configured[id.index]];
}
std::span<const ConfiguredSet> Configuration::sets() const noexcept { return parts_->sets; }
std::size_t Configuration::start() const noexcept { return parts_->start; }
std::span<const RtpuSpec> Configuration::rtpus() const noexcept { return parts_->rtpus; }
const Draft& Configuration::draft() const noexcept { return parts_->draft; }
const ApplicationSpec& Configuration::spec() const noexcept { return parts_->spec; }
std::span<const double> Configuration::utilisation() const noexcept { return parts_->utilisation; }

}  // namespace chimera
