// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/wake_event.h"

#include <gtest/gtest.h>

#include "chimera/platform/readiness.h"

namespace chimera {
namespace {

bool is_readable(const WakeEvent& event) {
  const int descriptors[] = {event.descriptor()};
  return await_readable(descriptors, {});
}

TEST(WakeEvent, IsReadableFromTheFirstRingUntilItIsReset) {
  const auto event = WakeEvent::open(Message("test"));
  ASSERT_TRUE(event);
  EXPECT_FALSE(is_readable(*event));
  event->ring();
  ring_event(event->descriptor());
  EXPECT_TRUE(is_readable(*event));
  event->reset();
  EXPECT_FALSE(is_readable(*event));
  event->reset();  // does not wait
  ring_event(-1);
}

}  // namespace
}  // namespace chimera
