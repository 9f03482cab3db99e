// SPDX-License-Identifier: Apache-2.0
// A model file becomes a MuJoCo model.
#pragma once

#include <string>

struct mjModel_;
struct mjVFS_;

namespace chimera::library {

/// The model in the file at `path`; null, with `why` in one line. Of a URDF file the collision meshes that cannot be
/// used are left out: then `note` says so, else it stays as it is. The caller deletes the model. Context: setup; may
/// block.
mjModel_* load_model(const char* path, std::string& why, std::string& note);

/// The model in one of `files`. Context: setup.
mjModel_* load_model(const char* path, const mjVFS_& files, std::string& why);

}  // namespace chimera::library
