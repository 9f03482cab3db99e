// SPDX-License-Identifier: Apache-2.0
// One connection at the door: lines in, lines out, within the limits. Knows no method.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include "chimera/control/allowance.h"
#include "chimera/control/limits.h"
#include "chimera/control/rights.h"
#include "chimera/platform/linux/owned_descriptor.h"

namespace chimera::control {

/// Context: setup; never blocks.
class Session {
 public:
  Session(std::uint64_t number, OwnedDescriptor socket, PeerIdentity peer, Nanoseconds now)
      : number_(number), socket_(std::move(socket)), peer_(peer), moved_(now) {}

  std::uint64_t number() const noexcept { return number_; }
  int descriptor() const noexcept { return socket_.fd; }
  const PeerIdentity& peer() const noexcept { return peer_; }

  /// Takes what has come.
  void receive();
  /// The peer says nothing more.
  bool has_ended() const noexcept { return has_ended_; }
  /// The next whole line, without its end. A line longer than the limit comes cut behind it.
  bool take_line(std::string& line);
  /// Queues a line that has its end.
  void say(std::string line) { output_ += line; }
  /// Sends what can be sent. False when the peer is gone, or took nothing for too long.
  bool flush(Nanoseconds now);
  bool has_output() const noexcept { return sent_ < output_.size(); }
  /// Room for more: the peer takes what it is sent.
  bool has_room() const noexcept { return output_.size() - sent_ < kMaxOutput; }
  /// After what is queued the connection ends.
  void close_after() noexcept { is_closing_ = true; }
  bool is_closing() const noexcept { return is_closing_; }

  Allowance requests{1000, 200}, acts{100, 50};

 private:
  std::uint64_t number_;
  OwnedDescriptor socket_;
  PeerIdentity peer_;
  std::string input_, output_;
  std::size_t sent_ = 0;
  Nanoseconds moved_;  // when output last went, or there was none
  bool is_closing_ = false;
  bool has_ended_ = false;
};

}  // namespace chimera::control
