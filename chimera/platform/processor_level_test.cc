// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/processor_level.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "chimera/platform/doorbell.h"
#include "chimera/platform/linux_clock.h"

namespace chimera {
namespace {

TEST(ProcessorLevel, AThreadIsAsleepWhileItWaitsAndNotWhileItRunsOrIsGone) {
  std::atomic<std::uint32_t> word{0};
  std::atomic<pid_t> id{0};
  std::thread waits([&] {
    id = this_thread();
    const Doorbell bell(word);
    while (bell.read() == 0) (void)bell.wait_until(0, kNever);
  });
  while (id == 0) std::this_thread::yield();
  LinuxClock clock;
  const Nanoseconds patience = clock.now() + seconds(20);
  bool slept = false;
  while (!slept && clock.now() < patience) slept = is_asleep(id);
  EXPECT_TRUE(slept);
  EXPECT_FALSE(is_asleep(this_thread()));
  word = 1;
  Doorbell(word).ring();
  waits.join();
  EXPECT_FALSE(is_asleep(id));
}

TEST(ProcessorLevel, AThreadThatIsGoneHasUsedNothingThatCouldBeRead) {
  pid_t id = 0;
  std::thread([&id] { id = this_thread(); }).join();
  for (int i = 0; i < 10'000 && used_by(id) != kNever; ++i)  // the kernel ends it a little after join()
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(used_by(id), kNever);
  EXPECT_NE(used_by(this_thread()), kNever);
}

}  // namespace
}  // namespace chimera
