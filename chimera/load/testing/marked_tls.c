/* SPDX-License-Identifier: Apache-2.0 */
/* What the framework has in the objects of C++ components, task/declare_port.h; the object offers no components. */
#include "chimera/task/abi.h"

_Thread_local struct {
  uint64_t mark;
  void* current;
} chimera_test_of_a_thread = {CHIMERA_THREAD_MARK, 0};
