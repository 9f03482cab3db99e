/* SPDX-License-Identifier: Apache-2.0 */
/* An object whose component cannot be constructed. */
#include "chimera/task/registry.h"

static int32_t refuse(void* state, chimera_fault* fault) {
  (void)state;
  fault->text[0] = 'n';
  fault->text[1] = 'o';
  return CHIMERA_FAULT;
}
static void destroy(void* state) { (void)state; }
static const chimera_component broken = {.abi_version = CHIMERA_ABI_VERSION,
                                         .struct_size = sizeof(chimera_component),
                                         .name = "broken_state",
                                         .state_size = 1,
                                         .state_align = 1,
                                         .construct = refuse,
                                         .destroy = destroy};
static const chimera_component* declare(void) { return &broken; }
__attribute__((constructor)) static void offer(void) { (void)chimera_offer(declare); }
