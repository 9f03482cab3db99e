// SPDX-License-Identifier: Apache-2.0
// For tests and figures: where the files of the source tree and of this build tree are. ctest and ./dev say it in
// CHIMERA_SOURCE and CHIMERA_BUILD; without them it is the checkout that a test is started in, and its debug tree.
#pragma once

#include <cstdlib>
#include <string>

namespace chimera {

inline std::string tree_path(const char* variable, const char* otherwise, const std::string& path) {
  const char* root = std::getenv(variable);
  return (root != nullptr ? root : otherwise) + ("/" + path);
}

/// `path` is as seen from the root of the checkout: "library/tball/wave.events". Context: setup.
inline std::string source_path(const std::string& path) { return tree_path("CHIMERA_SOURCE", ".", path); }

/// `path` is as seen from the root of the build tree: "bin/chimera". Context: setup.
inline std::string build_path(const std::string& path) { return tree_path("CHIMERA_BUILD", "build/debug", path); }

}  // namespace chimera
