// SPDX-License-Identifier: Apache-2.0
// Acts as JSON. docs/formats/edit.md defines the keys.
#pragma once

#include "chimera/description/edit_act.h"
#include "chimera/text/json.h"

namespace chimera {

/// {"act": "set", "path": "tasks/pid/rate", "value": "1 kHz"}. Context: setup.
Json edit_json(const EditAct& act);

}  // namespace chimera
