// SPDX-License-Identifier: Apache-2.0
// Part of the test bench for one component (chimera/task/rig.h): the component and the values behind its ports.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/fields.h"
#include "chimera/task/registry.h"

namespace chimera {

/// The component of that name in this program; throws std::invalid_argument if there is none. Context: setup.
inline const chimera_component& linked_component(const std::string& name) {
  std::uint32_t count = 0;
  const chimera_component* const* all = chimera_components(CHIMERA_ABI_VERSION, &count);
  for (std::uint32_t i = 0; i < count; ++i)
    if (all[i]->name == name) return *all[i];
  throw std::invalid_argument("no component " + name + " is linked into this test");
}

/// A constructed component. A port that does not exist, or a value of the wrong size, throws std::invalid_argument,
/// because the test is wrong. Context: setup.
class RigPorts {
 public:
  /// Sets the number of instances of a repeated port; its maximum by default. Call it before init().
  void instances(const char* port, std::uint32_t count) {
    const chimera_port_decl& decl = declaration(port);
    if (count > decl.max_instances) throw std::invalid_argument(std::string(port) + " has fewer instances at most");
    std::memcpy(state_.get() + decl.instances_offset, &count, sizeof count);
  }
  /// Sets an extent that no constant of the component gives; its maximum by default.
  void extent(const char* symbol, std::uint32_t size) {
    fixed_.push_back({symbol, size, 1});
    fix_extents();
  }
  /// Sets the shape of a matrix whose extents no constant of the component gives.
  void shape(const char* symbol, std::uint32_t rows, std::uint32_t columns) {
    fixed_.push_back({symbol, rows, columns});
    fix_extents();
  }
  /// Sets the element type of a port of any type: T = bool, std::int32_t, std::int64_t, float; double by default. Call
  /// it before init() and set().
  template <class T>
  void type(const char* port, std::size_t instance = 0) {
    Cell& cell = cell_of(port, instance);
    if (cell.decl->type != CHIMERA_ANY) throw std::invalid_argument(std::string(port) + " has a type of its own");
    cell.live->type = component_api::element_type<T>();
    cell.live->element_size = sizeof(T);
  }
  /// The text of a resource port.
  void resource(const char* port, const char* text) {
    Cell& cell = cell_of(port, 0);
    cell.memory = std::make_unique<std::byte[]>(std::strlen(text) + 1);
    std::memcpy(cell.memory.get(), text, std::strlen(text) + 1);
    cell.live->value = cell.memory.get();
  }

  /// Sets the answers of Cycle::variable() and unit() for a port; by default the name of the port and no unit.
  void joined(const char* port, const char* variable, const char* unit, std::size_t instance = 0) {
    cell_of(port, instance).joined = {variable, unit};
  }

  /// Sets the answers of Cycle::configuration() and incarnation(); by default none and 1.
  void configuration(const std::string& name) { configuration_ = name; }
  void incarnation(std::uint32_t number) { incarnation_ = number; }

  /// Publishes a value to an in-var, or sets a constant: element `i` of instance `instance`.
  template <class T>
  void set(const char* port, const T& value, std::size_t i = 0, std::size_t instance = 0) {
    Cell& cell = cell_of(port, instance);
    at<T>(cell, i) = value;
    cell.live->value = cell.memory.get();
    cell.slot.sequence += 1;
    cell.slot.valid = ~std::uint64_t{0};
    cell.slot.published_ns = *now_ns_;
    fix_extents();
  }
  /// Sets the value that an out-var holds at the next on(): published `age` before by a task of that period. Call set()
  /// for its elements first. kNever, the default: no task has published it.
  void inherit(const char* port, Nanoseconds age, Nanoseconds period = milliseconds(1)) {
    for (auto& cell : cells_) {
      if (cell->decl != &declaration(port)) continue;
      if (cell->decl->kind != CHIMERA_OUT_VAR) throw std::invalid_argument(std::string(port) + " is no out-var");
      cell->inherited = {{*now_ns_ - age.count, 1, ~std::uint64_t{0}, 0}, age.count, period.count};
      cell->live->slot = age == kNever ? nullptr : &cell->inherited.slot;
    }
  }
  /// The present value of element `i` of instance `instance`.
  template <class T>
  T get(const char* port, std::size_t i = 0, std::size_t instance = 0) {
    return at<T>(cell_of(port, instance), i);
  }
  /// Elements in use.
  std::uint32_t size(const char* port) { return cell_of(port, 0).live->count; }

 protected:
  /// Throws if the constructor fails. The ports measure age against `now_ns`.
  RigPorts(const char* component, const std::int64_t* now_ns)
      : component_(linked_component(component)), state_(make_state(component_), {&component_}), now_ns_(now_ns) {
    for (std::uint32_t i = 0; i < component_.n_ports; ++i) add_port(component_.ports[i]);
  }
  RigPorts(const RigPorts&) = delete;
  RigPorts& operator=(const RigPorts&) = delete;
  ~RigPorts() = default;

  /// For chimera_host, whose context is the whole rig.
  template <class Whole>
  static chimera_text host_configuration(void* rig) {
    const std::string& name = static_cast<Whole*>(rig)->configuration_;
    return {name.data(), static_cast<std::uint32_t>(name.size())};
  }
  template <class Whole>
  static std::uint32_t host_incarnation(void* rig) {
    return static_cast<Whole*>(rig)->incarnation_;
  }
  const chimera_component& component() const { return component_; }
  std::byte* state() const { return state_.get(); }
  struct Joined {
    std::string variable, unit;
  };
  const Joined& joined(const chimera_port* port) const {
    for (const auto& cell : cells_)
      if (cell->live == port) return cell->joined;
    throw std::invalid_argument("a port of another component");
  }
  /// Marks all inputs as read: they are no longer fresh.
  void see_all() {
    for (auto& cell : cells_) cell->live->seen = cell->slot.sequence;
  }
  /// Sets the shape of every port from the present constants.
  void fix_extents() {
    for (auto& cell : cells_) {
      chimera_port& live = *cell->live;
      for (int d = 0; d < 2; ++d) live.extent[d] = extent_of(*cell->decl, d, false);
      live.count = live.extent[0] * live.extent[1];
    }
  }

 private:
  std::string configuration_;  // the answer of Cycle::configuration()
  std::uint32_t incarnation_ = 1;
  struct Cell {
    const chimera_port_decl* decl;
    chimera_port* live;
    std::size_t instance;
    chimera_slot slot{};
    chimera_inherited inherited{};
    std::unique_ptr<std::byte[]> memory;
    Joined joined{};
  };
  struct Fixed {
    std::string symbol;
    std::uint32_t size, columns;
  };
  struct Destroy {
    const chimera_component* component;
    void operator()(std::byte* state) const {
      component->destroy(state);
      ::operator delete(state, std::align_val_t{64});
    }
  };

  static std::byte* make_state(const chimera_component& component) {
    auto* state = static_cast<std::byte*>(::operator new(component.state_size + 1u, std::align_val_t{64}));
    std::memset(state, 0, component.state_size);
    chimera_fault fault{};
    if (component.construct(state, &fault) == CHIMERA_OK) return state;
    ::operator delete(state, std::align_val_t{64});
    throw std::runtime_error(fault.text);
  }

  void add_port(const chimera_port_decl& decl) {
    if ((decl.flags & CHIMERA_PORT_REPEATED) != 0) instances(decl.name, decl.max_instances);
    auto* live = reinterpret_cast<chimera_port*>(state_.get() + decl.live_offset);
    for (std::size_t i = 0; i < decl.max_instances; ++i) {
      cells_.push_back(std::make_unique<Cell>());
      Cell& cell = *cells_.back();
      cell.decl = &decl;
      cell.live = live + i;
      cell.instance = i;
      cell.joined = {decl.max_instances > 1 ? decl.name + ("[" + std::to_string(i) + "]") : decl.name, "1"};
      cell.live->type = decl.type == CHIMERA_ANY ? std::uint32_t{CHIMERA_FLOAT64} : decl.type;
      cell.live->element_size = decl.element_size;
      cell.live->now_ns = now_ns_;
      if (decl.kind == CHIMERA_IN_VAR) cell.live->slot = &cell.slot;
      if (decl.kind != CHIMERA_RESOURCE) fill(cell);
    }
    fix_extents();
  }

  /// Sets the values of a port at spawn: the initial value; without one, NaN for floating numbers and zero for all
  /// others.
  void fill(Cell& cell) {
    const chimera_port_decl& decl = *cell.decl;
    const std::size_t count = extent_of(decl, 0, true) * extent_of(decl, 1, true);
    cell.memory = std::make_unique<std::byte[]>(count * decl.element_size);
    for (std::size_t i = 0; i < count; ++i) {
      std::byte* to = cell.memory.get() + i * decl.element_size;
      if ((decl.flags & CHIMERA_PORT_HAS_INITIAL) != 0) {
        const std::size_t from = decl.initial_count == 1 ? 0 : i;
        std::memcpy(to, static_cast<const std::byte*>(decl.initial) + from * decl.element_size, decl.element_size);
      } else if (cell.live->type == CHIMERA_FLOAT64) {
        const double nan = std::nan("");
        std::memcpy(to, &nan, sizeof nan);
      } else if (cell.live->type == CHIMERA_FLOAT32) {
        const float nan = std::nanf("");
        std::memcpy(to, &nan, sizeof nan);
      }
    }
    const bool is_given = decl.kind != CHIMERA_IN_CONST || (decl.flags & CHIMERA_PORT_HAS_INITIAL) != 0;
    if (is_given) cell.live->value = cell.memory.get();
  }

  /// Extent `dimension` of a shape: a literal, the value of a constant, the extent from extent() or shape(), or the
  /// maximum. 1 beyond the last dimension.
  std::uint32_t extent_of(const chimera_port_decl& decl, int dimension, bool maximum) {
    const char* at = decl.shape;
    const bool is_shape = std::strstr(at, "...<=") != nullptr;
    for (int d = dimension; d > 0 && *at != '\0' && !is_shape; --d) at = std::strchr(at, ']') + 1;
    if (*at == '\0') return 1;
    const char* bound = std::strstr(at, "<=");
    const char* end = std::strchr(at, ']');
    if (bound == nullptr || bound > end) return static_cast<std::uint32_t>(std::atoi(at + 1));
    const std::uint32_t most = is_shape && dimension > 0 ? 1 : static_cast<std::uint32_t>(std::atoi(bound + 2));
    const std::string symbol(at + 1, is_shape ? bound - 3 : bound);
    return maximum ? most : symbol_value(symbol, most, is_shape ? dimension : 0);
  }
  std::uint32_t symbol_value(const std::string& symbol, std::uint32_t most, int dimension) {
    for (const auto& cell : cells_) {
      if (symbol != cell->decl->name || cell->live->value == nullptr) continue;
      const bool is_small = cell->decl->type == CHIMERA_INT32;
      const std::int64_t value = is_small ? at<std::int32_t>(*cell, 0) : at<std::int64_t>(*cell, 0);
      return value >= 1 && value <= most ? static_cast<std::uint32_t>(value) : most;
    }
    for (const Fixed& fixed : fixed_)
      if (fixed.symbol == symbol) return dimension == 0 ? fixed.size : fixed.columns;
    return most;
  }
  const chimera_port_decl& declaration(const char* port) const {
    for (std::uint32_t i = 0; i < component_.n_ports; ++i)
      if (std::strcmp(component_.ports[i].name, port) == 0) return component_.ports[i];
    throw std::invalid_argument(std::string(component_.name) + " has no port " + port);
  }
  Cell& cell_of(const char* port, std::size_t instance) {
    const chimera_port_decl& decl = declaration(port);
    for (auto& cell : cells_)
      if (cell->decl == &decl && cell->instance == instance) return *cell;
    throw std::invalid_argument(std::string(port) + " has fewer instances");
  }
  template <class T>
  T& at(Cell& cell, std::size_t i) {
    if (sizeof(T) != cell.live->element_size)
      throw std::invalid_argument(std::string(cell.decl->name) + " has elements of another size");
    if (i >= std::size_t{extent_of(*cell.decl, 0, true)} * extent_of(*cell.decl, 1, true))
      throw std::invalid_argument(std::string(cell.decl->name) + " has fewer elements");
    return *reinterpret_cast<T*>(cell.memory.get() + i * sizeof(T));
  }

  const chimera_component& component_;
  std::unique_ptr<std::byte, Destroy> state_;
  const std::int64_t* now_ns_;
  std::vector<std::unique_ptr<Cell>> cells_;
  std::vector<Fixed> fixed_;
};

}  // namespace chimera
