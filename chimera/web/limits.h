// SPDX-License-Identifier: Apache-2.0
// The limits and close codes of the page: docs/formats/web.md.
#pragma once

#include <cstddef>
#include <cstdint>

#include "chimera/base/time.h"

namespace chimera::web {

inline constexpr std::uint16_t kFirstPort = 7440, kLastPort = 7449;
inline constexpr std::size_t kMaxSockets = 64;    ///< WebSockets
inline constexpr std::size_t kMaxStrangers = 16;  ///< connections that have shown no key
inline constexpr std::ptrdiff_t kMaxPages = 12;   ///< WebSockets to /bench
inline constexpr std::size_t kMaxKeyFrame = 128, kMaxReason = 123;
inline constexpr std::size_t kChunk = std::size_t{1} << 14;  ///< bytes that wait in this process, in each direction
inline constexpr int kSendBuffer = 1 << 16;                  ///< bytes that wait in the kernel, about
inline constexpr Nanoseconds kHeadLimit = seconds(10), kKeyLimit = seconds(5), kAnswerLimit = seconds(60);
inline constexpr Nanoseconds kPingAfter = seconds(5), kSilenceLimit = seconds(15), kStuckLimit = seconds(5);
inline constexpr Nanoseconds kCloseLimit = seconds(2);
/// Time that a connection without a key has for its request before another one may take its place.
inline constexpr Nanoseconds kStrangerTime = milliseconds(250);
inline constexpr Nanoseconds kSweepPeriod = milliseconds(250);  ///< of looks at the limits of time

/// Codes of a close frame.
inline constexpr std::uint16_t kEnds = 1001, kNoText = 1003, kNoLine = 1007, kWrongKey = 4401, kNoMachine = 4404,
                               kSilent = 4408, kFull = 4429, kDoorEnded = 4502;

}  // namespace chimera::web
