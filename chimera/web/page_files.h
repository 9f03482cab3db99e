// SPDX-License-Identifier: Apache-2.0
// The files of the page, read once: docs/formats/web.md, "Requests".
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "chimera/base/result.h"

namespace chimera::web {

struct PageFile {
  const char* target;  ///< of a request
  const char* name;    ///< in the folder of the page
  const char* type;    ///< Content-Type
};
inline constexpr PageFile kPageFiles[] = {{"/", "index.html", "text/html; charset=utf-8"},
                                          {"/page.js", "page.js", "text/javascript; charset=utf-8"},
                                          {"/chunk.js", "chunk.js", "text/javascript; charset=utf-8"},
                                          {"/library.js", "library.js", "text/javascript; charset=utf-8"},
                                          {"/page.css", "page.css", "text/css; charset=utf-8"},
                                          {"/icon.svg", "icon.svg", "image/svg+xml"}};

/// Contents in the order of kPageFiles.
using PageContents = std::array<std::string, std::size(kPageFiles)>;

/// Reads the page of the program at `program`: from ../page beside its folder (a build tree), otherwise from
/// ../share/chimera/page. Refuses if a file is missing, with both folders. Context: setup; may block.
Result<PageContents> read_page(const std::string& program);

}  // namespace chimera::web
