// SPDX-License-Identifier: Apache-2.0
// Input events from a file, in the text that evemu-record writes:
//
//   E: 0.008000 0002 0000 0120      seconds.microseconds, type and code in hexadecimal, value in decimal
//
// Lines that start with # or with N:, I:, P:, B:, A:, L:, S: (evemu's heads) are passed over.
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

/// Throws std::runtime_error with path and line for a file that cannot be read, a line that is none of these, times
/// that go back, no event at all or too many of them. Context: setup; may block.
std::vector<RecordedEvent> read_recording(const std::string& path);

}  // namespace chimera::library
