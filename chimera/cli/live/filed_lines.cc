// SPDX-License-Identifier: Apache-2.0
// Finds the file of a subsystem in the state directory and reads its last lines.
#include "chimera/cli/live/filed_lines.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>

#include "chimera/base/hosted/wording.h"
#include "chimera/control/rotated_file.h"
#include "chimera/control/state_folder.h"

namespace chimera::cli {
namespace {

/// The subsystems with such a file, in order.
std::vector<std::string> all_with(const std::string& stem) {
  std::vector<std::string> all;
  std::error_code error;
  for (std::filesystem::directory_iterator at(control::state_folder(), error), end; !error && at != end;
       at.increment(error))
    if (std::filesystem::exists(control::RotatedFile(at->path().string(), stem).path(), error))
      all.push_back(at->path().filename().string());
  std::ranges::sort(all);
  return all;
}

}  // namespace

Result<FiledLines> filed_lines(const std::string& stem, const std::string& subsystem, std::size_t n, const Error& why) {
  if (why.code != ErrorCode::kNotFound) return why;  // it may run
  const char* chosen = std::getenv("CHIMERA_SUBSYSTEM");
  const std::string asked = !subsystem.empty() ? subsystem : chosen != nullptr ? chosen : "";
  const std::vector<std::string> all = asked.empty() ? all_with(stem) : std::vector{asked};
  if (all.size() > 1) {
    const std::string others = join(std::span(all).subspan(1), ", ");
    const std::string text = std::string(why.message.view()) + "; " + stem + " of earlier runs: `chimera " + stem +
                             " --subsystem " + all[0] + "`, also " + others;
    return Error{why.code, std::string_view(text), why.where};
  }
  const std::string name = all.empty() ? "" : all[0];
  if (name.empty() || name.find('/') != std::string::npos) return why;
  const control::RotatedFile file(control::state_folder_of(name), stem);
  FiledLines filed{name, file.path(), file.last(n)};
  if (filed.lines.empty()) return why;
  return filed;
}

}  // namespace chimera::cli
