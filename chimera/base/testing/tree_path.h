// SPDX-License-Identifier: Apache-2.0
// Finds files of the source tree and of the build tree, for tests and figures. ctest and ./dev set CHIMERA_SOURCE and
// CHIMERA_BUILD. Without them, a test uses its current directory as the checkout, with the debug tree.
#pragma once

#include <cstdlib>
#include <string>

namespace chimera {

inline std::string tree_path(const char* variable, const char* otherwise, const std::string& path) {
  const char* root = std::getenv(variable);
  return (root != nullptr ? root : otherwise) + ("/" + path);
}

/// `path` is relative to the root of the checkout: "library/tball/wave.events". Context: setup.
inline std::string source_path(const std::string& path) { return tree_path("CHIMERA_SOURCE", ".", path); }

/// `path` is relative to the root of the build tree: "bin/chimera". Context: setup.
inline std::string build_path(const std::string& path) { return tree_path("CHIMERA_BUILD", "build/debug", path); }

}  // namespace chimera
