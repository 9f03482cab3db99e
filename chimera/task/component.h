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

#include <cstdint>
#ifdef __cpp_exceptions
#include <exception>
#endif
#include <new>

#include "chimera/task/bounded_text.h"

#include "chimera/task/cycle.h"
#include "chimera/task/declare_port.h"
#include "chimera/task/method_check.h"
#include "chimera/task/options.h"
#include "chimera/task/port.h"

namespace chimera::component_api {

inline std::int32_t note_fault(chimera_fault* fault, std::int32_t code, const char* text) noexcept {
  fault->code = code;
  put_text(fault->text, sizeof(fault->text), {text});
  return CHIMERA_FAULT;
}

/// Runs `body(state, argument)`, which returns a CHIMERA_ status. An exception that leaves it becomes a fault with its
/// text. Without exceptions, an index beyond a port becomes the same fault (method_guard.h). `body` is a lambda without
/// captures.
template <class Body>
std::int32_t guard(Body body, void* state, const void* argument, chimera_fault* fault) noexcept {
#ifdef __cpp_exceptions
  try {
    return body(state, argument);
  } catch (const std::exception& e) {
    return note_fault(fault, 0, e.what());
  } catch (const char* text) {
    return note_fault(fault, 0, text);
  } catch (...) {
    return note_fault(fault, 0, "an exception that is not a std::exception");
  }
#else
  return run_guarded(body, state, argument, fault);
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
std::int32_t run_method(void* instance, const chimera_call* present) noexcept {
  return guard([](void* state, const void* argument) -> std::int32_t {
    T& component = *static_cast<T*>(state);
    const auto& call = *static_cast<const chimera_call*>(argument);
    if constexpr (Name::kVoid) {
      Name::call(component, Cycle(call));
      return CHIMERA_OK;
    } else {
      return judge(kMethod, Name::call(component, Cycle(call)), call.fault);
    }
  }, instance, present, present->fault);
}

template <class T, class Name, Method kMethod>
constexpr chimera_method method_of() {
  if constexpr (Name::kCallable) return &run_method<T, Name, kMethod>;
  else return nullptr;
}

template <class T>
std::int32_t run_background(void* instance, chimera_fault* fault) noexcept {
  return guard([](void* state, const void*) -> std::int32_t {
    static_cast<T*>(state)->background();
    return CHIMERA_OK;
  }, instance, nullptr, fault);
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

template <class T>
std::int32_t construct(void* memory, chimera_fault* fault) noexcept {
  return guard([](void* state, const void*) -> std::int32_t {
    ::new (state) T();
    return CHIMERA_OK;
  }, memory, nullptr, fault);
}

/// The part of the table of T that its type gives.
template <class T>
constexpr chimera_component table_of() noexcept {
  chimera_component made{};
  made.abi_version = CHIMERA_ABI_VERSION;
  made.struct_size = sizeof(chimera_component);
  made.host_size = sizeof(chimera_host);
  made.state_size = sizeof(T);
  made.state_align = alignof(T);
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
  return made;
}

constexpr void apply_extra(chimera_component& to, RateIs rate) noexcept { to.default_rate_hz = rate.hertz; }
constexpr void apply_extra(chimera_component& to, SourceIs source) noexcept { to.source = source.text; }

}  // namespace chimera::component_api

#ifdef CHIMERA_BARE
#include "chimera/task/bare_component.h"
#else
#include "chimera/task/offered_component.h"
#endif
