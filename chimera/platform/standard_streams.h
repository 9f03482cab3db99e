// SPDX-License-Identifier: Apache-2.0
// The standard streams of a program: whether printed text arrived, and the terminal behind a stream. A failed write is
// an error of the program, which it reports, and never a signal that ends it.
// docs/decisions/0023-exit-code-of-a-run.md.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "chimera/base/message.h"

namespace chimera {

/// Numbers of the standard streams.
inline constexpr int kStandardInput = 0, kStandardOutput = 1;

/// The first call of a program. Opens descriptors 0, 1 and 2 if they are closed, so that no other file gets their
/// numbers; reading and writing them still fails. Turns a file that may not grow further into an error of the write
/// instead of a signal (SIGXFSZ). Context: setup.
void hold_standard_streams() noexcept;

/// A reason beside those of the system: the output is there, and no process reads it.
inline constexpr int kNobodyReads = -1;

/// "No space left on device", for a number of the system. Context: any; wait-free.
const char* why_lost_text(int why) noexcept;

/// Flushes `stream`. Returns the first reason why text that was printed to it is lost; 0: none is lost. For streams
/// other than the standard streams, a loss of this call only. Context: cycle boundary; may block.
int flush_and_look(std::FILE* stream) noexcept;

/// The program has reported the loss: report_lost_output() prints nothing. Context: any.
void loss_is_told() noexcept;

/// The last call of a program: reports on standard error if standard output is lost. Returns `code`; 1 instead of 0 if
/// one of the two streams is lost. Context: cycle boundary; may block.
int report_lost_output(int code) noexcept;

/// Context: setup.
bool is_terminal(int descriptor) noexcept;

struct ScreenSize {
  std::size_t width = 80, height = 24;
};
/// Size of the terminal at `descriptor`, at most 1000 either way. Without a terminal: COLUMNS and LINES of the
/// environment, otherwise 80 by 24. Context: setup.
ScreenSize screen_size(int descriptor);

/// Writes all of `text` to standard output; stops at the first error. Context: setup; may block.
void write_out(std::string_view text) noexcept;
/// Waits for keys on standard input and appends them to `to`, at most 64 bytes. False at the end of the input.
/// Context: setup; blocks.
bool read_keys(std::string& to);

/// During its lifetime standard input delivers each key at once and without echo, and Ctrl-Z is a key. Does nothing if
/// standard input is no terminal. Context: setup.
class SingleKeys {
 public:
  SingleKeys();
  SingleKeys(const SingleKeys&) = delete;
  SingleKeys& operator=(const SingleKeys&) = delete;
  ~SingleKeys();

 private:
  struct Before;  // the settings of the terminal before
  std::unique_ptr<Before> before_;
};

}  // namespace chimera
