// SPDX-License-Identifier: Apache-2.0
// Loads a model file into a MuJoCo model.
#pragma once

#include <string>

struct mjModel_;
struct mjVFS_;

namespace chimera::library {

/// Loads the file at `path`. Returns null, with `why` in one line, on failure. Collision meshes of a URDF file that
/// cannot be used are left out; `note` then lists them, and is unchanged otherwise. The caller deletes the model.
/// Context: setup; may block.
mjModel_* load_model(const char* path, std::string& why, std::string& note);

/// Loads one of `files`. Context: setup.
mjModel_* load_model(const char* path, const mjVFS_& files, std::string& why);

}  // namespace chimera::library
