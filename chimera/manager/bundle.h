// SPDX-License-Identifier: Apache-2.0
// What `chimera run` read at its start, as one text: with it another process makes the identical Configuration without
// reading a file, now and after every restart, whatever has become of the files. docs/formats/bundle.md.
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
  /// Groups whose members get that role at the door; nobody beside root and the keeper's user when not given.
  std::optional<std::uint32_t> observe_group, operate_group, configure_group;
  Library library;          ///< all installed components and the units
  std::vector<Setting> settings = {};  ///< values in the place of those of the text

  bool is_idle() const noexcept { return description.empty(); }
};

/// The bundle as text, without a zero. Context: setup; may block.
std::string encode(const Bundle& bundle);

/// The bundle in `text`; zeros behind it (the rest of a page) are passed over. Refuses, saying where, what is no
/// bundle of this version, and a descriptor or unit text that their readers refuse. Context: setup; may block.
Result<Bundle> decode_bundle(std::string_view text);

/// Verifies the description, with the settings, of a bundle that is not idle: keeper and manager come to one verdict.
/// Context: setup.
Verdict verify(const Bundle& bundle);

}  // namespace chimera::manager
