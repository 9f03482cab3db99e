// SPDX-License-Identifier: Apache-2.0
// The data sheet of a component as a terminal shows it: what its descriptor says, and the sections of the README.md
// that stands beside it as NAME.md (docs/howto/write-a-component.md has the form).
#pragma once

#include <string>
#include <string_view>

#include "chimera/catalogue/library.h"

namespace chimera::cli {

/// The sheet as lines of text. Context: setup; may block.
std::string data_sheet(const LibraryEntry& entry);

/// A data sheet in Markdown as plain text, without its first line and its ports: headings without their marks, links by
/// their words, pictures by their names. Context: setup.
std::string plain_sheet(std::string_view markdown);

}  // namespace chimera::cli
