// SPDX-License-Identifier: Apache-2.0
// The digest of a run: for each second and task the number of its publications and faults, and a hash of them. It is
// equal on all machines that run the same application: docs/formats/digest.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chimera/base/setup_memory.h"
#include "chimera/task/task.h"

namespace chimera {

/// One second of one task. Plain value.
struct DigestLine {
  std::int64_t second = 0;  ///< since the origin of the grid of releases
  TaskId task;
  std::uint64_t publications = 0, faults = 0;
  std::uint64_t hash = 0;
};

/// Receives the lines of a digest. A task's lines come in order of time.
class DigestLines {
 public:
  virtual void take(const DigestLine& line) noexcept = 0;

 protected:
  ~DigestLines() = default;
};

/// Context of everything not marked: cycle; wait-free; O(bytes that it hashes), and what DigestLines::take takes.
class Digest {
 public:
  /// `lines` outlives this. Context: setup.
  Digest(std::size_t n_tasks, DigestLines& lines, SetupMemory& memory);

  /// The grid of releases starts at `origin`.
  void begin(Nanoseconds origin) noexcept { origin_ = origin; }
  /// Adds the latest publication of the task.
  void add_publication(const Task& task) noexcept;
  /// Adds the faults of the task since the last call: their number, and the last one whole.
  void add_faults(const Task& task) noexcept;
  /// Hands over the lines that are not complete yet.
  void end() noexcept;

 private:
  struct OfTask {
    DigestLine line;
    std::uint64_t faults_seen = 0;
  };
  OfTask& of(const Task& task) noexcept;
  void hand_over(DigestLine& line) noexcept;

  std::span<OfTask> of_;
  DigestLines& lines_;
  Nanoseconds origin_;
};

}  // namespace chimera
