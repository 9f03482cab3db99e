// SPDX-License-Identifier: Apache-2.0
// Writes the difference between two trees into the text of the first one. All other bytes stay.
#pragma once

#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/description/node.h"
#include "chimera/description/report.h"

namespace chimera {

/// `text` with the parts replaced, inserted and removed that differ between `old`, its tree, and `now`. A part of `now`
/// with a place is that part of `old`; order stays. New text is written as its neighbours are. `faults` are those of
/// the text: an edit over the place of one is refused. Proves nothing: read the result. Context: setup.
Result<std::string> spliced(std::string_view text, const Report& faults, const Node& old, const Node& now);

}  // namespace chimera
