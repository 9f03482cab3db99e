// SPDX-License-Identifier: Apache-2.0
// The ports of a component, declared as its members:
//
//   In<double>      x {"x", "U"};                                in-var: the latest value at the start of a cycle
//   Out<double[6]>  tau{"tau", "N.m", initial = 0.0, safety};    out-var: published when the method returned ok
//   InConst<int>    ndof{"ndof", "1"};                           in-const: known from init on
//   OutConst<double> mass{"mass", "kg"};                         out-const: written in init or reinit
//   Resource        device{"device"};                            resource: a text that names something outside
//   Many<In<double>> in{"in*", "U"};                             repeated: as many as the description says
//
// A shape may follow the unit if the type leaves it open: In<double[]> q{"q", "rad", "[ndof<=10]"}.
// Types: bool, int32, int64, float, double, Text<N>, structs with Fields, Any. Options: chimera/task/options.h.
// A port is a view of its values: by shape (one value, a list, a matrix) or as bytes (any type). The framework fills
// the live half of a view (chimera_port) between methods: do not keep pointers or spans from one method to the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#ifdef __cpp_exceptions
#include <cstdio>
#include <stdexcept>
#endif

#include "chimera/base/time.h"
#include "chimera/task/abi.h"
#include "chimera/task/declare_port.h"
#include "chimera/task/fields.h"
#include "chimera/task/handover.h"
#include "chimera/task/port_form.h"
#ifndef __cpp_exceptions
#include "chimera/task/method_guard.h"
#endif

namespace chimera {

template <class P, std::uint32_t N = CHIMERA_MAX_INSTANCES>
class Many;

namespace component_api {

/// Ends the method with a fault that names the index.
[[noreturn]] inline void index_beyond(std::size_t index, std::size_t size) {
#ifdef __cpp_exceptions
  char text[80];
  std::snprintf(text, sizeof(text), "index %zu of a port that has %zu", index, size);
  throw std::out_of_range(text);
#else
  leave_guarded(index, size);
#endif
}

inline void check_index(std::size_t index, std::size_t size) {
  if (index >= size) [[unlikely]] index_beyond(index, size);
}

/// The live half; not copyable, because the framework stores its address.
class PortBase {
 public:
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;
  /// The port in the form of the framework.
  const chimera_port* live() const noexcept { return &live_; }

 protected:
  PortBase() noexcept = default;
  chimera_port live_{};
};

/// One value.
template <class E>
class ScalarView : public PortBase {
 public:
  E& operator*() const noexcept { return *static_cast<E*>(live_.value); }
  E* operator->() const noexcept { return static_cast<E*>(live_.value); }
};

/// A list; size() is the extent in use, fixed at init. Indexes are checked, span() and iteration are not.
template <class E>
class VectorView : public PortBase {
 public:
  std::size_t size() const noexcept { return live_.count; }
  E* begin() const noexcept { return static_cast<E*>(live_.value); }
  E* end() const noexcept { return begin() + live_.count; }
  std::span<E> span() const noexcept { return {begin(), size()}; }
  operator std::span<E>() const noexcept { return span(); }  // NOLINT: a list is a span
  E& operator[](std::size_t i) const {
    check_index(i, size());
    return begin()[i];
  }
};

/// Rows and columns, row by row in memory without gaps. Indexes are checked, rows and span() are not.
template <class E>
class MatrixView : public PortBase {
 public:
  std::size_t rows() const noexcept { return live_.extent[0]; }
  std::size_t columns() const noexcept { return live_.extent[1]; }
  std::size_t size() const noexcept { return live_.count; }
  std::span<E> span() const noexcept { return {static_cast<E*>(live_.value), live_.count}; }
  std::span<E> operator[](std::size_t row) const {
    check_index(row, rows());
    return span().subspan(row * columns(), columns());
  }
  E& operator()(std::size_t row, std::size_t column) const {
    check_index(column, columns());
    return (*this)[row][column];
  }
};

/// Values whose type the component does not know.
template <class Byte>
class AnyView : public PortBase {
 public:
  std::size_t size() const noexcept { return live_.count; }
  std::size_t element_size() const noexcept { return live_.element_size; }
  /// CHIMERA_BOOL to CHIMERA_STRUCT, as verification found it.
  std::uint32_t element_type() const noexcept { return live_.type; }
  std::span<Byte> bytes() const noexcept {
    return {static_cast<Byte*>(live_.value), std::size_t{live_.count} * live_.element_size};
  }
};

template <class T, bool kReadOnly>
struct ViewOf {
  using Element = typename PortType<T>::Element;
  using E = std::conditional_t<kReadOnly, const Element, Element>;
  static auto choose() {
    if constexpr (std::is_same_v<Element, Any>)
      return std::type_identity<AnyView<std::conditional_t<kReadOnly, const std::byte, std::byte>>>{};
    else if constexpr (PortType<T>::kRank == 0) return std::type_identity<ScalarView<E>>{};
    else if constexpr (PortType<T>::kRank == 1) return std::type_identity<VectorView<E>>{};
    else return std::type_identity<MatrixView<E>>{};
  }
  using type = typename decltype(choose())::type;
};

template <class T, bool kReadOnly>
using View = typename ViewOf<T, kReadOnly>::type;

/// The common part of the four kinds of typed ports: the three ways to declare one.
template <class T, std::uint32_t Kind>
class TypedPort : public View<T, Kind == CHIMERA_IN_VAR || Kind == CHIMERA_IN_CONST> {
 public:
  using Type = T;
  static constexpr std::uint32_t kKind = Kind;

  /// Without a unit: bool, text, or a struct whose fields have their own units.
  template <Option... O>
  explicit TypedPort(PortName name, const O&... options) : TypedPort(name, Literal("1"), options...) {}
  template <Option... O>
  TypedPort(PortName name, Literal unit, const O&... options) {
    static_assert(!PortType<T>::kOpen, "this type leaves the shape open: give it after the unit, as \"[ndof<=10]\"");
    declare_port<T, Kind, 0>(name.text, unit.text, PortType<T>::kShape, {&this->live_}, options...);
  }
  template <Option... O>
  TypedPort(PortName name, Literal unit, Literal shape, const O&... options) {
    static_assert(PortType<T>::kOpen, "the shape follows from the type: leave the text out, or use T[]");
    declare_port<T, Kind, 0>(name.text, unit.text, shape.text, {&this->live_}, options...);
  }

 protected:
  TypedPort() noexcept = default;  // an instance of Many, which declares for all
};

}  // namespace component_api

/// An in-var: the latest value published before the method began; it does not change until the method returns.
template <class T>
class In : public component_api::TypedPort<T, CHIMERA_IN_VAR> {
 public:
  using component_api::TypedPort<T, CHIMERA_IN_VAR>::TypedPort;

  /// The time from the publication of the value to the release of this job; kNever while !valid(). Context: cycle;
  /// wait-free.
  Nanoseconds age() const noexcept {
    return valid() ? Nanoseconds{*this->live_.now_ns - this->live_.slot->published_ns} : kNever;
  }
  /// True if the producer has published since the previous cycle of this task. Context: cycle; wait-free.
  bool fresh() const noexcept { return this->live_.slot != nullptr && this->live_.slot->sequence != this->live_.seen; }
  /// False until a task writes the variable, if it has no initial value: floats are NaN then, all other types zero.
  /// Context: cycle; wait-free.
  bool valid() const noexcept {
    return this->live_.slot != nullptr && ((this->live_.slot->valid >> this->live_.bit) & 1u) != 0;
  }

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  In() noexcept = default;
};

/// An out-var: holds the last published value until the method writes it. All out-vars of a task are published
/// together, after the method returned ok. At `on` it holds the value of the last producer of the variable: a
/// predecessor, or the task itself. chimera/task/handover.h states when to continue from that value.
template <class T>
class Out : public component_api::TypedPort<T, CHIMERA_OUT_VAR> {
 public:
  using component_api::TypedPort<T, CHIMERA_OUT_VAR>::TypedPort;

  /// The age, at the begin of the present `on`, of the value that the out-var held then; constant until the next `on`.
  /// kNever if no task had published it: then it held its initial value, or was not valid. Context: any; wait-free.
  Nanoseconds inherited() const noexcept {
    const chimera_inherited* const from = chimera_inherited_of(&this->live_);
    return from == nullptr ? kNever : Nanoseconds{from->age_ns};
  }
  /// True if that value was published at most 2 periods of its producer before `on`, or at most 10 ms. Then it is the
  /// present command, and the task continues from it. Context: any; wait-free.
  bool is_handed_over() const noexcept { return chimera_is_handed_over(&this->live_) != 0; }
  /// True if it was published earlier: no task followed it since, so begin from measured values. Context: any;
  /// wait-free.
  bool is_outdated() const noexcept { return this->live_.slot != nullptr && !is_handed_over(); }

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  Out() noexcept = default;
};

/// An in-const: a value that is known from init on and changes only at reinit. Read-only.
template <class T>
class InConst : public component_api::TypedPort<T, CHIMERA_IN_CONST> {
 public:
  using component_api::TypedPort<T, CHIMERA_IN_CONST>::TypedPort;

  /// False if no source gives the value and it has no default. Context: setup; wait-free.
  bool valid() const noexcept { return this->live_.value != nullptr; }

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  InConst() noexcept = default;
};

/// An out-const: written in init or reinit; its readers are initialised after it.
template <class T>
class OutConst : public component_api::TypedPort<T, CHIMERA_OUT_CONST> {
 public:
  using component_api::TypedPort<T, CHIMERA_OUT_CONST>::TypedPort;

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  OutConst() noexcept = default;
};

/// A resource: the text of the description that names a device, a file or an address. The component opens and closes
/// it, in init and kill. Nothing is transferred.
class Resource : public component_api::PortBase {
 public:
  template <component_api::Option... O>
  explicit Resource(component_api::PortName name, const O&... options) {
    component_api::declare_port<Text<256>, CHIMERA_RESOURCE, 0>(name.text, "1", "", {&live_}, options...);
  }
  /// Context: any; wait-free.
  std::string_view text() const noexcept { return {c_str()}; }
  const char* c_str() const noexcept { return live_.value == nullptr ? "" : static_cast<const char*>(live_.value); }
};

/// A repeated port: the description sets the number of instances, at most N. size() is known from init on.
template <class P, std::uint32_t N>
class Many {
 public:
  template <component_api::Option... O>
  Many(component_api::RepeatedName name, component_api::Literal unit, const O&... options) {
    static_assert(!component_api::PortType<typename P::Type>::kOpen,
                  "this type leaves the shape open: give it after the unit");
    declare(name, unit, component_api::Literal(component_api::PortType<typename P::Type>::kShape), options...);
  }
  template <component_api::Option... O>
  Many(component_api::RepeatedName name, component_api::Literal unit, component_api::Literal shape,
       const O&... options) {
    declare(name, unit, shape, options...);
  }
  Many(const Many&) = delete;
  Many& operator=(const Many&) = delete;

  std::size_t size() const noexcept { return instances_; }
  const P& operator[](std::size_t i) const {
    component_api::check_index(i, instances_);
    return ports_[i];
  }
  const P* begin() const noexcept { return ports_; }
  const P* end() const noexcept { return ports_ + instances_; }

 private:
  static_assert(sizeof(P) == sizeof(chimera_port), "the framework fills the instances as an array");
  static_assert(alignof(P) == component_api::kCounterToArray, "the counter ends where the array begins");
  static_assert(N >= 1 && N <= CHIMERA_MAX_INSTANCES, "a repeated port has 1 to 16 instances");

  template <class... O>
  void declare(component_api::RepeatedName name, component_api::Literal unit, component_api::Literal shape,
               const O&... options) {
    component_api::declare_port<typename P::Type, P::kKind, N>(name.text, unit.text, shape.text, {ports_, &instances_},
                                                               options...);
  }

  std::uint32_t instances_ = 0;
  P ports_[N];
};

}  // namespace chimera
