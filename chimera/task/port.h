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
// After the unit may stand a shape, where the type leaves it open: In<double[]> q{"q", "rad", "[ndof<=10]"}.
// Types: bool, int32, int64, float, double, Text<N>, structs with Fields, Any. Options: chimera/task/options.h.
#pragma once

#include <string_view>

#include "chimera/base/time.h"
#include "chimera/task/declare_port.h"
#include "chimera/task/handover.h"
#include "chimera/task/port_view.h"

namespace chimera {

template <class P, std::uint32_t N = CHIMERA_MAX_INSTANCES>
class Many;

namespace component_api {

/// What the four kinds of typed ports have in common: the three ways to declare one.
template <class T, std::uint32_t Kind>
class TypedPort : public View<T, Kind == CHIMERA_IN_VAR || Kind == CHIMERA_IN_CONST> {
 public:
  using Type = T;
  static constexpr std::uint32_t kKind = Kind;

  /// Without a unit: bool, text, or a struct whose fields have their own.
  template <Option... O>
  explicit TypedPort(PortName name, const O&... options) : TypedPort(name, Literal("1"), options...) {}
  template <Option... O>
  TypedPort(PortName name, Literal unit, const O&... options) {
    static_assert(!PortType<T>::kOpen, "this type leaves the shape open: give it after the unit, as \"[ndof<=10]\"");
    declare_port<T, Kind>(name.text, unit.text, PortType<T>::kShape, {&this->live_}, options...);
  }
  template <Option... O>
  TypedPort(PortName name, Literal unit, Literal shape, const O&... options) {
    static_assert(PortType<T>::kOpen, "the shape follows from the type: leave the text out, or use T[]");
    declare_port<T, Kind>(name.text, unit.text, shape.text, {&this->live_}, options...);
  }

 protected:
  TypedPort() noexcept = default;  // one of Many, which declares for all
};

}  // namespace component_api

/// An in-var: the latest value published before the method began; it stands still until the method returns.
template <class T>
class In : public component_api::TypedPort<T, CHIMERA_IN_VAR> {
 public:
  using component_api::TypedPort<T, CHIMERA_IN_VAR>::TypedPort;

  /// How long ago the value was published, seen from the release of this job; kNever while !valid().
  /// Context: cycle; wait-free.
  Nanoseconds age() const noexcept {
    return valid() ? Nanoseconds{*this->live_.now_ns - this->live_.slot->published_ns} : kNever;
  }
  /// True when the producer has published since this task's previous cycle. Context: cycle; wait-free.
  bool fresh() const noexcept { return this->live_.slot != nullptr && this->live_.slot->sequence != this->live_.seen; }
  /// False as long as nobody has written it and it had no initial value: floats are NaN then, the rest zero.
  /// Context: cycle; wait-free.
  bool valid() const noexcept {
    return this->live_.slot != nullptr && ((this->live_.slot->valid >> this->live_.bit) & 1u) != 0;
  }

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  In() noexcept = default;
};

/// An out-var: holds the last published value until the method writes it. Published together with all
/// other out-vars of the task, when the method returned ok. At `on` that is the value of whoever produced the variable
/// last, a predecessor or the task itself; chimera/task/handover.h says when to go on from it.
template <class T>
class Out : public component_api::TypedPort<T, CHIMERA_OUT_VAR> {
 public:
  using component_api::TypedPort<T, CHIMERA_OUT_VAR>::TypedPort;

  /// How long before the present `on` the value was published that the out-var held when `on` began; the same number
  /// until the next `on`. kNever when no task had published it: it held its initial value, or was not valid.
  /// Context: any; wait-free.
  Nanoseconds inherited() const noexcept {
    const chimera_inherited* const from = chimera_inherited_of(&this->live_);
    return from == nullptr ? kNever : Nanoseconds{from->age_ns};
  }
  /// True when that value was published at most 2 periods of its producer before `on`, or at most 10 ms: it is the
  /// present command, to go on from. Context: any; wait-free.
  bool is_handed_over() const noexcept { return chimera_is_handed_over(&this->live_) != 0; }
  /// True when it was published earlier than that: nobody has followed it since, so begin from what is measured.
  /// Context: any; wait-free.
  bool is_outdated() const noexcept { return this->live_.slot != nullptr && !is_handed_over(); }

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  Out() noexcept = default;
};

/// An in-const: a value that is known from init on and changes only with reinit. Read-only.
template <class T>
class InConst : public component_api::TypedPort<T, CHIMERA_IN_CONST> {
 public:
  using component_api::TypedPort<T, CHIMERA_IN_CONST>::TypedPort;

  /// False when nobody gives the value and it has no default. Context: setup; wait-free.
  bool valid() const noexcept { return this->live_.value != nullptr; }

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  InConst() noexcept = default;
};

/// An out-const: written in init or reinit; its users are initialised after it.
template <class T>
class OutConst : public component_api::TypedPort<T, CHIMERA_OUT_CONST> {
 public:
  using component_api::TypedPort<T, CHIMERA_OUT_CONST>::TypedPort;

 private:
  template <class P, std::uint32_t N>
  friend class Many;
  OutConst() noexcept = default;
};

/// A resource: the text of the description that names a device, a file, an address. What to do with it is
/// the component's business, in init and kill. Nothing is transferred.
class Resource : public component_api::PortBase {
 public:
  template <component_api::Option... O>
  explicit Resource(component_api::PortName name, const O&... options) {
    component_api::declare_port<Text<256>, CHIMERA_RESOURCE>(name.text, "1", "", {&live_}, options...);
  }
  /// Context: any; wait-free.
  std::string_view text() const noexcept { return {c_str()}; }
  const char* c_str() const noexcept { return live_.value == nullptr ? "" : static_cast<const char*>(live_.value); }
};

/// A repeated port: at most N instances, as many as the description names; size() is known from init on.
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
  static_assert(N >= 1 && N <= CHIMERA_MAX_INSTANCES, "a repeated port has 1 to 16 instances");

  template <class... O>
  void declare(component_api::RepeatedName name, component_api::Literal unit, component_api::Literal shape,
               const O&... options) {
    component_api::declare_port<typename P::Type, P::kKind>(name.text, unit.text, shape.text, {ports_, &instances_, N},
                                                            options...);
  }

  std::uint32_t instances_ = 0;
  P ports_[N];
};

}  // namespace chimera
