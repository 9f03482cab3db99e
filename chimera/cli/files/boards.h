// SPDX-License-Identifier: Apache-2.0
// The boards of a description: each rtpu with `target` is judged as `chimera bake` judges an image.
#pragma once

#include <string>
#include <vector>

#include "chimera/bake/bake.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/verify/configuration.h"

namespace chimera::cli {

struct BoardImage {
  RtpuId rtpu;
  bake::Target target;
  std::string target_file;
  Configuration part;        ///< what the board runs
  bake::BakeResult result;
};

struct Boards {
  std::vector<BoardImage> images;  ///< of the boards whose target could be read, in the order of the description
  Report faults;                   ///< of all boards, with places in the description
};

/// The number of the first rtpu with `target`, or of the one of that name if it is given; invalid: there is none.
RtpuId board_named(const Configuration& configuration, const std::string& name);

/// Bakes all boards in memory. A relative path of a target is one from the present folder. Context:
/// setup; may block.
Boards judge_boards(const Configuration& configuration, const Library& library, const Workplace& workplace);

/// A line about the board and its link, with "  " before it.
std::string board_text(const Configuration& configuration, const BoardImage& board);

}  // namespace chimera::cli
