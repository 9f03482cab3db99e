// SPDX-License-Identifier: Apache-2.0
// Acts as JSON. docs/formats/edit.md defines the keys.
#pragma once

#include <span>

#include "chimera/base/result.h"
#include "chimera/description/edit_act.h"
#include "chimera/text/json.h"

namespace chimera {

/// {"act": "set", "path": "tasks/pid/rate", "value": "1 kHz"}. Context: setup.
Json edit_json(const EditAct& act);
/// An array of acts as JSON. Context: setup.
Json edits_json(std::span<const EditAct> acts);

/// Reads an array of acts. `ports` of `rename` and `producers` of `join` may be left out. Refuses, with the place
/// ("acts/2/path"), what is no act, and a key that is unknown, missing or of the wrong kind. Context: setup.
Result<std::vector<EditAct>> edit_acts(const Json& acts);

}  // namespace chimera
