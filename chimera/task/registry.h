/* SPDX-License-Identifier: Apache-2.0 */
/* The one symbol of a component's object, chimera_components, and the list behind it. The C++ and the C interface
 * include it, so one object may use both. All definitions are weak: each source file has them, the linker keeps one.
 */
#ifndef CHIMERA_TASK_REGISTRY_H_
#define CHIMERA_TASK_REGISTRY_H_

#include <stddef.h>

#include "chimera/task/abi.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CHIMERA_MAX_COMPONENTS 256u /* of one object */

/* Makes the declaration at its first call; every call returns the same one. */
typedef const chimera_component* (*chimera_declare_fn)(void);

typedef struct chimera_registry {
  chimera_declare_fn declare[CHIMERA_MAX_COMPONENTS];
  uint32_t count;
} chimera_registry;

__attribute__((weak, visibility("hidden"))) chimera_registry chimera_offered;

/* Adds a component to this object's list. Called while the object is loaded, before chimera_components. */
static inline int chimera_offer(chimera_declare_fn declare) {
  if (chimera_offered.count == CHIMERA_MAX_COMPONENTS) return 0;
  chimera_offered.declare[chimera_offered.count++] = declare;
  return 1;
}

/* The object's symbol (chimera_components_fn in abi.h). */
__attribute__((weak, visibility("default")))
const chimera_component* const* chimera_components(uint32_t abi_version, uint32_t* count);

const chimera_component* const* chimera_components(uint32_t abi_version, uint32_t* count) {
  static const chimera_component* list[CHIMERA_MAX_COMPONENTS];
  uint32_t i;
  *count = 0;
  if (abi_version != CHIMERA_ABI_VERSION) return NULL;
  for (i = 0; i < chimera_offered.count; ++i) list[i] = chimera_offered.declare[i]();
  *count = chimera_offered.count;
  return list;
}

#ifdef __cplusplus
}
#endif
#endif /* CHIMERA_TASK_REGISTRY_H_ */
