/* SPDX-License-Identifier: Apache-2.0 */
/* An object that was built for another version of the component interface: it knows only version 4711. */
#include "chimera/task/abi.h"

const chimera_component* const* chimera_components(uint32_t abi_version, uint32_t* count);
const chimera_component* const* chimera_components(uint32_t abi_version, uint32_t* count) {
  static const chimera_component* none[1];
  *count = 0;
  return abi_version == 4711u ? none : 0;
}
