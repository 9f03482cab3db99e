// SPDX-License-Identifier: Apache-2.0
// Source of ball events: an input device, a FIFO of its bytes, the keys of a terminal, a recording.
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
  /// Restores the mode of a terminal. Context: setup; wait-free.
  void close() noexcept;
  /// Opens a device that is gone again. Does nothing for a recording. Throws as open(). Context: cycle boundary; may
  /// block.
  void reopen();
  /// Drops waiting events, here and in the first calls of collect(), because they are older than `on`. A recording
  /// starts at its first event. Context: cycle boundary; at most one read.
  void start(Nanoseconds now) noexcept;
  /// Passes new events to the ball, at most kMostEvents. Returns false if the device is gone. Context: cycle; at most
  /// one read.
  bool collect(Ball& ball, std::int32_t full, Nanoseconds now) noexcept;
  /// Error number of the read that failed; 0: the other end is closed.
  int error() const noexcept { return error_; }

  static constexpr std::size_t kMostEvents = 64;

 private:
  static constexpr int kMostOldReads = 17;  // an input device stores a few hundred events at most
  enum class Kind { kNone, kEvents, kKeys, kRecording };

  void open_device(bool is_fifo);
  void make_raw();
  void forget() noexcept;
  /// Returns the bytes in buffer_, with those of a cut event before them; -1: the device is gone.
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
  std::size_t kept_ = 0;  // bytes of a cut event
  int old_reads_ = 0;     // reads that may still bring events from before start(); 0: none
  std::vector<RecordedEvent> recording_;
  std::size_t next_ = 0;
  Nanoseconds origin_;
};

}  // namespace chimera::library
