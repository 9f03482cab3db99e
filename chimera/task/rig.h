// SPDX-License-Identifier: Apache-2.0
// A test bench for one component: sets its inputs, calls its methods with stepped time, shows its outputs. For tests
// of components only; it knows nothing of states, deadlines or other tasks.
//
//   Rig rig("tderiv");                    // a component linked into this test, C++ or C
//   rig.set("x", 1.0);
//   EXPECT_TRUE(rig.init()); EXPECT_TRUE(rig.on());
//   rig.set("x", 1.5);
//   EXPECT_TRUE(rig.cycle(milliseconds(100)));
//   EXPECT_DOUBLE_EQ(rig.get<double>("dx"), 5.0);
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
#include "chimera/task/registry.h"
#include "chimera/task/signal.h"
#include "chimera/task/text.h"

namespace chimera {

/// What a method answered: true for CHIMERA_OK.
struct RigAnswer {
  std::int32_t status = CHIMERA_OK;
  std::int32_t code = 0;
  std::string text;

  explicit operator bool() const noexcept { return status == CHIMERA_OK; }
};

/// One component under test. A name that does not exist, or a value of the wrong size, throws
/// std::invalid_argument: the test is wrong then. Context: setup.
class Rig {
 public:
  /// Finds the component of that name in this program and constructs it; throws when its constructor fails.
  explicit Rig(const char* component) : component_(find(component)), state_(make_state(*component_), {component_}) {
    for (std::uint32_t i = 0; i < component_->n_ports; ++i) add_port(component_->ports[i]);
    call_.host = &kHost;
    call_.context = this;
    call_.deadline_ns = kNever.count;
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// How many instances a repeated port has; its maximum until said. Call it before init().
  void instances(const char* port, std::uint32_t count) {
    const chimera_port_decl& decl = declaration(port);
    if (count > decl.max_instances) throw std::invalid_argument(std::string(port) + " has fewer instances at most");
    std::memcpy(state_.get() + decl.instances_offset, &count, sizeof count);
  }
  /// Fixes an extent that no constant of the component gives; its maximum until said.
  void extent(const char* symbol, std::uint32_t size) {
    fixed_.push_back({symbol, size, 1});
    fix_extents();
  }
  /// Fixes a shape that nothing of the component gives to a matrix.
  void shape(const char* symbol, std::uint32_t rows, std::uint32_t columns) {
    fixed_.push_back({symbol, rows, columns});
    fix_extents();
  }
  /// The text of a resource port.
  void resource(const char* port, const char* text) {
    Cell& cell = cell_of(port, 0);
    cell.memory = std::make_unique<std::byte[]>(std::strlen(text) + 1);
    std::memcpy(cell.memory.get(), text, std::strlen(text) + 1);
    cell.live->value = cell.memory.get();
  }

  /// Publishes a value to an in-var, or gives a constant: element `i` of instance `instance`.
  template <class T>
  void set(const char* port, const T& value, std::size_t i = 0, std::size_t instance = 0) {
    Cell& cell = cell_of(port, instance);
    at<T>(cell, i) = value;
    cell.live->value = cell.memory.get();
    cell.slot.sequence += 1;
    cell.slot.valid = ~std::uint64_t{0};
    cell.slot.published_ns = call_.now_ns;
    fix_extents();
  }
  /// Element `i` of instance `instance` as it stands.
  template <class T>
  T get(const char* port, std::size_t i = 0, std::size_t instance = 0) {
    return at<T>(cell_of(port, instance), i);
  }
  /// Elements in use.
  std::uint32_t size(const char* port) { return cell_of(port, 0).live->count; }

  RigAnswer init() { return run(Method::kInit); }
  RigAnswer reinit() { return run(Method::kReinit); }
  RigAnswer on() { return run(Method::kOn); }
  /// Steps time by `dt`, then calls sync(): CHIMERA_NO_EVENT when there was none.
  RigAnswer sync(Nanoseconds dt = milliseconds(1)) {
    call_.now_ns += dt.count;
    return run(Method::kSync);
  }
  /// Steps time by `dt`, then calls cycle().
  RigAnswer cycle(Nanoseconds dt = milliseconds(1)) {
    call_.now_ns += dt.count;
    call_.dt_ns = dt.count;
    RigAnswer answer = run(Method::kCycle);
    if (answer) ++call_.cycle;
    for (auto& cell : cells_) cell->live->seen = cell->slot.sequence;
    return answer;
  }
  /// cycle() `n` times in steps of `dt` and nothing beside it, for measuring; the status of the last.
  std::int32_t repeat(std::uint64_t n, Nanoseconds dt) {
    chimera_fault fault{};
    call_.fault = &fault;
    call_.dt_ns = dt.count;
    std::int32_t status = CHIMERA_OK;
    const chimera_method function = component_->methods[CHIMERA_CYCLE];
    for (; n > 0; --n) {
      call_.now_ns += dt.count;
      status = function(state_.get(), &call_);
    }
    call_.fault = nullptr;
    return status;
  }
  RigAnswer off() { return run(Method::kOff); }
  RigAnswer kill() { return run(Method::kKill); }
  RigAnswer error() { return run(Method::kError); }
  RigAnswer clear() { return run(Method::kClear); }
  /// What the framework's thread without real-time rights calls; true when the component has none.
  RigAnswer background() {
    if (component_->background == nullptr) return {};
    chimera_fault fault{};
    const std::int32_t status = component_->background(state_.get(), &fault);
    return {status, fault.code, fault.text};
  }

  /// The descriptor its events come from; below 0: there is none.
  int event_source() {
    return component_->event_source == nullptr ? -1 : static_cast<int>(component_->event_source(state_.get()));
  }

  /// What Cycle::expired(), illegal() and dropped() say from now on.
  void expire(bool is_expired) { expired_ = is_expired; }
  void illegal(bool is_illegal) { call_.illegal = is_illegal ? 1 : 0; }
  void dropped(std::uint32_t count) { call_.dropped = count; }
  /// Execution time used through Cycle::spend() so far.
  Nanoseconds spent() const { return spent_; }
  /// The signals sent so far, as "off pid"; to itself "off".
  const std::vector<std::string>& signals() const { return signals_; }

 private:
  struct Cell {
    const chimera_port_decl* decl;
    chimera_port* live;
    std::size_t instance;
    chimera_slot slot{};
    std::unique_ptr<std::byte[]> memory;
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

  static const chimera_component* find(const char* name) {
    std::uint32_t count = 0;
    const chimera_component* const* all = chimera_components(CHIMERA_ABI_VERSION, &count);
    for (std::uint32_t i = 0; i < count; ++i)
      if (std::strcmp(all[i]->name, name) == 0) return all[i];
    throw std::invalid_argument(std::string("no component ") + name + " is linked into this test");
  }
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
      cell.live->type = decl.type == CHIMERA_ANY ? std::uint32_t{CHIMERA_FLOAT64} : decl.type;
      cell.live->element_size = decl.element_size;
      cell.live->now_ns = &call_.now_ns;
      if (decl.kind == CHIMERA_IN_VAR) cell.live->slot = &cell.slot;
      if (decl.kind != CHIMERA_RESOURCE) fill(cell);
    }
    fix_extents();
  }

  /// As a task finds it at spawn: the initial value, else NaN for floating numbers and zero for the rest.
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

  /// Extent `dimension` of a shape: literal, a constant's value, what extent() or shape() said, or the maximum; 1
  /// beyond the last.
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
  void fix_extents() {
    for (auto& cell : cells_) {
      chimera_port& live = *cell->live;
      for (int d = 0; d < 2; ++d) live.extent[d] = extent_of(*cell->decl, d, false);
      live.count = live.extent[0] * live.extent[1];
    }
  }

  const chimera_port_decl& declaration(const char* port) const {
    for (std::uint32_t i = 0; i < component_->n_ports; ++i)
      if (std::strcmp(component_->ports[i].name, port) == 0) return component_->ports[i];
    throw std::invalid_argument(std::string(component_->name) + " has no port " + port);
  }
  Cell& cell_of(const char* port, std::size_t instance) {
    const chimera_port_decl& decl = declaration(port);
    for (auto& cell : cells_)
      if (cell->decl == &decl && cell->instance == instance) return *cell;
    throw std::invalid_argument(std::string(port) + " has fewer instances");
  }
  template <class T>
  T& at(Cell& cell, std::size_t i) {
    if (sizeof(T) != cell.decl->element_size)
      throw std::invalid_argument(std::string(cell.decl->name) + " has elements of another size");
    if (i >= std::size_t{extent_of(*cell.decl, 0, true)} * extent_of(*cell.decl, 1, true))
      throw std::invalid_argument(std::string(cell.decl->name) + " has fewer elements");
    return *reinterpret_cast<T*>(cell.memory.get() + i * sizeof(T));
  }

  RigAnswer run(Method method) {
    const chimera_method function = component_->methods[static_cast<std::uint32_t>(method)];
    if (function == nullptr) return {};
    chimera_fault fault{};
    call_.fault = &fault;
    const std::int32_t status = function(state_.get(), &call_);
    call_.fault = nullptr;
    if (method == Method::kInit || method == Method::kReinit) fix_extents();
    return {status, fault.code, fault.text};
  }

  static std::int32_t host_expired(void* rig) { return static_cast<Rig*>(rig)->expired_ ? 1 : 0; }
  static std::int32_t host_signal(void* rig, std::uint32_t signal, const char* task) {
    std::string text = signal_name(static_cast<Signal>(signal));
    if (task != nullptr) text = text + " " + task;
    static_cast<Rig*>(rig)->signals_.push_back(text);
    return CHIMERA_OK;
  }
  static void host_spend(void* rig, std::int64_t ns) { static_cast<Rig*>(rig)->spent_ += Nanoseconds{ns}; }
  static constexpr chimera_host kHost{&host_expired, &host_signal, &host_spend};

  const chimera_component* component_;
  chimera_call call_{};
  std::unique_ptr<std::byte, Destroy> state_;
  std::vector<std::unique_ptr<Cell>> cells_;
  std::vector<Fixed> fixed_;
  std::vector<std::string> signals_;
  Nanoseconds spent_;
  bool expired_ = false;
};

}  // namespace chimera
