// SPDX-License-Identifier: Apache-2.0
// Deaths and lost output of the run client, as the keeper publishes them: events, and a part of `status`.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/text/json.h"

namespace chimera::manager {

struct ManagerState;

/// Logs each death and each loss once in the life of a manager.
class FaceWatch {
 public:
  /// Context: setup; may allocate.
  void look(ManagerState& state, Nanoseconds at);

 private:
  std::uint32_t deaths_ = 0;
  std::int32_t lost_ = 0;
};

/// {"deaths", "last_end", "lost_output"}: docs/formats/control.md.
Json face_json(const ManagerState& state);

}  // namespace chimera::manager
