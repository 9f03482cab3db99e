// SPDX-License-Identifier: Apache-2.0
// The run client as its keeper holds it. A client that dies is replaced, because the client ends the run in time.
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

/// Single-threaded. Context: setup; blocks only in start() and end().
class KeptFace {
 public:
  /// `words`: program and arguments. If empty, the run has no client, and only is_wanted() may be called.
  explicit KeptFace(std::vector<std::string> words) : words_(std::move(words)) {}
  /// Ends the process of the client.
  ~KeptFace() { end(); }
  KeptFace(const KeptFace&) = delete;
  KeptFace& operator=(const KeptFace&) = delete;

  bool is_wanted() const noexcept { return !words_.empty(); }
  /// Starts the client, for the first time or after a death. Refuses if the process cannot start.
  Result<void> start();
  enum class Fate : std::uint8_t {
    kNothingNew,
    kExited,   ///< exit by itself, with code()
    kDied,     ///< death by a signal
    kGivenUp,  ///< too many deaths by signals in a short time
  };
  /// Polls the process for its end.
  Fate poll();
  /// Signal of the last death: "signal 9 (SIGKILL)".
  Message cause() const noexcept { return signal_text(page().last_signal); }
  bool lives() const noexcept { return process_.is_held(); }
  int code() const noexcept { return code_; }
  pid_t pid() const noexcept { return process_.pid(); }
  int pidfd() const noexcept { return process_.pidfd(); }
  void signal(int number) const noexcept { process_.signal(number); }
  /// Kills the client if it lives. May block for 1 s.
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
