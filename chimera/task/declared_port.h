// SPDX-License-Identifier: Apache-2.0
// One view of the ports of a component, from its declarations or, in an image, from what its ports reported (wiring.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "chimera/task/abi.h"
#include "chimera/task/task_spec.h"
#include "chimera/task/wiring.h"

namespace chimera {

/// A port without its names. The source must live at least as long. Context: any; wait-free.
class DeclaredPort {
 public:
  DeclaredPort(const chimera_port_decl& decl) noexcept : decl_(&decl) {}  // NOLINT: a view of it
  DeclaredPort(const WiredPort& wired) noexcept : wired_(&wired) {}       // NOLINT: a view of it

  std::uint32_t kind() const noexcept { return decl_ != nullptr ? decl_->kind : wired_->form->kind; }
  std::uint32_t type() const noexcept { return decl_ != nullptr ? decl_->type : wired_->form->type; }
  std::uint32_t element_size() const noexcept {
    return decl_ != nullptr ? decl_->element_size : wired_->form->element_size;
  }
  bool is_repeated() const noexcept {
    return decl_ != nullptr ? (decl_->flags & CHIMERA_PORT_REPEATED) != 0 : wired_->form->max_instances != 0;
  }
  /// 1 unless it is repeated.
  std::uint32_t max_instances() const noexcept {
    if (decl_ != nullptr) return decl_->max_instances;
    return is_repeated() ? wired_->form->max_instances : 1;
  }
  /// The offset in the state of the chimera_port, or, if the port is repeated, of the array of max_instances().
  std::uint32_t live_offset() const noexcept { return decl_ != nullptr ? decl_->live_offset : wired_->live_offset; }
  /// The offset in the state of the uint32_t with the number of instances in use. Requires: is_repeated().
  std::uint32_t instances_offset() const noexcept {
    return decl_ != nullptr ? decl_->instances_offset : wired_->live_offset - component_api::kCounterToArray;
  }
  std::uint32_t n_fields() const noexcept { return decl_ != nullptr ? decl_->n_fields : wired_->form->n_fields; }
  /// Requires: index < n_fields().
  FieldForm field(std::uint32_t index) const noexcept {
    if (decl_ == nullptr) return wired_->form->field(index);
    const chimera_field& field = decl_->fields[index];
    return {field.type, field.offset, field.count, field.size};
  }

 private:
  const chimera_port_decl* decl_ = nullptr;
  const WiredPort* wired_ = nullptr;
};

/// The ports of a component by the index of their declaration. Context: any; wait-free.
class DeclaredPorts {
 public:
  DeclaredPorts() noexcept = default;
  /// The ports of a table with declarations.
  explicit DeclaredPorts(const chimera_component& component) noexcept
      : decls_(component.ports), size_(component.n_ports) {}
  explicit DeclaredPorts(std::span<const WiredPort> wired) noexcept
      : wired_(wired.data()), size_(static_cast<std::uint32_t>(wired.size())) {}

  std::size_t size() const noexcept { return size_; }
  /// Requires: index < size().
  DeclaredPort operator[](std::size_t index) const noexcept {
    if (decls_ != nullptr) return decls_[index];
    return wired_[index];
  }

 private:
  const chimera_port_decl* decls_ = nullptr;
  const WiredPort* wired_ = nullptr;
  std::uint32_t size_ = 0;
};

/// The declared name of a port, for messages: from the declaration, or, where there is none, from the specification.
/// Context: any; wait-free.
inline std::string_view name_of(const chimera_component& component, const PortSpec& port) noexcept {
  return component.ports != nullptr ? component.ports[port.declared].name : port.name;
}

}  // namespace chimera
