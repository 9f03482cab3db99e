// SPDX-License-Identifier: Apache-2.0
// Acts done to the tree of a description. New parts have no place (line 0); all others keep theirs, by which
// text_splice.h finds them in the text.
#pragma once

#include <string>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/description/edit_act.h"
#include "chimera/description/node.h"

namespace chimera {

/// Changes `root` as the act says. Refuses, with the path: a place that does not exist, a name that is no name or in
/// use already, a value that YAML cannot read. After a refusal `root` may be half changed. Context: setup.
Result<void> act_on(Node& root, const EditAct& act);

// The parts of act_on() that other acts need.

Error no_edit(const EditPath& path, const std::string& message);
Node scalar_node(std::string text);
/// Nullptr if the tree has no such place.
Node* found(Node& root, const EditPath& path);
/// The place, made if it is missing.
Result<Node*> made(Node& root, const EditPath& path);
void insert_key(Node& map, std::size_t at, std::string key, Node value);
/// Refuses what is no name of a description.
Result<void> check_new_name(const EditPath& path, const std::string& name);
Result<void> link_port(Node& root, const LinkPort& act);

}  // namespace chimera
