// SPDX-License-Identifier: Apache-2.0
// `chimera bake`: the files of an image for a microcontroller, out of a description and a target.
#pragma once

#include <string>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/cli/command/command_result.h"
#include "chimera/verify/setting.h"

namespace chimera::cli {

struct BakeRequest {
  std::string file;
  std::string target;   ///< a name, or a path that ends in .yaml; "": as the description says of the board
  std::string rtpu = {};  ///< the board to bake; "": the first one, or the whole description if it has none
  std::string profile;  ///< recorded on the target; "": deadlines are not judged
  std::string out;      ///< the folder of the files; made if it is missing
  std::vector<std::string> at;         ///< timed acts, run/script_text.h
  Nanoseconds duration = kNever;       ///< the image ends itself after it
  std::vector<Setting> settings = {};  ///< values in the place of those of the file
  bool json = false;
};

/// Reads, verifies, judges and writes. kRefused with every reason, and no file is written then. Context: setup; may
/// block.
CommandResult bake(const BakeRequest& request, const Workplace& workplace);

}  // namespace chimera::cli
