// SPDX-License-Identifier: Apache-2.0
// Values of ports in the descriptions of lessons and tests, to be offered; and the lessons that use a component.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "chimera/description/node.h"
#include "chimera/web/documents.h"

namespace chimera::web {

/// A description, and the name by which a person finds it.
struct Example {
  std::string name;
  Node tree;
};

/// A value as written, and the description that has it.
struct OfferedValue {
  std::string value, origin;

  bool operator==(const OfferedValue&) const = default;
};

/// The descriptions examples/*/*.yaml of `documents`, in the order of their names; files that are no description are
/// left out. Context: setup; may block.
std::vector<Example> read_examples(const Documents& documents);
/// A description from its text; the tree is empty if the text is no tree. Context: setup.
Example example_of(std::string name, std::string_view text);

/// True if a task of the example has the component.
bool uses(const Example& example, std::string_view component);
/// Adds what the example gives to that port of that component, at most `most` in all, each value once. Context: setup.
void add_values(const Example& example, std::string_view component, std::string_view port, std::size_t most,
                std::vector<OfferedValue>& values);

}  // namespace chimera::web
