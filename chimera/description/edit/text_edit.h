// SPDX-License-Identifier: Apache-2.0
// Edits of the text of a description. Comments, order, spacing and line ends stay. docs/formats/edit.md defines the
// acts.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "chimera/base/result.h"
#include "chimera/description/edit_act.h"

namespace chimera {

/// `text` after these acts, one after the other. An empty text is a description without keys. The result is proved: its
/// tree is the old tree after the acts, and it has no new fault of the text. All bytes outside of the parts concerned
/// are copied. To undo, keep the old text.
/// Refuses all or none, with the place in the text ("12:8") or in the tree ("tasks/pid"): a text that is no YAML or has
/// a key twice; what act_on() refuses; an edit over an anchor, alias, tag or block scalar; an edit whose proof fails.
/// Context: setup; takes the time of two readings for each act.
Result<std::string> edit_text(std::string_view text, std::span<const EditAct> acts);

}  // namespace chimera
