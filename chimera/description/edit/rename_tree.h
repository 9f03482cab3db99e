// SPDX-License-Identifier: Apache-2.0
// A new name for a part of a description, in all places that name it.
#pragma once

#include "chimera/base/result.h"
#include "chimera/description/edit_act.h"
#include "chimera/description/node.h"

namespace chimera {

/// Refuses: no such part; a new name that is no name, or names another part already. Context: setup.
Result<void> rename_key(Node& root, const RenameKey& act);

/// Gives the variable or constant `from` the name `to`, wherever an alias, a condition, `operator:` or `constants:`
/// names it. Returns how many places did. Context: setup.
std::size_t rename_variable(Node& root, const std::string& from, const std::string& to);

/// True if an alias, `operator:` or `constants:` names this variable or constant. Context: setup.
bool is_variable_named(Node& root, const std::string& name);

}  // namespace chimera
