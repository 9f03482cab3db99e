// SPDX-License-Identifier: Apache-2.0
// Progress of the process that prints a run (the face), in memory that outlives it: the next one goes on from there.
// docs/formats/processes.md, "The run client".
#pragma once

#include <atomic>
#include <cstdint>

namespace chimera {

inline constexpr int kFacePageDescriptor = 3;  ///< of a face at its start

/// Zeroed at the start of a run. Each word has one writer. The keeper reads `beats` at any time, and it orders nothing;
/// the others are read by the other process between two lives of the face. They pair with nothing. Plain memory, mapped
/// by the keeper and the face.
struct FacePage {
  std::atomic<std::uint32_t> deaths{0};      ///< by the keeper: faces before this one that ended by a signal
  std::atomic<std::int32_t> last_signal{0};  ///< by the keeper: of which the last of them died
  // By the face.
  std::atomic<std::uint32_t> beats{0};        ///< grows each time that its loop comes round
  std::atomic<std::uint32_t> has_begun{0};    ///< 1: the tasks were ON and it said so
  std::atomic<std::uint32_t> acts_begun{0};   ///< timed acts that were asked for
  std::atomic<std::uint32_t> acts_done{0};    ///< those that were answered
  std::atomic<std::uint64_t> events_seen{0};  ///< number of the next event of which nothing was printed
  std::atomic<std::int32_t> lost_output{0};   ///< why standard output is lost, standard_output.h; 0: it is not
};

}  // namespace chimera
