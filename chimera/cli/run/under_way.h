// SPDX-License-Identifier: Apache-2.0
// The object that a process loads, or the method that it runs, in shared memory. Its parent reads it when the process
// is dead.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>

#include "chimera/catalogue/library.h"
#include "chimera/verify/configuration.h"

namespace chimera::cli {

/// Plain memory: one process writes, another reads. Context: setup, but for the words that an executor writes.
struct UnderWay {
  static constexpr std::size_t kMostTasks = 256;

  // Written where the run is, read by the parent when the process is dead, and by a watch to see whether a method takes
  // too long: figures that pair with nothing.
  std::atomic<std::uint32_t> making{0};   ///< as show_making() writes it
  std::atomic<std::uint32_t> running{0};  ///< as BlockHead::running
  std::atomic<std::uint32_t> serving{0};
  std::atomic<bool> is_ending{false};     ///< all tasks are being turned off and killed
  std::atomic<bool> has_returned{false};  ///< the work came to its end: what follows is the end of the process
  std::uint32_t n_tasks = 0;
  struct {
    char name[80], object[256];
  } tasks[kMostTasks];

  /// The names behind the words, before anything is loaded.
  void know(const Configuration& configuration, const Library& library);
  /// "while it loaded /lib/gain.so, the component of task 'amp'", "in amp.cycle", "at its end", or "" when nothing is
  /// known. Whatever stands in the memory is taken for words and nothing else.
  std::string text() const;
  /// The method that runs: its task, "" when none does, and whether it turns the task's hardware off.
  struct Method {
    std::string task, name;
    bool turns_off = false;
  };
  Method method() const;
  /// `running` and `serving` are not the same for as long as methods begin and end. Context: any; wait-free.
  std::uint64_t words() const noexcept { return std::uint64_t{running} << 32 | serving; }
};

/// The memory that this process writes to. It is private, and has no reader, until write_under_way_to() replaces it.
UnderWay& under_way() noexcept;
void write_under_way_to(UnderWay& place) noexcept;

/// One in memory that a child shares with its parent; nullptr when there is no memory.
UnderWay* make_shared_under_way() noexcept;
void release(UnderWay* place) noexcept;

}  // namespace chimera::cli
