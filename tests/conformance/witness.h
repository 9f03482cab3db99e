// SPDX-License-Identifier: Apache-2.0
// For real-time tests: nothing is judged while the host did not let even a thread above everything else run in time.
#pragma once

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include "chimera/platform/clock.h"

namespace chimera::toy {

inline constexpr Nanoseconds kWitnessPeriod = milliseconds(1);
inline constexpr Nanoseconds kGapAllowed = microseconds(200);  // 10 % of the shortest period

inline int last_cpu() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())) - 1; }

inline void pin_here(int priority) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<unsigned>(last_cpu()), &one);
  pthread_setaffinity_np(pthread_self(), sizeof one, &one);
  const sched_param p{.sched_priority = priority};
  if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &p) != 0) {
    std::printf("no real-time rights: the run is more likely not to be judged\n");
  }
}

/// What the hypervisor took from the same processor so far: the eighth figure of its line, in 1/100 s.
inline Nanoseconds stolen() {
  std::ifstream stat("/proc/stat");
  for (std::string word; stat >> word;) {
    if (word != "cpu" + std::to_string(last_cpu())) continue;
    std::int64_t hundredths = 0;
    for (int i = 0; i < 8; ++i) stat >> hundredths;
    return milliseconds(10 * hundredths);
  }
  return {};
}

// Sleeps to absolute instants on the same processor, above everything, and keeps the largest lateness it saw. What was
// taken in slices too short for it to see counts too, where the hypervisor tells.
class Witness {
 public:
  Witness() : stolen_before_(stolen()), thread_([this] { watch(); }) {}
  Nanoseconds worst() {
    stop_.store(true);
    thread_.join();
    return std::max(worst_, stolen() - stolen_before_);
  }

 private:
  void watch() {
    pin_here(60);
    LinuxClock clock;
    for (Nanoseconds next = clock.now() + kWitnessPeriod; !stop_.load(); next += kWitnessPeriod) {
      clock.wait_until(next);
      worst_ = std::max(worst_, clock.now() - next);
    }
  }
  std::atomic<bool> stop_{false};
  Nanoseconds worst_;
  const Nanoseconds stolen_before_;
  std::thread thread_;
};

}  // namespace chimera::toy
