// SPDX-License-Identifier: Apache-2.0
// Finds which of the nine methods a class has, with an error for each mistake that would otherwise stay unnoticed.
#pragma once

#include <type_traits>

#include "chimera/task/cycle.h"

namespace chimera::component_api {

// For each name: does a member of that name exist (even private or overloaded)? Does it accept a Cycle or no argument?
// A deliberate ambiguity finds the name: a class that inherits it twice cannot take its address.
#define CHIMERA_FACE_NAME(word)                                                                                   \
  template <class T>                                                                                              \
  struct Name_##word {                                                                                            \
    struct Other { int word; };                                                                                   \
    struct Both : T, Other {};                                                                                    \
    template <class B>                                                                                            \
    static constexpr bool is_ambiguous() { return !requires { &B::word; }; }                                      \
    template <class C>                                                                                            \
    static constexpr bool takes_cycle() { return requires(C& c, Cycle cycle) { c.word(cycle); }; }                \
    template <class C>                                                                                            \
    static constexpr bool takes_nothing() { return requires(C& c) { c.word(); }; }                                \
    static constexpr bool kFound = is_ambiguous<Both>();                                                          \
    static constexpr bool kTakesCycle = takes_cycle<T>();                                                         \
    static constexpr bool kCallable = kTakesCycle || takes_nothing<T>();                                          \
    static decltype(auto) call(T& component, Cycle cycle) {                                                       \
      if constexpr (kTakesCycle) return component.word(cycle);                                                    \
      else if constexpr (kCallable) return component.word();                                                      \
    }                                                                                                             \
    using Answer = decltype(call(std::declval<T&>(), std::declval<Cycle>()));                                     \
    static constexpr bool kVoid = std::is_void_v<Answer>;                                                         \
    static constexpr bool kBool = std::is_same_v<Answer, bool>;                                                   \
    static constexpr bool kOutcome = std::is_same_v<Answer, Outcome>;                                             \
  };

CHIMERA_FACE_NAME(init)
CHIMERA_FACE_NAME(reinit)
CHIMERA_FACE_NAME(on)
CHIMERA_FACE_NAME(cycle)
CHIMERA_FACE_NAME(sync)
CHIMERA_FACE_NAME(off)
CHIMERA_FACE_NAME(kill)
CHIMERA_FACE_NAME(error)
CHIMERA_FACE_NAME(clear)
CHIMERA_FACE_NAME(background)
CHIMERA_FACE_NAME(event_source)

// Common misspellings, and the method that each one means. The list has only words that rarely name anything else. A
// member counts only if it can be called like a method.
#define CHIMERA_FACE_MISSPELLINGS(X)                                                                              \
  X(Init, init) X(INIT, init) X(inti, init) X(initialise, init) X(initialize, init)                 \
  X(Initialise, init) X(Initialize, init) X(on_init, init) X(onInit, init)                                        \
  X(Reinit, reinit) X(ReInit, reinit) X(reInit, reinit) X(re_init, reinit) X(reinitialise, reinit)                \
  X(reinitialize, reinit) X(on_reinit, reinit)                                                                    \
  X(On, on) X(ON, on) X(activate, on) X(on_activate, on)                                               \
  X(Cycle, cycle) X(CYCLE, cycle) X(cylce, cycle) X(cyle, cycle) X(clycle, cycle) X(cycel, cycle)                 \
  X(cicle, cycle) X(cycl, cycle) X(cycles, cycle) X(on_cycle, cycle) X(onCycle, cycle)                            \
  X(Sync, sync) X(SYNC, sync) X(synch, sync) X(snyc, sync) X(on_sync, sync)                                       \
  X(Off, off) X(OFF, off) X(of, off) X(deactivate, off) X(on_deactivate, off)                                     \
  X(Kill, kill) X(KILL, kill) X(kil, kill) X(Term, kill) X(term, kill) X(terminate, kill) X(Terminate, kill)      \
  X(on_kill, kill)                                                                                                \
  X(Error, error) X(ERROR, error) X(eror, error) X(errror, error) X(on_error, error) X(onError, error)            \
  X(Clear, clear) X(CLEAR, clear) X(claer, clear) X(cler, clear) X(on_clear, clear)

// Cycle is also a type of the framework; inside these templates the word must mean the member.
#define CHIMERA_FACE_CALLABLE(word, meant)                                                     \
  template <class T>                                                                           \
  constexpr bool could_be_##word() {                                                           \
    return requires(T& t, chimera::Cycle c) { t.word(c); } || requires(T& t) { t.word(); };    \
  }
CHIMERA_FACE_MISSPELLINGS(CHIMERA_FACE_CALLABLE)
#undef CHIMERA_FACE_CALLABLE

template <class T>
constexpr bool check_spelling() {
#define CHIMERA_FACE_SPELLING(word, meant)                                                                      \
  static_assert(!could_be_##word<T>(), "the component has a method '" #word "': did you mean '" #meant "'? The " \
                                       "methods are init reinit on cycle sync off kill error clear");
  CHIMERA_FACE_MISSPELLINGS(CHIMERA_FACE_SPELLING)
#undef CHIMERA_FACE_SPELLING
  return true;
}

template <class T>
constexpr bool check_signatures() {
#define CHIMERA_FACE_CALLS(word)                                                                              \
  static_assert(!Name_##word<T>::kFound || Name_##word<T>::kCallable,                                         \
                "'" #word "' is a method of every component: write it as " #word "(Cycle) or " #word "(), public, " \
                "or give this member another name");
#define CHIMERA_FACE_ACTS(word)                                                                               \
  CHIMERA_FACE_CALLS(word)                                                                                    \
  static_assert(!Name_##word<T>::kCallable || Name_##word<T>::kVoid || Name_##word<T>::kOutcome,              \
                "'" #word "' must return nothing, or an Outcome: ok() or fault(\"text\")");
#define CHIMERA_FACE_ANSWERS(word, meaning)                                                                   \
  CHIMERA_FACE_CALLS(word)                                                                                    \
  static_assert(!Name_##word<T>::kCallable || Name_##word<T>::kBool || Name_##word<T>::kOutcome,              \
                "'" #word "' must return bool (" meaning "), or an Outcome");
  CHIMERA_FACE_ACTS(init)
  CHIMERA_FACE_ACTS(reinit)
  CHIMERA_FACE_ACTS(on)
  CHIMERA_FACE_ACTS(cycle)
  CHIMERA_FACE_ANSWERS(sync, "true: an event was taken")
  CHIMERA_FACE_ACTS(off)
  CHIMERA_FACE_ACTS(kill)
  CHIMERA_FACE_ANSWERS(error, "true: recovered")
  CHIMERA_FACE_ANSWERS(clear, "true: the cause is gone")
  static_assert(!Name_background<T>::kFound || (Name_background<T>::kCallable && !Name_background<T>::kTakesCycle &&
                                                Name_background<T>::kVoid),
                "'background' runs beside the cycles: write it as void background(), public, or give this member "
                "another name");
  static_assert(!Name_event_source<T>::kFound ||
                    (Name_event_source<T>::kCallable && !Name_event_source<T>::kTakesCycle && Name_sync<T>::kFound &&
                     std::is_same_v<typename Name_event_source<T>::Answer, int>),
                "'event_source' returns the descriptor that sync reads: write it as int event_source(), public, beside "
                "sync, or give this member another name");
#undef CHIMERA_FACE_ANSWERS
#undef CHIMERA_FACE_ACTS
#undef CHIMERA_FACE_CALLS
  return true;
}

/// True, or a compile error with an explanation.
template <class T>
constexpr bool check_component() {
  static_assert(std::is_class_v<T>, "a component is a struct or a class");
  static_assert(!std::is_final_v<T>, "a component must not be final: its methods could not be checked");
  // An aggregate has no constructor. If it cannot be made, one of its ports is wrong and has already caused an error.
  static_assert(std::is_default_constructible_v<T> || std::is_aggregate_v<T>,
                "a component is made without arguments: what it needs comes by in-const and resource ports (if a port "
                "is refused above, mend that first)");
  static_assert(check_spelling<T>());
  static_assert(check_signatures<T>());
  static_assert(Name_cycle<T>::kFound, "a component needs a method cycle(Cycle) or cycle()");
  return true;
}

#undef CHIMERA_FACE_MISSPELLINGS
#undef CHIMERA_FACE_NAME

}  // namespace chimera::component_api
