// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/task_set.h"

#include <algorithm>

namespace chimera {

const chimera_host TaskSet::kHost = {&TaskSet::host_expired, &TaskSet::host_signal, &TaskSet::host_spend};

Result<std::unique_ptr<TaskSet>> TaskSet::create(const ApplicationSpec& spec,
                                                 std::span<const chimera_component* const> components) {
  CHIMERA_ASSERT(components.size() == spec.tasks.size());
  std::unique_ptr<TaskSet> made(new TaskSet(spec));
  if (auto built = made->build(components); !built) return built.error();
  return made;
}

TaskSet::~TaskSet() {
  for (std::size_t t = 0; t < memories_.size(); ++t) memories_[t].destroy(tasks_[t]);
}

Result<void> TaskSet::build(std::span<const chimera_component* const> components) {
  const std::size_t n = spec_.tasks.size();
  memories_.reserve(n);
  for (std::size_t t = 0; t < n; ++t) {
    auto memory = TaskMemory::create(spec_.tasks[t], *components[t]);
    if (!memory) return memory.error();
    memories_.push_back(*std::move(memory));
  }
  variables_ = std::make_unique<Variables>(spec_);
  tasks_.resize(n);
  contexts_.resize(n);
  on_.assign(n, false);
  wanted_.assign(n, false);
  for (std::size_t t = 0; t < n; ++t) {
    Task& task = tasks_[t];
    task.spec = &spec_.tasks[t];
    task.component = components[t];
    task.id = TaskId(t);
    contexts_[t] = {this, &task};
    task.call.fault = &task.said;
    task.call.host = &kHost;
    task.call.context = &contexts_[t];
    task.inputs = memories_[t].inputs();
  }
  for (const Variable& variable : variables_->all()) {
    if (!variable.producers.empty() || variable.operator_index != UINT32_MAX) continue;
    const std::string_view reader = spec_.tasks[variable.consumers[0].task.index].name;
    return Error{ErrorCode::kBadInput, {"nobody produces state variable " + std::string(variable.name)}, {reader}};
  }
  if (auto laid = lay_out(); !laid) return laid;
  set_constants();
  place_operators();
  bind_all();
  return {};
}

Result<void> TaskSet::lay_out() {
  std::vector<GroupSpec> specs;
  for (const TaskMemory& memory : memories_) specs.insert(specs.end(), 2, memory.group_spec());
  std::vector<VariableSpec> operators;
  for (const GivenSpec& given : spec_.operators)
    operators.push_back({given.name, given.element_bytes, given.extent[0].max * given.extent[1].max});
  for (const VariableSpec& variable : operators) specs.push_back({"operator", {&variable, 1}});
  groups_.resize(specs.size());
  places_.resize(TableLayout::count_variables(specs));
  const auto layout = TableLayout::plan(specs, UINT64_MAX, groups_, places_);
  if (!layout) return layout.error();
  table_ = AlignedBytes(layout->region_bytes(), kCacheLine);
  for (std::size_t t = 0; t < memories_.size(); ++t) {
    const GroupPlace& place = groups_[2 * t];
    memories_[t].place(group_memory(2 * t), group_memory(2 * t + 1), place.payload_bytes,
                       std::span(places_).subspan(place.first_variable, place.variables));
  }
  return {};
}

std::span<std::byte> TaskSet::group_memory(std::size_t group) const noexcept {
  return table_.span().subspan(groups_[group].offset, group_bytes(groups_[group].payload_bytes));
}

void TaskSet::set_constants() {
  for (const TaskMemory& memory : memories_)
    for (const ConstantPort& port : memory.constants())
      if (!port.spec->variable.empty())
        constants_.declare(port.spec->variable, port.spec->type, port.spec->max_bytes());
  for (const GivenSpec& given : spec_.constants) {
    constants_.declare(given.name, given.type, given.value.size());
    constants_.set(given.name, given.value, TaskId{});
  }
}

void TaskSet::place_operators() {
  for (std::size_t o = 0; o < spec_.operators.size(); ++o) {
    const std::size_t group = 2 * tasks_.size() + o;
    GroupWriter writer(group_memory(group), groups_[group].payload_bytes);
    const auto value = spec_.operators[o].value;
    std::copy(value.begin(), value.end(), writer.staging());
    writer.publish(Nanoseconds{}, 1);
  }
}

// Until a producer goes ON its consumers look at the initial values, or the never-written fill, of the first one.
void TaskSet::bind_all() {
  sources_.resize(variables_->all().size());
  for (std::size_t v = 0; v < sources_.size(); ++v) {
    const Variable& variable = variables_->all()[v];
    if (variable.operator_index != UINT32_MAX) {
      const std::size_t group = 2 * tasks_.size() + variable.operator_index;
      bind(VariableId(v), {GroupReader(group_memory(group).data(), groups_[group].payload_bytes), 0, 0, TaskId{}});
    } else if (!variable.producers.empty()) {
      const PortOf& first = variable.producers[0];
      const TaskMemory& memory = memories_[first.task.index];
      bind(VariableId(v), {memory.reader(), memory.output_offset(first.index), first.index, first.task});
    }
  }
}

// The operator lives in another context than the tasks: what it writes is copied through the register.
GroupInput TaskSet::input_from(const Source& source) {
  if (source.task.is_valid()) return GroupInput::direct(source.reader);
  local_memory_.emplace_back(local_group_bytes(source.reader.payload_bytes()), kCacheLine);
  locals_.emplace_back(source.reader, local_memory_.back().span());
  return GroupInput::copied(locals_.back());
}

void TaskSet::bind(VariableId variable, const Source& source) {
  sources_[variable.index] = source;
  for (const PortOf& consumer : variables_->all()[variable.index].consumers) {
    Input& input = tasks_[consumer.task.index].inputs[consumer.index];
    input.group = input_from(source);
    input.offset = source.offset;
    input.bit = source.bit;
    input.sequence = 0;
  }
}

void TaskSet::bind_outputs_of(Task& task) {
  const TaskMemory& memory = memories_[task.id.index];
  for (std::uint32_t i = 0; i < task.outputs.size(); ++i)
    bind(variables_->output(task.id, i), {memory.reader(), task.outputs[i].offset, i, task.id});
}

TaskId TaskSet::find(std::string_view name) const noexcept {
  for (const Task& task : tasks_)
    if (task.spec->name == name) return task.id;
  return TaskId{};
}

VariableView TaskSet::view(std::size_t index) const noexcept {
  const Source& source = sources_[index];
  const chimera_slot* slot = source.reader.published();
  if (slot == nullptr) return {};
  VariableView view;
  view.slot = slot;
  view.value = reinterpret_cast<const std::byte*>(slot + 1) + source.offset;
  view.is_valid = ((slot->valid >> source.bit) & 1u) != 0;
  if (!source.task.is_valid()) {
    const GivenSpec& given = spec_.operators[variables_->all()[index].operator_index];
    view.count = given.extent[0].max * given.extent[1].max;
    return view;
  }
  const TaskMemory& producer = memories_[source.task.index];
  view.spec = producer.output_spec(source.bit);
  const chimera_port* port = producer.output_port(source.bit);
  view.count = port == nullptr ? view.spec->max_count() : port->count;
  return view;
}

std::vector<VariableReader> TaskSet::readers_of(std::size_t index) const {
  std::vector<VariableReader> readers;
  const auto add = [&](std::size_t group, std::uint32_t offset, std::uint32_t bit) {
    readers.push_back({GroupReader(group_memory(group).data(), groups_[group].payload_bytes), offset, bit});
  };
  const Variable& variable = variables_->all()[index];
  if (variable.operator_index != UINT32_MAX) add(2 * tasks_.size() + variable.operator_index, 0, 0);
  for (const PortOf& producer : variable.producers)
    for (std::size_t half = 0; half < 2; ++half)
      add(2 * producer.task.index + half, memories_[producer.task.index].output_offset(producer.index), producer.index);
  return readers;
}

void TaskSet::deliver(Task& task) noexcept {
  for (const SentSignal& sent : task.outbox) {
    Task& target = tasks_[sent.target.index];
    if (target.pending.try_push(sent.signal)) ++n_pending_;
    else if (sent.signal == Signal::kKill) target.pending[target.pending.size() - 1] = Signal::kKill;
  }
  task.outbox.clear();
}

bool TaskSet::take_pending(Task& task, Signal& signal) noexcept {
  if (task.pending.empty()) return false;
  signal = task.pending[0];
  for (std::size_t i = 1; i < task.pending.size(); ++i) task.pending[i - 1] = task.pending[i];
  task.pending.pop_back();
  --n_pending_;
  return true;
}

void TaskSet::on_set_changed() noexcept {
  for (const Task& task : tasks_) on_[task.id.index] = task.state == State::kOn;
  on_set_legal_ = variables_->is_legal(on_);
}

std::int32_t TaskSet::host_expired(void* context) {
  const auto* host = static_cast<HostContext*>(context);
  return host->set->clock_->now().count > host->task->call.deadline_ns ? 1 : 0;
}

std::int32_t TaskSet::host_signal(void* context, std::uint32_t signal, const char* name) {
  const auto* host = static_cast<HostContext*>(context);
  const TaskId target = name == nullptr ? host->task->id : host->set->find(name);
  const bool is_sendable = signal < CHIMERA_SIGNAL_WAKEUP;
  if (!target.is_valid() || !is_sendable) return CHIMERA_FAULT;
  return host->task->outbox.try_push({static_cast<Signal>(signal), target}) ? CHIMERA_OK : CHIMERA_FAULT;
}

void TaskSet::host_spend(void* context, std::int64_t ns) {
  static_cast<HostContext*>(context)->set->clock_->spend(Nanoseconds{ns});
}

}  // namespace chimera
