// SPDX-License-Identifier: Apache-2.0
// Verifies a description, loads its components, makes its tasks, and reads their variables.
#include "chimera/cli/run/application.h"

#include <algorithm>
#include <atomic>
#include <map>

#include "chimera/cli/run/under_way.h"
#include "chimera/load/shared_object.h"
#include "chimera/runtime/hosted/variables.h"
#include "chimera/runtime/making.h"

namespace chimera::cli {
namespace {

// All tasks of one component share its object: static variables of a component are its own business.
Result<const chimera_component*> open(const LibraryEntry& entry, std::map<std::string, SharedObject>& opened) {
  auto found = opened.find(entry.object_file);
  if (found == opened.end()) {
    auto object = SharedObject::open(entry.object_file);
    if (!object) return object.error();
    found = opened.emplace(entry.object_file, *std::move(object)).first;
  }
  return found->second.matching(entry.descriptor);
}

std::vector<FieldDescriptor> fields_of(const chimera_port_decl& decl) {
  std::vector<FieldDescriptor> fields;
  for (std::uint32_t f = 0; f < decl.n_fields; ++f) {
    const chimera_field& field = decl.fields[f];
    fields.push_back({field.name, field.unit, field.type, field.offset, field.count, field.size});
  }
  return fields;
}

}  // namespace

bool are_on_several_rtpus(const Configuration& configuration) noexcept {
  const auto tasks = configuration.tasks();
  const auto is_elsewhere = [&](const ConfiguredTask& task) { return task.rtpu != tasks[0].rtpu; };
  return std::any_of(tasks.begin(), tasks.end(), is_elsewhere);
}

Result<Application> Application::load(Configuration configuration, const Library& library, Contexts contexts) {
  Application made(std::move(configuration));
  std::map<std::string, SharedObject> opened;
  UnderWay& told = under_way();
  told.know(made.configuration_, library);
  for (const ConfiguredTask& task : made.configuration_.tasks()) {
    show_making(told.making, made.components_.size(), Making::kLoads);
    const LibraryEntry* entry = library.find(task.component);
    CHIMERA_ASSERT(entry != nullptr);  // verified
    auto component = open(*entry, opened);
    if (!component) return component.error();
    made.components_.push_back(*component);
  }
  ContextPlace place;
  place.running = &told.running;
  place.serving = &told.serving;
  place.making = &told.making;
  show_made(told.making);
  if (auto made_all = made.make_contexts(place, contexts); !made_all) return made_all.error();
  return made;
}

Result<void> Application::make_contexts(ContextPlace place, Contexts contexts) {
  const bool is_by_rtpu = contexts == Contexts::kByRtpu && are_on_several_rtpus(configuration_);
  contexts_.resize(is_by_rtpu ? spec().rtpus.size() : 1);
  if (is_by_rtpu) {
    auto peers = VirtualPeers::create(spec());
    if (!peers) return peers.error();
    peers_ = *std::move(peers);
    place.others = peers_.get();
  }
  for (std::size_t r = 0; r < contexts_.size(); ++r) {
    const auto is_there = [r](const TaskSpec& task) { return task.rtpu.index == r; };
    if (is_by_rtpu && std::none_of(spec().tasks.begin(), spec().tasks.end(), is_there)) continue;
    if (is_by_rtpu) place.rtpu = RtpuId(r);
    auto tasks = HeapTaskSet::create(spec(), components_, place);
    if (!tasks) return tasks.error();
    contexts_[r] = *std::move(tasks);
    if (is_by_rtpu) peers_->join(RtpuId(r), *contexts_[r]);
  }
  return {};
}

TaskSet& Application::context_of(TaskId task) const noexcept {
  return *contexts_[peers_ == nullptr ? 0 : spec().tasks[task.index].rtpu.index];
}

std::vector<const Task*> Application::all_tasks() const {
  std::vector<const Task*> all;
  for (std::size_t t = 0; t < spec().tasks.size(); ++t) all.push_back(&context_of(TaskId(t)).tasks()[t]);
  return all;
}

std::vector<State> Application::states() const {
  std::vector<State> states;
  for (const Task* task : all_tasks())
    states.push_back(peers_ == nullptr ? task->shown_state() : peers_->state(task->id));
  return states;
}

bool Application::is_flag_up() const noexcept {
  return peers_ == nullptr ? contexts_[0]->flag().is_up() : peers_->is_flag_up();
}

// With several contexts what does not depend on the present value, from the first producer that is ON, else from the
// first one.
VariableView Application::view(VariableId variable) const noexcept {
  const Variable& of = spec().variables[variable.index];
  if (peers_ == nullptr) return contexts_[0]->sources().view(variable);
  VariableView view;
  if (of.is_given()) {
    const GivenSpec& given = spec().operators[of.operator_index];
    view.count = given.extent[0].max * given.extent[1].max;
    return view;
  }
  const PortOf* producer = of.producer([this](TaskId task) { return peers_->state(task) == State::kOn; });
  if (producer == nullptr) producer = of.producers.data();
  const TaskMemory& memory = context_of(producer->task).memory(producer->task);
  const chimera_port* port = memory.output_port(producer->index);
  view.spec = memory.output_spec(producer->index);
  view.count = port == nullptr ? view.spec->max_count() : port->count;
  return view;
}

Result<Probe> Application::probe(const std::string& variable) const {
  const auto found = find_variable(configuration_, variable);
  if (!found) return found.error();
  const auto all = spec().variables;
  const std::size_t index = Variables(spec()).find(variable);
  CHIMERA_ASSERT(index < all.size());  // whatever is configured is laid out
  Probe probe;
  probe.name = variable;
  if (const std::uint32_t by_operator = all[index].operator_index; all[index].is_given()) {
    const GroupReader reader = peers_ == nullptr ? contexts_[0]->table().operators()[by_operator]
                                                 : peers_->operator_variable(by_operator);
    probe.readers.push_back({reader, 0, 0});
    probe.producers.push_back(nullptr);
  }
  for (const PortOf& producer : all[index].producers)
    for (std::uint32_t half = 0; half < 2; ++half) {
      probe.readers.push_back(context_of(producer.task).table().reader_of(producer, half));
      probe.producers.push_back(&context_of(producer.task).tasks()[producer.task.index]);
    }
  const WrittenUnit& written = (*found)->written;
  probe.form.unit = (*found)->unit;
  probe.form.shown = written.text, probe.form.factor = written.from.factor, probe.form.offset = written.from.offset;
  probe.form.is_scalar = (*found)->shape.empty();
  const VariableView view = this->view(VariableId(index));
  probe.form.count = view.count;
  if (view.spec != nullptr) {
    const PortOf& producer = all[index].producers[0];
    probe.form.type = view.spec->type;
    probe.form.element_bytes = view.spec->element_bytes;
    probe.form.fields = fields_of(components_[producer.task.index]->ports[view.spec->declared]);
  } else {
    const GivenSpec& given = spec().operators[all[index].operator_index];
    probe.form.type = given.type;
    probe.form.element_bytes = given.element_bytes;
  }
  return probe;
}

namespace {

// True if the values of the producer count: a task that is armed for a switch, or has left by one, is not ON. Relaxed,
// pairs with nothing: it chooses between values that both were written.
bool is_in_force(const Task* producer) {
  if (producer == nullptr) return true;
  return std::atomic_ref(const_cast<State&>(producer->state)).load(std::memory_order_relaxed) == State::kOn;
}

}  // namespace

bool Probe::read(std::vector<std::byte>& value) const {
  std::vector<bool> in_force;  // read once: a state may change during this call
  for (const Task* producer : producers) in_force.push_back(is_in_force(producer));
  const bool has_one = std::find(in_force.begin(), in_force.end(), true) != in_force.end();
  std::int64_t latest = INT64_MIN;
  bool is_valid = false;
  std::vector<std::byte> payload;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    if (has_one && !in_force[i]) continue;
    const auto& [reader, offset, bit] = readers[i];
    chimera_slot slot;
    payload.resize(reader.payload_bytes());
    if (!reader.try_read(slot, payload.data()) || slot.published_ns < latest) continue;
    latest = slot.published_ns;
    const auto begin = payload.begin() + offset;
    value.assign(begin, begin + form.count * form.element_bytes);
    is_valid = ((slot.valid >> bit) & 1u) != 0;
  }
  return is_valid;
}

Seen Probe::sample() const {
  std::vector<std::byte> bytes;
  if (!read(bytes)) return {};
  return {true, value_text(form, bytes), numbers(form, bytes)};
}

// Numbers of one element: of a struct all those of its fields.
std::vector<std::string> number_names(const Probe& probe) {
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

std::vector<std::string> number_units(const Probe& probe) {
  std::vector<std::string> of_one;
  if (probe.form.type != CHIMERA_STRUCT) of_one.push_back(probe.form.unit);
  for (const FieldDescriptor& field : probe.form.fields)
    if (field.type != CHIMERA_STRING) of_one.insert(of_one.end(), field.count, field.unit);
  std::vector<std::string> units;
  for (std::uint32_t e = 0; e < probe.form.count; ++e) units.insert(units.end(), of_one.begin(), of_one.end());
  return units;
}

}  // namespace chimera::cli
