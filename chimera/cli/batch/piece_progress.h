// SPDX-License-Identifier: Apache-2.0
// Shows on the terminal how many pieces of work are done.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

#include "chimera/base/time.h"

namespace chimera::cli {

/// "12 of 100 runs, about 8 s to go"; without an estimate while nothing is done yet, and at the end. Context: setup.
std::string pieces_text(std::size_t done, std::size_t all, const std::string& noun, Nanoseconds wall);

/// Writes each line over the one before; silent unless `err` is a terminal. Context: setup.
class PieceProgress {
 public:
  PieceProgress(std::size_t all, std::string noun, std::FILE* err);
  void show(std::size_t done);
  void wipe();

 private:
  std::size_t all_;
  std::string noun_;
  std::FILE* err_;
  bool is_on_, has_written_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now(), next_ = begin_;
};

}  // namespace chimera::cli
