// SPDX-License-Identifier: Apache-2.0
// Helpers for tests with real threads and processes: waiting, and recording of durations.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "chimera/base/time.h"

namespace chimera {

/// A test that waits longer than this hangs. On a busy machine a shorter limit could fail without a fault.
inline constexpr Nanoseconds kHangLimit = seconds(60);

/// Polls `holds` every millisecond. Returns true as soon as it holds, false after kHangLimit.
template <class Holds>
[[nodiscard]] bool await_that(const Holds& holds) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::nanoseconds(kHangLimit.count);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > limit) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// Prints a duration and adds it to the results of the test. No test checks the duration, because it depends on the
/// machine.
inline void record_duration(const std::string& what, Nanoseconds time) {
  std::printf("%s: %lld us\n", what.c_str(), static_cast<long long>(time.count / 1000));
  ::testing::Test::RecordProperty(what + "_us", std::to_string(time.count / 1000));
}

}  // namespace chimera
