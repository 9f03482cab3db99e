// SPDX-License-Identifier: Apache-2.0
// Sets the default stack size of new threads and restores it.
#include "chimera/platform/thread_stack.h"

#include <pthread.h>

namespace chimera {
namespace {

// The size before; what cannot be set is left.
std::size_t exchange(std::size_t bytes) noexcept {
  pthread_attr_t attributes;
  if (::pthread_getattr_default_np(&attributes) != 0) return 0;
  std::size_t before = 0;
  ::pthread_attr_getstacksize(&attributes, &before);
  ::pthread_attr_setstacksize(&attributes, bytes);
  ::pthread_setattr_default_np(&attributes);
  ::pthread_attr_destroy(&attributes);
  return before;
}

}  // namespace

ThreadStack::ThreadStack(std::size_t bytes) noexcept : before_(bytes == 0 ? 0 : exchange(bytes)) {}

ThreadStack::~ThreadStack() {
  if (before_ != 0) exchange(before_);
}

}  // namespace chimera
