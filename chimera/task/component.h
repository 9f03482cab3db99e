// SPDX-License-Identifier: Apache-2.0
// For components in C++: the only include that the source of a component needs. docs/howto/write-a-component.md.
//
//   #include "chimera/task/component.h"
//   using namespace chimera;
//
//   struct TimeDerivative {
//     In<double>  x {"x",  "U"};
//     Out<double> dx{"dx", "U/s", initial = 0.0};
//     void on(Cycle)      { last_ = *x; *dx = 0; }
//     void cycle(Cycle c) { *dx = (*x - last_) / c.dt(); last_ = *x; }
//     double last_ = 0;
//   };
//   CHIMERA_COMPONENT(TimeDerivative, "tderiv", "Time derivative of one signal.")
//
// Methods, each with (Cycle) or (); all except cycle are optional:
//   init reinit on cycle off kill   return nothing, or an Outcome: ok(), fault("text", code); on also not_yet(), cycle
//                                   also aborted(), partial()
//   sync                            returns bool (an event was taken), or an Outcome with no_event()
//   error clear                     return bool (recovered; the cause is gone), or an Outcome
// A component may also have void background(), for work that may wait. A thread without real-time rights calls it about
// every 10 ms, while other methods run. int event_source() const noexcept, with sync, returns the descriptor of the
// events. docs/howto/write-a-component.md.
// An exception that leaves a method is a fault with its text.
#pragma once

#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <type_traits>

#include "chimera/task/cycle.h"
#include "chimera/task/declare_port.h"
#include "chimera/task/method_check.h"
#include "chimera/task/options.h"
#include "chimera/task/port.h"
#include "chimera/task/registry.h"

namespace chimera::component_api {

inline std::int32_t note_fault(chimera_fault* fault, std::int32_t code, const char* text) noexcept {
  fault->code = code;
  put_text(fault->text, sizeof(fault->text), {text});
  return CHIMERA_FAULT;
}

/// Runs `body`, which returns a CHIMERA_ status. An exception that leaves it becomes a fault with its text.
template <class Body>
std::int32_t guard(chimera_fault* fault, Body body) noexcept {
#ifdef __cpp_exceptions
  try {
    return body();
  } catch (const std::exception& e) {
    return note_fault(fault, 0, e.what());
  } catch (const char* text) {
    return note_fault(fault, 0, text);
  } catch (...) {
    return note_fault(fault, 0, "an exception that is not a std::exception");
  }
#else
  return body();
#endif
}

/// Checks that `method` may return this status; returns the status that counts.
inline std::int32_t judge(Method method, const Outcome& outcome, chimera_fault* fault) noexcept {
  if (outcome.status() == CHIMERA_ABORTED && method != Method::kCycle)
    return note_fault(fault, 0, "only cycle may answer aborted()");
  if (outcome.status() == CHIMERA_PARTIAL && method != Method::kCycle)
    return note_fault(fault, 0, "only cycle may answer partial()");
  if (outcome.status() == CHIMERA_NO_EVENT && method != Method::kSync)
    return note_fault(fault, 0, "only sync may answer no_event()");
  if (outcome.status() == CHIMERA_NOT_YET && method != Method::kOn)
    return note_fault(fault, 0, "only on may answer not_yet()");
  if (outcome.status() == CHIMERA_FAULT) return note_fault(fault, outcome.code(), outcome.text().data());
  return outcome.status();
}

/// A false without a text. sync: no event; error: not recovered; clear: the cause is still there.
inline std::int32_t judge(Method method, bool yes, chimera_fault* fault) noexcept {
  if (yes) return CHIMERA_OK;
  if (method == Method::kSync) return CHIMERA_NO_EVENT;
  return note_fault(fault, 0,
                    method == Method::kError ? "error() did not recover" : "clear() found the cause still there");
}

template <class T, class Name, Method kMethod>
std::int32_t run_method(void* state, const chimera_call* call) noexcept {
  return guard(call->fault, [&]() -> std::int32_t {
    T& component = *static_cast<T*>(state);
    if constexpr (Name::kVoid) {
      Name::call(component, Cycle(*call));
      return CHIMERA_OK;
    } else {
      return judge(kMethod, Name::call(component, Cycle(*call)), call->fault);
    }
  });
}

template <class T, class Name, Method kMethod>
constexpr chimera_method method_of() {
  if constexpr (Name::kCallable) return &run_method<T, Name, kMethod>;
  else return nullptr;
}

template <class T>
std::int32_t run_background(void* state, chimera_fault* fault) noexcept {
  return guard(fault, [&]() -> std::int32_t {
    static_cast<T*>(state)->background();
    return CHIMERA_OK;
  });
}

template <class T>
constexpr chimera_background background_of() {
  if constexpr (Name_background<T>::kCallable) return &run_background<T>;
  else return nullptr;
}

template <class T>
constexpr chimera_event_source event_source_of() {
  if constexpr (Name_event_source<T>::kCallable)
    return [](void* state) -> std::int32_t { return static_cast<T*>(state)->event_source(); };
  else return nullptr;
}

/// The declaration of T in this object.
template <class T>
inline Declaration declared;

template <class T>
std::int32_t construct(void* state, chimera_fault* fault) noexcept {
  if (declared<T>.error[0] != '\0') return note_fault(fault, 0, declared<T>.error);
  return guard(fault, [&] {
    ::new (state) T();
    return CHIMERA_OK;
  });
}

/// Memory for a sample instance that is constructed once: from the heap, if the system has one.
template <class T>
class SampleMemory {
 public:
  SampleMemory() noexcept = default;
  SampleMemory(const SampleMemory&) = delete;
  SampleMemory& operator=(const SampleMemory&) = delete;
#if __STDC_HOSTED__
  ~SampleMemory() { ::operator delete(at_, std::align_val_t{alignof(T)}); }
#endif
  /// Null if there is no memory.
  void* at() noexcept { return at_; }

 private:
#if __STDC_HOSTED__
  void* at_ = ::operator new(sizeof(T), std::align_val_t{alignof(T)}, std::nothrow);
#else
  alignas(T) static inline std::byte at_[sizeof(T)];
#endif
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
    if (construct<T>(sample, &fault) == CHIMERA_OK) static_cast<T*>(sample)->~T();
  }
  if (fault.text[0] != '\0' && to.error[0] == '\0')
    put_text(to.error, sizeof(to.error), {"the constructor failed: ", std::string_view(fault.text).substr(0, 120)});
}

template <class T>
const chimera_component* declare() noexcept {
  Declaration& to = declared<T>;
  chimera_component& made = to.component;
  if (made.abi_version != 0) return &made;
  made.abi_version = CHIMERA_ABI_VERSION;
  made.struct_size = sizeof(chimera_component);
  made.host_size = sizeof(chimera_host);
  made.state_size = sizeof(T);
  made.state_align = alignof(T);
  collect_ports<T>(to);
  made.ports = to.ports;
  made.orders = to.orders;
  made.choices = to.choices;
  made.construct = &construct<T>;
  made.destroy = [](void* state) { static_cast<T*>(state)->~T(); };
  made.methods[CHIMERA_INIT] = method_of<T, Name_init<T>, Method::kInit>();
  made.methods[CHIMERA_REINIT] = method_of<T, Name_reinit<T>, Method::kReinit>();
  made.methods[CHIMERA_ON] = method_of<T, Name_on<T>, Method::kOn>();
  made.methods[CHIMERA_CYCLE] = method_of<T, Name_cycle<T>, Method::kCycle>();
  made.methods[CHIMERA_SYNC] = method_of<T, Name_sync<T>, Method::kSync>();
  made.methods[CHIMERA_OFF] = method_of<T, Name_off<T>, Method::kOff>();
  made.methods[CHIMERA_KILL] = method_of<T, Name_kill<T>, Method::kKill>();
  made.methods[CHIMERA_ERROR] = method_of<T, Name_error<T>, Method::kError>();
  made.methods[CHIMERA_CLEAR] = method_of<T, Name_clear<T>, Method::kClear>();
  made.background = background_of<T>();
  made.event_source = event_source_of<T>();
  return &made;
}

inline void apply_extra(chimera_component& to, RateIs rate) noexcept { to.default_rate_hz = rate.hertz; }
inline void apply_extra(chimera_component& to, SourceIs source) noexcept { to.source = source.text; }

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
