// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/thread_stack.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <thread>

namespace chimera {
namespace {

std::size_t stack_of_a_new_thread() {
  std::size_t bytes = 0;
  std::thread([&bytes] {
    pthread_attr_t attributes;
    pthread_getattr_np(pthread_self(), &attributes);
    pthread_attr_getstacksize(&attributes, &bytes);
    pthread_attr_destroy(&attributes);
  }).join();
  return bytes;
}

TEST(ThreadStack, HoldsForThreadsThatAreStartedMeanwhile) {
  const std::size_t before = stack_of_a_new_thread();
  {
    const ThreadStack stack(1 << 20);
    EXPECT_EQ(stack_of_a_new_thread(), std::size_t{1} << 20);
    const ThreadStack as_it_is(0);
    EXPECT_EQ(stack_of_a_new_thread(), std::size_t{1} << 20);
  }
  EXPECT_EQ(stack_of_a_new_thread(), before);
}

}  // namespace
}  // namespace chimera
