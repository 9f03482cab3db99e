// SPDX-License-Identifier: Apache-2.0
// TapRecords as a Chrome trace, which Perfetto and chrome://tracing open: docs/formats/trace.md.
#pragma once

#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "chimera/runtime/record/tap_record.h"

namespace chimera {

/// Writes one trace while records come in, sorted by their instants. The records of the last two seconds are held back,
/// because the record of a release comes only when its job starts. A record that comes later than that is written
/// out of order. Context: setup; may block.
class ChromeTrace {
 public:
  /// `file` stays open and the caller's. Names by index; records refer to them.
  /// Times are written relative to `origin`.
  ChromeTrace(std::FILE* file, std::string subsystem, std::span<const std::string> rtpus,
              std::span<const std::string> tasks, Nanoseconds origin);
  /// Adds records in the order in which they were written to the tap.
  void add(std::span<const TapRecord> records);
  /// Closes the JSON, saying how many records were lost, and `missed` before the first of all. Afterwards nothing more
  /// may be added. False when anything of the trace, now or before, could not be written: the file is cut short and
  /// errno is the last reason.
  [[nodiscard]] bool end(std::uint64_t lost, std::uint64_t missed);

 private:
  void event(const TapRecord& record, const char* phase, const std::string& name, const std::string& more);
  /// A record that waits for those before it.
  struct Held {
    Nanoseconds at;
    std::uint64_t number = 0;
    TapRecord record;
    bool is_deadline = false;  // of the job that `record` released
  };
  static bool comes_later(const Held& a, const Held& b) noexcept {
    return a.at != b.at ? a.at > b.at : a.number > b.number;
  }
  void hold(const TapRecord& record, Nanoseconds at, bool is_deadline);
  void write_until(Nanoseconds instant);
  void write(const TapRecord& record);
  void metadata(const char* what, std::size_t pid, std::size_t tid, const std::string& name);

  std::FILE* file_;
  std::string subsystem_;
  Nanoseconds origin_;
  bool is_first_ = true;
  std::vector<Held> held_;  // a heap, the earliest on top
  std::uint64_t n_held_ = 0;
};

/// `t` in microseconds with exactly three decimals: "1.234", "-0.001". No rounding.
std::string microseconds_text(Nanoseconds t);

}  // namespace chimera
