// SPDX-License-Identifier: Apache-2.0
// The terminal while something live is on it, and waiting for whatever comes first. Ctrl-C, `q`, a signal and an
// exception all leave the terminal as it was found.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "chimera/control/client.h"
#include "chimera/platform/signal_queue.h"
#include "chimera/platform/standard_streams.h"

namespace chimera::cli {

/// The whole screen, keys one by one and without echo. Context of all: setup.
class FullScreen {
 public:
  FullScreen();
  ~FullScreen();
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;

  /// Shows `text` (whole lines, escape sequences allowed) from the upper left corner, in one write.
  void show(const std::string& text);

 private:
  SingleKeys keys_;
};

/// The event that ended a wait.
struct Wakeup {
  enum class By : char { kNote, kKey, kResize, kStop, kTime, kLost };
  By by = By::kTime;
  control::Note note;  ///< kNote
  int key = 0;         ///< kKey: a letter, or one of the arrows below
  Error error{};       ///< kLost
};
inline constexpr int kKeyUp = 1000, kKeyDown = 1001, kKeyPageUp = 1002, kKeyPageDown = 1003, kKeyEnd = -1;

/// While it lives, SIGINT, SIGTERM, SIGHUP and SIGWINCH are taken here instead of acting. Context: setup.
class InputWait {
 public:
  /// `keys`: also listen to standard input.
  explicit InputWait(bool keys);
  ~InputWait();
  InputWait(const InputWait&) = delete;
  InputWait& operator=(const InputWait&) = delete;

  /// The first thing that comes, at most until `limit` has passed. `client` may be null: no notes.
  Wakeup wait(control::Client* client, Nanoseconds limit);

 private:
  std::optional<Wakeup> read_signal();
  Wakeup read_key();

  SignalQueue signals_;
  bool keys_;
  std::string typed_;  ///< read and not yet taken
};

}  // namespace chimera::cli
