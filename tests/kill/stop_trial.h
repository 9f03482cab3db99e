// SPDX-License-Identifier: Apache-2.0
// Two writer processes with a group each. The one that is read is stopped at a random instant, the other one takes
// over, the first goes on and ends what it had begun to write; two reader processes verify every word of every read.
#pragma once

#include <cstdint>
#include <string>

namespace chimera {

struct StopTrial {
  std::uint64_t stops = 2000;
  double seconds = 1e9;  ///< ends earlier when they are over
  std::uint64_t seed = 1;
  bool planted_defect = false;  ///< both write to one group: readers must notice
};

struct StopReport {
  std::uint64_t stops = 0;      ///< each with a takeover and a resumption
  std::uint64_t mid_write = 0;  ///< stops that came between the first word of a write and its end
  std::uint64_t reads = 0;      ///< by both readers
  std::uint64_t torn = 0;       ///< reads with words of two publications, or of a writer that is not read
  std::uint64_t backwards = 0;  ///< reads older than an earlier one of the same group
  std::uint64_t refused = 0;    ///< reads overtaken by the flooding writer: allowed, bounded
  std::string failure;          ///< why the trial ended early; empty when it did not

  std::uint64_t faults() const { return torn + backwards + (failure.empty() ? 0 : 1); }
};

/// Runs the trial; leaves no process behind. Single-threaded callers only: it forks.
StopReport run_stop_trial(const StopTrial& trial);

}  // namespace chimera
