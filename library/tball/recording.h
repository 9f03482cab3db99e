// SPDX-License-Identifier: Apache-2.0
// Input events from a file, in the text form of evemu-record:
//
//   E: 0.008000 0002 0000 0120      seconds.microseconds, type and code in hexadecimal, value in decimal
//
// Lines that start with # or with N:, I:, P:, B:, A:, L:, S: (heads of evemu) are skipped.
#pragma once

#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "library/tball/ball.h"

namespace chimera::library {

struct RecordedEvent {
  Nanoseconds at;  // since the first event of the file
  BallEvent event;
};

inline constexpr std::size_t kMostRecordedEvents = 1'000'000;

/// Throws std::runtime_error with path and line for a file that cannot be read, another kind of line, times that go
/// back, no event or too many. Context: setup; may block.
std::vector<RecordedEvent> read_recording(const std::string& path);

}  // namespace chimera::library
