// SPDX-License-Identifier: Apache-2.0
// Where the events of a ball come from: an input device or a FIFO of its bytes, a terminal's keys, a recording.
#pragma once

#include <linux/input.h>
#include <termios.h>

#include <string>
#include <vector>

#include "library/tball/recording.h"

namespace chimera::library {

class BallSource {
 public:
  BallSource() = default;
  BallSource(const BallSource&) = delete;
  BallSource& operator=(const BallSource&) = delete;
  ~BallSource() { close(); }

  /// Throws std::runtime_error with the path and a remedy. Context: setup; may block.
  void open(const std::string& path);
  /// A terminal gets back the mode it had. Context: setup; wait-free.
  void close() noexcept;
  /// A device that is gone is opened again; a recording needs nothing. Throws as open(). Context: cycle boundary; may
  /// block.
  void reopen();
  /// What waits is forgotten, here and by the first calls of collect(): it is of a time nobody was there. A recording
  /// starts at its first event. Context: cycle boundary; at most one read.
  void start(Nanoseconds now) noexcept;
  /// Gives the ball what has come, at most kMostEvents; false: the device is gone. Context: cycle; at most one read.
  bool collect(Ball& ball, std::int32_t full, Nanoseconds now) noexcept;
  /// Error number of the read that failed; 0: nobody is at the other end.
  int error() const noexcept { return error_; }

  static constexpr std::size_t kMostEvents = 64;

 private:
  static constexpr int kMostOldReads = 17;  // an input device keeps a few hundred events at most
  enum class Kind { kNone, kEvents, kKeys, kRecording };

  void open_device(bool is_fifo);
  void make_raw();
  void forget() noexcept;
  /// Bytes now in buffer_, those of a cut event before them included; -1: the device is gone.
  int fill(std::size_t most) noexcept;
  void collect_recorded(Ball& ball, Nanoseconds now) noexcept;
  void take_events(Ball& ball, std::size_t bytes, Nanoseconds now) noexcept;
  void take_keys(Ball& ball, std::size_t bytes, std::int32_t full, Nanoseconds now) const noexcept;

  std::string path_;
  Kind kind_ = Kind::kNone;
  int file_ = -1;
  int error_ = 0;
  bool has_mode_ = false;
  termios mode_{};
  alignas(input_event) char buffer_[kMostEvents * sizeof(input_event)];
  std::size_t kept_ = 0;  // bytes of an event that was cut
  int old_reads_ = 0;     // so many at most bring what waited before start(); 0: it is forgotten
  std::vector<RecordedEvent> recording_;
  std::size_t next_ = 0;
  Nanoseconds origin_;
};

}  // namespace chimera::library
