// SPDX-License-Identifier: Apache-2.0
// CHIMERA_COMPONENT with CHIMERA_BARE, for an image without a loader: one constant table, which the tables of the image
// name as chimera_component_NAME. It has no declarations, because the ports report themselves (wiring.h). Nothing runs
// before main, and nothing lies in RAM.
#pragma once

#include "chimera/task/component.h"

namespace chimera::component_api {

template <class T, class... Extras>
constexpr chimera_component bare_component(PortName name, Literal, Extras... extras) noexcept {
  static_assert(check_component<T>());
  chimera_component made = table_of<T>();
  made.name = name.text;
  made.doc = made.source = "";
  (apply_extra(made, extras), ...);
  made.source = "";  // only programs with a library show it
  return made;
}

}  // namespace chimera::component_api

#define CHIMERA_COMPONENT_NAME(name, ...) name

/// Makes the table of a component: CHIMERA_COMPONENT(Class, "name", "One sentence."), with the optional extras of
/// offered_component.h. The symbol is global although the class may lie in a namespace without a name.
#define CHIMERA_COMPONENT(Class, ...)                                                      \
  asm(".global chimera_component_" CHIMERA_COMPONENT_NAME(__VA_ARGS__, ));                 \
  namespace {                                                                              \
  [[gnu::used]] constinit const chimera_component chimera_bare_component asm(              \
      "chimera_component_" CHIMERA_COMPONENT_NAME(__VA_ARGS__, )) =                        \
      ::chimera::component_api::bare_component<Class>(__VA_ARGS__);                        \
  }                                                                                        \
  static_assert(true)
