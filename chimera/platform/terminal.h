// SPDX-License-Identifier: Apache-2.0
// The terminal behind a descriptor: whether there is one, how large it is, and its keys one by one.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace chimera {

/// Numbers of the standard streams.
inline constexpr int kStandardInput = 0, kStandardOutput = 1;

/// Context: setup.
bool is_terminal(int descriptor) noexcept;

struct ScreenSize {
  std::size_t width = 80, height = 24;
};
/// Of the terminal at `descriptor`, at most 1000 either way; COLUMNS and LINES, else 80 by 24, where there is none.
/// Context: setup.
ScreenSize screen_size(int descriptor);

/// Writes all of `text` to standard output; gives up when nobody takes it. Context: setup; may block.
void write_out(std::string_view text) noexcept;
/// Appends to `to` what has been typed on standard input, at most 64 bytes at once, waiting for the first. False when
/// there is no more to come. Context: setup; blocks.
bool read_keys(std::string& to);

/// While it lives keys of standard input come one by one and without echo, and Ctrl-Z is a key. Does nothing where
/// standard input is no terminal. Context: setup.
class SingleKeys {
 public:
  SingleKeys();
  SingleKeys(const SingleKeys&) = delete;
  SingleKeys& operator=(const SingleKeys&) = delete;
  ~SingleKeys();

 private:
  struct Before;  // the terminal as it was found
  std::unique_ptr<Before> before_;
};

}  // namespace chimera
