// SPDX-License-Identifier: Apache-2.0
// `chimera save --write`: the operator's present values into the description file; nothing else in it changes.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/config/unit_system.h"
#include "chimera/shell/command.h"
#include "chimera/shell/session.h"

namespace chimera::shell {

/// `text` with the values under `operator:` replaced by those of `values` (name -> words of a description). A value
/// that says the same already, in whatever units, is left as it is written. Refuses: a text that cannot be read, a
/// name that is not there. Context of all: setup.
Result<std::string> with_operator_values(std::string_view text, const std::map<std::string, std::string>& values,
                                         const UnitSystem& units);

/// Asks for the values, edits the file that the subsystem was started from, has the result checked by the subsystem,
/// and puts it in the place of the old file in one step. Refuses, changing nothing: a file that changed since the
/// start (but by this command), one that cannot be read or written, a result that is not legal. May block.
Said save_to_file(Session& session, const Call& call);

}  // namespace chimera::shell
