// SPDX-License-Identifier: Apache-2.0
// Makes the files of an image out of a legal description and a target, or all reasons why there can be none.
// docs/formats/baked.md, docs/formats/target.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chimera/analysis/recorded_profile.h"
#include "chimera/bake/mechanisms.h"
#include "chimera/bake/memory.h"
#include "chimera/bake/target.h"
#include "chimera/catalogue/library.h"
#include "chimera/runtime/cycle/script.h"
#include "chimera/verify/configuration.h"

namespace chimera::bake {

struct BakedFile {
  std::string name;  ///< without a folder
  std::string text;
};

struct BakeInput {
  const Configuration& configuration;
  const Target& target;
  std::string target_file;  ///< for messages
  const Library& library;
  const RecordedProfile* profile = nullptr;  ///< recorded on the target; null: deadlines are not judged
  std::span<const ScriptAct> acts;           ///< in order of time
  Nanoseconds duration = kNever;
  LinkSpec link = {};                        ///< of a board whose part this is; then no task is ON at the start
};

struct BakeResult {
  Report description;  ///< faults of the description
  Report target;       ///< faults of the target
  MemoryNeed memory;
  std::vector<Mechanism> mechanisms;
  std::vector<std::string> notes;
  std::vector<BakedFile> files;  ///< none if there is a fault

  bool is_baked() const noexcept { return !files.empty(); }
};

/// Context: setup; pure.
BakeResult bake(const BakeInput& input);

}  // namespace chimera::bake
