// SPDX-License-Identifier: Apache-2.0
// All that `chimera run` read at its start, as one text. Another process makes the identical Configuration from it
// without reading a file, at every restart, even if the files have changed. docs/formats/bundle.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/catalogue/library.h"
#include "chimera/verify/setting.h"
#include "chimera/verify/verify.h"

namespace chimera::manager {

/// Plain value.
struct Bundle {
  std::string program;      ///< version of the program, "0.1.0"
  std::string file;         ///< the description as its user named it; "" when idle
  std::string description;  ///< its text; "" when idle: nothing is loaded
  /// Groups whose members get that role at ControlServer. Without a group only root and the keeper's user have the
  /// role.
  std::optional<std::uint32_t> observe_group, operate_group, configure_group;
  Library library;          ///< all installed components and the units
  std::vector<Setting> settings = {};  ///< values that replace those of the text

  bool is_idle() const noexcept { return description.empty(); }
};

/// The bundle as text, without a zero. Context: setup; may block.
std::string encode(const Bundle& bundle);

/// The bundle in `text`; ignores zeros after it (the rest of a page). Refuses, with the place, a text that is not a
/// bundle of this version, and a descriptor or unit text that its reader refuses. Context: setup; may block.
Result<Bundle> decode_bundle(std::string_view text);

/// Verifies the description of a bundle that is not idle, with its settings. Keeper and manager reach the same verdict.
/// Context: setup.
Verdict verify(const Bundle& bundle);

}  // namespace chimera::manager
