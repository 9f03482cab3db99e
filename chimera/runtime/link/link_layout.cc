// SPDX-License-Identifier: Apache-2.0
// Finds imports and exports of an rtpu, and hashes what both sides must agree on.
#include "chimera/runtime/link/link_layout.h"

#include <algorithm>

#include "chimera/table/slot.h"

namespace chimera::board_link {
namespace {

/// FNV-1a, 32 bits.
class LinkHash {
 public:
  void add(std::string_view text) noexcept {
    for (const char c : text) step(static_cast<unsigned char>(c));
    step(0);
  }
  void add(std::uint64_t number) noexcept {
    for (int i = 0; i < 8; ++i) step(static_cast<unsigned char>(number >> 8 * i));
  }
  void add(std::span<const std::byte> bytes) noexcept {
    for (const std::byte byte : bytes) step(std::to_integer<unsigned char>(byte));
    add(bytes.size());
  }
  void add(Nanoseconds time) noexcept { add(static_cast<std::uint64_t>(time.count)); }
  std::uint32_t value() const noexcept { return value_; }

 private:
  void step(unsigned char byte) noexcept { value_ = (value_ ^ byte) * 0x01000193u; }

  std::uint32_t value_ = 0x811c9dc5u;
};

bool is_on(const ApplicationSpec& spec, RtpuId rtpu, TaskId task) noexcept {
  return spec.tasks[task.index].rtpu == rtpu;
}

/// Budgets, reactions and resource texts may differ: they belong to the side that runs the task.
void add(LinkHash& hash, const ApplicationSpec& spec, const TaskSpec& task) noexcept {
  hash.add(task.name);
  hash.add(task.component);
  hash.add(task.period);
  hash.add(task.offset);
  for (const PortSpec& port : task.ports) {
    if (port.kind == CHIMERA_RESOURCE) continue;
    hash.add(spec.link_name(port));
    for (const std::uint64_t number : {port.declared, port.kind, port.instance, port.type, port.max_bytes()})
      hash.add(number);
    hash.add(port.value);
    if (port.constant.is_valid()) hash.add(spec.constants[port.constant.index].value);
  }
}

}  // namespace

const PortSpec* import_port(const ApplicationSpec& spec, RtpuId rtpu, const Variable& variable) noexcept {
  for (const PortOf& producer : variable.producers)
    if (is_on(spec, rtpu, producer.task)) return nullptr;
  for (const PortOf& consumer : variable.consumers)
    if (is_on(spec, rtpu, consumer.task)) return spec.port(CHIMERA_IN_VAR, consumer);
  return nullptr;
}

LinkSize LinkSize::of(const ApplicationSpec& spec, RtpuId rtpu) noexcept {
  LinkSize size;
  for (const TaskSpec& task : spec.tasks) size.tasks += task.rtpu == rtpu ? 1 : 0;
  for (const Variable& variable : spec.variables) size.imports += import_port(spec, rtpu, variable) != nullptr ? 1 : 0;
  return size;
}

void LinkLayout::plan(const ApplicationSpec& spec, RtpuId rtpu, SetupMemory& memory) {
  const LinkSize size = LinkSize::of(spec, rtpu);
  imports_ = memory.take<Import>(std::min(size.imports, kMostImports));
  exports_ = memory.take<Export>(std::min(size.tasks, kMostTasks));
  LinkHash hash;
  std::size_t n = 0;
  for (std::size_t t = 0; t < spec.tasks.size(); ++t) {
    if (spec.tasks[t].rtpu != rtpu || n == exports_.size()) continue;
    std::uint32_t bytes = 0;
    for (const PortSpec& port : spec.tasks[t].ports)
      if (port.kind == CHIMERA_OUT_VAR) bytes += static_cast<std::uint32_t>(round_to_value(port.max_bytes()));
    exports_[n++] = {TaskId(t), bytes, export_bytes_};
    export_bytes_ += bytes;
    add(hash, spec, spec.tasks[t]);
  }
  n = 0;
  for (std::size_t v = 0; v < spec.variables.size() && n < imports_.size(); ++v)
    if (const PortSpec* port = import_port(spec, rtpu, spec.variables[v]))
      imports_[n++] = {VariableId(v), port->max_bytes(), 0};
  std::sort(imports_.begin(), imports_.end(), [&](const Import& a, const Import& b) {
    return spec.variables[a.variable.index].name < spec.variables[b.variable.index].name;
  });
  for (Import& import : imports_) {
    import.offset = import_bytes_;
    import_bytes_ += static_cast<std::uint32_t>(round_to_value(import.bytes));
    hash.add(spec.variables[import.variable.index].name);
    hash.add(import.bytes);
  }
  hash_ = hash.value();
}

}  // namespace chimera::board_link
