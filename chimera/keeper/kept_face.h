// SPDX-License-Identifier: Apache-2.0
// The face of a run as its keeper has it: replaced when it dies, because it is the one that ends the run in time.
// docs/formats/processes.md, "The run client".
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "chimera/platform/clock.h"
#include "chimera/platform/process.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/runtime/hosted/face_page.h"

namespace chimera {

/// Single-threaded. Context: setup; never blocks but in start() and end().
class KeptFace {
 public:
  /// `words`: program and arguments; none: a run without a face, of which nothing else is to be asked but is_wanted().
  explicit KeptFace(std::vector<std::string> words) : words_(std::move(words)) {}
  /// Ends the process of the face.
  ~KeptFace() { end(); }
  KeptFace(const KeptFace&) = delete;
  KeptFace& operator=(const KeptFace&) = delete;

  bool is_wanted() const noexcept { return !words_.empty(); }
  /// Starts it, for the first time or after a death. Refuses when it cannot be.
  Result<void> start();
  enum class Fate : std::uint8_t {
    kNothingNew,
    kExited,   ///< by itself, with code()
    kDied,     ///< by a signal
    kGivenUp,  ///< so too, too often in a short time
  };
  /// What has happened since the last look.
  Fate poll();
  /// "signal 9 (SIGKILL)": of what it died last.
  Message cause() const noexcept { return signal_text(page().last_signal); }
  bool lives() const noexcept { return process_.is_held(); }
  int code() const noexcept { return code_; }
  pid_t pid() const noexcept { return process_.pid(); }
  int pidfd() const noexcept { return process_.pidfd(); }
  void signal(int number) const noexcept { process_.signal(number); }
  /// Ends it at once, if it lives. May block for 1 s.
  void end();
  /// Requires: start() was called.
  FacePage& page() const noexcept { return *reinterpret_cast<FacePage*>(pages_.bytes().data()); }

 private:
  const std::vector<std::string> words_;
  LinuxClock clock_;
  SharedPages pages_;
  Process process_;
  int code_ = 0;
  std::vector<Nanoseconds> deaths_;
};

inline constexpr int kMostFaceDeaths = 3;
inline constexpr Nanoseconds kFaceDeathsWithin = seconds(10);

}  // namespace chimera
