// SPDX-License-Identifier: Apache-2.0
// The file of `chimera run --digest`: docs/formats/digest.md.
#pragma once

#include <string>
#include <vector>

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/record/digest.h"

namespace chimera::cli {

/// Keeps the lines of a digest. Context: setup; allocates.
class DigestText final : public DigestLines {
 public:
  void take(const DigestLine& line) noexcept override { lines_.push_back(line); }
  /// The lines by second, then by task, under a heading.
  std::string text(const ApplicationSpec& spec) const;

 private:
  std::vector<DigestLine> lines_;
};

}  // namespace chimera::cli
