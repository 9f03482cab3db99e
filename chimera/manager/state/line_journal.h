// SPDX-License-Identifier: Apache-2.0
// Lines that are not on the disk yet, in memory that outlives the manager: a ring in its own block. Its successor reads
// the ring and files the lines.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace chimera::manager {

/// One writer. The last store of each call completes it: a manager that is killed before this store has not made the
/// call. Context: setup; never blocks.
class LineJournal {
 public:
  struct Head {
    std::atomic<std::uint64_t> begin{0}, end{0};  ///< bytes that were ever freed and put; empty unless begin < end
  };
  struct Entry {
    std::uint64_t number;
    std::uint32_t length;
    std::atomic<std::uint32_t> is_filed;
  };
  struct Line {
    std::uint64_t number;
    std::string_view text;
  };
  static constexpr std::size_t kHeadBytes = 64;

  /// Uses a journal of kHeadBytes and a multiple of 64 bytes for lines. Zeroed bytes are an empty journal.
  explicit LineJournal(std::span<std::byte> bytes) noexcept;
  /// Copies the lines of a dead predecessor into this empty journal. Leaves out what is inconsistent. Returns the
  /// largest number; 0: there is none.
  std::uint64_t take_over(std::span<const std::byte> left);

  /// Keeps a line. False if there is no room: then only the present manager has the line.
  bool put(std::uint64_t number, std::string_view text) noexcept;
  /// Lines that are not filed, in the order of put().
  std::vector<Line> unfiled() const;
  void filed(std::uint64_t number) noexcept;

 private:
  template <class Visit>
  void visit(Visit&& visit) const;
  void write(std::uint64_t at, const Entry& entry, std::string_view text) noexcept;

  Head* head_;
  char* text_;
  std::uint64_t size_;
};

}  // namespace chimera::manager
