// SPDX-License-Identifier: Apache-2.0
// Leaves a method at an index beyond a port, with the jump that the compiler builds in: no C library has to do it.
#include "chimera/task/method_guard.h"

#include "chimera/base/assert.h"
#include "chimera/base/message.h"
#include "chimera/task/bounded_text.h"

namespace chimera {
namespace {

/// A body that runs now.
struct GuardedRun {
  void* place[5];  ///< as __builtin_setjmp wants it
  chimera_fault* fault;
  GuardedRun* outer;
};

#if __STDC_HOSTED__
thread_local GuardedRun* innermost = nullptr;
#else
GuardedRun* innermost = nullptr;  // this system has one thread
#endif

}  // namespace

// Not inlined: the jump must not come from the function that it leads to. Every register counts as overwritten there.
[[gnu::noinline]] std::int32_t run_guarded(GuardedBody body, void* state, const void* argument,
                                           chimera_fault* fault) noexcept {
  GuardedRun guard;
  guard.fault = fault;
  guard.outer = innermost;
  if (__builtin_setjmp(guard.place) != 0) {
    innermost = innermost->outer;
    return CHIMERA_FAULT;
  }
#if defined(__thumb__) && !defined(__thumb2__)
  asm volatile("" : : : "r8", "r9", "r10", "r11");  // a Cortex-M0+ saves these for the caller only if they are named
#endif
  innermost = &guard;
  const std::int32_t status = body(state, argument);
  innermost = guard.outer;
  return status;
}

[[gnu::noinline]] void leave_guarded(std::size_t index, std::size_t size) noexcept {
  CHIMERA_ASSERT(innermost != nullptr);
  innermost->fault->code = 0;
  Message text;
  text << "index " << index << " of a port that has " << size;
  component_api::put_text(innermost->fault->text, CHIMERA_FAULT_TEXT, {text.view()});
  __builtin_longjmp(innermost->place, 1);
}

}  // namespace chimera
