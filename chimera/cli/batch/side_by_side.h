// SPDX-License-Identifier: Apache-2.0
// Many pieces of work in child processes, at most one a processor at a time. A piece that crashes or hangs has failed;
// the other pieces go on.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "chimera/base/time.h"

namespace chimera::cli {

/// The result of one piece.
struct PieceEnd {
  std::string said;     ///< what it answered
  std::string failure;  ///< why there is no answer: "ended by signal 11 (Segmentation fault)"; empty: there is one
  Nanoseconds wall;     ///< how long it took
};

struct SideBySide {
  std::size_t pieces = 0;
  std::size_t jobs = 1;                                 ///< at a time
  Nanoseconds limit = kNever;                           ///< of the clock on the wall, for each piece
  std::function<std::string(std::size_t)> work;         ///< runs in the child; its output goes nowhere
  std::function<void(std::size_t)> on_done = [](auto) {};  ///< after each, how many are done
};

/// The ends in the order of the pieces, whichever was ready first. After request_stop() what still runs is ended, and
/// whatever has no answer failed by that. Call it with one thread. Context: setup; blocks.
std::vector<PieceEnd> side_by_side(const SideBySide& plan);

/// The number of processors that this process may use.
std::size_t processors();

}  // namespace chimera::cli
