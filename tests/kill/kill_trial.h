// SPDX-License-Identifier: Apache-2.0
// One writer process over a sealed segment, killed at a random instant and started again; two reader processes, on
// read-only mappings, verify every word of every read.
#pragma once

#include <cstdint>
#include <string>

namespace chimera {

struct KillTrial {
  std::uint64_t kills = 2000;
  double seconds = 1e9;  ///< ends earlier when they are over
  std::uint64_t seed = 1;
  bool planted_defect = false;  ///< the writer fills the slot that is published: readers must notice
};

struct KillReport {
  std::uint64_t kills = 0;
  std::uint64_t mid_write = 0;        ///< kills that came between the first word of a write and its end
  std::uint64_t reads = 0;            ///< by both readers
  std::uint64_t torn = 0;             ///< reads with words of two publications
  std::uint64_t backwards = 0;        ///< reads older than an earlier one
  std::uint64_t refused_dead = 0;     ///< reads that failed although no writer was alive
  std::uint64_t refused_alive = 0;    ///< reads overtaken by the flooding writer: allowed, bounded
  std::string failure;                ///< why the trial ended early; empty when it did not

  std::uint64_t faults() const { return torn + backwards + refused_dead + (failure.empty() ? 0 : 1); }
};

/// Runs the trial; leaves no process behind. Single-threaded callers only: it forks.
KillReport run_kill_trial(const KillTrial& trial);

}  // namespace chimera
