// SPDX-License-Identifier: Apache-2.0
// CHIMERA_COMPONENT where programs load components: the ports of a sample instance make the declaration, and the object
// offers it (registry.h).
#pragma once

#include <cstring>
#include <new>
#include <string_view>

#include "chimera/task/collector.h"
#include "chimera/task/component.h"
#include "chimera/task/registry.h"

namespace chimera::component_api {

/// The declaration of T in this object.
template <class T>
inline Declaration declared;

/// Constructs T, unless its declaration has an error.
template <class T>
std::int32_t construct_declared(void* state, chimera_fault* fault) noexcept {
  if (declared<T>.error[0] != '\0') return note_fault(fault, 0, declared<T>.error);
  return construct<T>(state, fault);
}

/// Memory from the heap for a sample instance that is constructed once.
template <class T>
class SampleMemory {
 public:
  SampleMemory() noexcept = default;
  SampleMemory(const SampleMemory&) = delete;
  SampleMemory& operator=(const SampleMemory&) = delete;
  ~SampleMemory() { ::operator delete(at_, std::align_val_t{alignof(T)}); }
  /// Null if there is no memory.
  void* at() noexcept { return at_; }

 private:
  void* at_ = ::operator new(sizeof(T), std::align_val_t{alignof(T)}, std::nothrow);
};

/// Constructs one instance under a collector, so that its ports declare themselves.
template <class T>
void collect_ports(Declaration& to) noexcept {
  SampleMemory<T> memory;
  void* const sample = memory.at();
  if (sample == nullptr) return put_text(to.error, sizeof(to.error), {"no memory for a sample instance"});
  std::memset(sample, 0, sizeof(T));
  chimera_fault fault{};
  {
    Collector collector(to, sample, sizeof(T));
    if (construct_declared<T>(sample, &fault) == CHIMERA_OK) static_cast<T*>(sample)->~T();
  }
  if (fault.text[0] != '\0' && to.error[0] == '\0')
    put_text(to.error, sizeof(to.error), {"the constructor failed: ", std::string_view(fault.text).substr(0, 120)});
}

template <class T>
const chimera_component* declare() noexcept {
  Declaration& to = declared<T>;
  chimera_component& made = to.component;
  if (made.abi_version != 0) return &made;
  const chimera_component offered = made;
  made = table_of<T>();
  made.name = offered.name;
  made.doc = offered.doc;
  made.source = offered.source;
  made.default_rate_hz = offered.default_rate_hz;
  made.construct = &construct_declared<T>;
  collect_ports<T>(to);
  made.ports = to.ports;
  made.orders = to.orders;
  made.choices = to.choices;
  return &made;
}

/// CHIMERA_COMPONENT creates one of these objects; its constructor runs while the object is loaded.
template <class T, class... Extras>
bool offer(PortName name, Literal doc, Extras... extras) noexcept {
  static_assert(check_component<T>());
  chimera_component& made = declared<T>.component;
  made.name = name.text;
  made.doc = doc.text;
  made.source = "";
  (apply_extra(made, extras), ...);
  return chimera_offer(&declare<T>) != 0;
}

}  // namespace chimera::component_api

#define CHIMERA_COMPONENT_JOIN_(a, b) a##b
#define CHIMERA_COMPONENT_JOIN(a, b) CHIMERA_COMPONENT_JOIN_(a, b)

/// Offers a class as a component: CHIMERA_COMPONENT(Class, "name", "One sentence."). Optional extras are `rate =
/// 1000.0` (default rate, Hz) and `source = "paper or book"`. Use it at namespace scope, in the one source file of the
/// component.
#define CHIMERA_COMPONENT(Class, ...)                                                 \
  namespace {                                                                         \
  [[maybe_unused]] const bool CHIMERA_COMPONENT_JOIN(chimera_offered_, __COUNTER__) = \
      ::chimera::component_api::offer<Class>(__VA_ARGS__);                            \
  }                                                                                   \
  static_assert(true)
