// SPDX-License-Identifier: Apache-2.0
// `chimera new component NAME`, `app NAME` and `firmware NAME`: a small project that builds and passes its
// tests at once, anywhere, from the templates in share/chimera/templates.
#pragma once

#include <string>

#include "chimera/cli/files/file_refusal.h"

namespace chimera::cli {

enum class NewKind { kComponent, kComponentInC, kHardwareComponent, kApplication, kFirmware };

struct NewRequest {
  NewKind kind = NewKind::kComponent;
  std::string name;          ///< [a-z][a-z0-9_]*, at most 40 letters
  std::string parent = ".";  ///< the project becomes parent/name
};

/// Writes the project and says how to build it against the tree that `program` (its own path) belongs to: a build
/// tree or an installation. Refuses, with nothing written: an illegal name, a folder that exists already, a parent
/// that does not, an installation without templates. Context: setup; may block.
CommandResult new_project(const NewRequest& request, const std::string& program);

}  // namespace chimera::cli
