// SPDX-License-Identifier: Apache-2.0
#include "chimera/runtime/task_set.h"

#include <cstring>

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
  for (std::size_t t = 0; t < instances_.size(); ++t) instances_[t].destroy(tasks_[t]);
}

Result<void> TaskSet::build(std::span<const chimera_component* const> components) {
  const std::size_t n = spec_.tasks.size();
  std::vector<std::vector<std::uint32_t>> kinds(n);
  instances_.reserve(n);
  for (std::size_t t = 0; t < n; ++t) {
    auto instance = Instance::create(spec_.tasks[t], *components[t]);
    if (!instance) return instance.error();
    instances_.push_back(*std::move(instance));
    for (const PortSpec& port : spec_.tasks[t].ports) kinds[t].push_back(components[t]->ports[port.declared].kind);
  }
  variables_ = std::make_unique<Variables>(spec_, kinds);
  tasks_.resize(n);
  contexts_.resize(n);
  on_.assign(n, false);
  for (std::size_t t = 0; t < n; ++t) {
    Task& task = tasks_[t];
    task.spec = &spec_.tasks[t];
    task.component = components[t];
    task.id = TaskId(t);
    contexts_[t] = {this, &task};
    task.call.fault = &task.faults.last;
    task.call.host = &kHost;
    task.call.context = &contexts_[t];
    task.inputs = instances_[t].inputs();
  }
  for (const Variable& variable : variables_->all()) {
    if (!variable.producers.empty() || variable.operator_index != UINT32_MAX) continue;
    const std::string_view reader = spec_.tasks[variable.consumers[0].task.index].name;
    return Error{ErrorCode::kBadInput, {"nobody produces state variable " + std::string(variable.name)}, {reader}};
  }
  set_constants();
  bind_operators();
  bind_all();
  return {};
}

void TaskSet::set_constants() {
  for (const Instance& instance : instances_)
    for (const ConstantPort& port : instance.constants())
      if (!port.spec->variable.empty())
        constants_.declare(port.spec->variable, port.spec->type, port.spec->max_bytes());
  for (const GivenSpec& given : spec_.constants) {
    constants_.declare(given.name, given.type, given.value.size());
    constants_.set(given.name, given.value, TaskId{});
  }
}

void TaskSet::bind_operators() {
  std::size_t bytes = 0;
  for (const GivenSpec& given : spec_.operators) {
    operator_offsets_.push_back(static_cast<std::uint32_t>(bytes));
    bytes += group_bytes(given.value.size());
  }
  operator_memory_ = AlignedBytes(bytes, kCacheLine);
  for (std::size_t o = 0; o < spec_.operators.size(); ++o) {
    const auto value = spec_.operators[o].value;
    GroupWriter writer(operator_memory_.span().subspan(operator_offsets_[o]), static_cast<std::uint32_t>(value.size()));
    std::memcpy(writer.staging(), value.data(), value.size());
    writer.publish(Nanoseconds{}, 1);
  }
}

// Until a producer goes ON its consumers look at the initial values, or the never-written fill, of the first one.
void TaskSet::bind_all() noexcept {
  sources_.resize(variables_->all().size());
  for (std::size_t v = 0; v < sources_.size(); ++v) {
    const Variable& variable = variables_->all()[v];
    if (variable.operator_index != UINT32_MAX) {
      const std::uint32_t o = variable.operator_index;
      const auto size = static_cast<std::uint32_t>(spec_.operators[o].value.size());
      bind(VariableId(v), {GroupReader(operator_memory_.data() + operator_offsets_[o], size), 0, 0, TaskId{}});
    } else if (!variable.producers.empty()) {
      const PortOf& first = variable.producers[0];
      const Instance& instance = instances_[first.task.index];
      bind(VariableId(v), {instance.reader(), instance.output_offset(first.index), first.index, first.task});
    }
  }
}

void TaskSet::bind(VariableId variable, const Source& source) noexcept {
  sources_[variable.index] = source;
  for (const PortOf& consumer : variables_->all()[variable.index].consumers) {
    Input& input = tasks_[consumer.task.index].inputs[consumer.index];
    input.producer = source.reader;
    input.offset = source.offset;
    input.bit = source.bit;
    input.sequence = 0;
  }
}

void TaskSet::bind_outputs_of(Task& task) noexcept {
  const Instance& instance = instances_[task.id.index];
  for (std::uint32_t i = 0; i < task.outputs.size(); ++i)
    bind(variables_->output(task.id, i), {instance.reader(), task.outputs[i].offset, i, task.id});
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
  const Instance& producer = instances_[source.task.index];
  view.spec = producer.output_spec(source.bit);
  const chimera_port* port = producer.output_port(source.bit);
  view.count = port == nullptr ? view.spec->max_count() : port->count;
  return view;
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
