// SPDX-License-Identifier: Apache-2.0
// Lines on their way to a file of the state directory: the receipts and the events of a subsystem. A thread writes
// them, so that a slow, full or stalled disk delays no other work.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chimera/manager/state/line_journal.h"
#include "chimera/manager/state/manager_state.h"

namespace chimera::manager {

/// Context: setup; blocks only in flush().
class Filing {
 public:
  static constexpr std::size_t kMostUnfiled = 1000;
  static constexpr Nanoseconds kTryAgain = seconds(10);  // after a fault

  struct Place {
    std::string folder;   ///< "": there is none
    std::string stem;     ///< name of the file without its ending, and of the lines in messages: "receipts"
    std::size_t n_found;  ///< lines to read at the start, the last ones of the file
    std::string run = {}; ///< only lines whose key ends with this
  };
  struct Line {
    std::uint64_t number;
    std::string text;
  };

  /// Files the lines that a predecessor left in `journal`. Refuses if a descriptor or thread cannot be made. `state`
  /// outlives it.
  static Result<std::unique_ptr<Filing>> start(ManagerState& state, LineJournal journal, const Place& place);
  Filing(const Filing&) = delete;
  Filing& operator=(const Filing&) = delete;
  ~Filing();

  /// Files a line, which the journal has if it has room.
  void add(std::uint64_t number, std::string line, Nanoseconds now);
  /// Readable when look() has a finished job; -1: never.
  int descriptor() const noexcept;
  Nanoseconds next_due() const noexcept;
  void look(Nanoseconds now);
  /// The lines that were read at the start, once; none before they are read.
  std::optional<std::vector<std::string>> take_found() { return std::exchange(found_, std::nullopt); }
  /// The next look() tries again after a fault, before kTryAgain is over.
  void try_again(Nanoseconds now) noexcept { tries_again_ = now; }
  /// Files the remaining lines; blocks for `limit` at most.
  void flush(Nanoseconds limit);

  const std::deque<Line>& unfiled() const noexcept { return unfiled_; }
  bool is_unfiled(std::uint64_t number) const;
  bool has_read() const noexcept { return has_read_; }          ///< the lines that the file had at the start
  const std::string& path() const noexcept { return path_; }    ///< "": there is no file
  const std::string& fault() const noexcept { return fault_; }  ///< why the last ones are not filed; "": they are filed

 private:
  class Writer;
  Filing(ManagerState& state, LineJournal journal, std::string stem);
  void take_done(const std::string& fault, Nanoseconds now);
  void file_next(Nanoseconds now);
  void lose_oldest(Nanoseconds now);
  void note(const std::string& text, Nanoseconds now) { state_.tell("note", TaskId{}, RtpuId{}, text, now); }

  ManagerState& state_;
  LineJournal journal_;
  std::string stem_, path_, fault_;
  std::unique_ptr<Writer> writer_;  // null: there is no folder
  std::deque<Line> unfiled_;
  std::size_t in_flight_ = 0;  // number of first entries of unfiled_ that the writer has
  std::uint64_t lost_ = 0;     // since lines were filed last
  bool has_read_ = false;
  std::optional<std::vector<std::string>> found_;
  Nanoseconds tries_again_;  // earliest time of the next try
};

}  // namespace chimera::manager
