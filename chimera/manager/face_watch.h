// SPDX-License-Identifier: Apache-2.0
// What becomes of the face of the run, as the keeper publishes it: events, and a part of `status`.
#pragma once

#include <cstdint>

#include "chimera/base/time.h"
#include "chimera/text/json.h"

namespace chimera::manager {

struct ManagerState;

/// Tells each death and each loss once in the life of a manager: the events of its predecessor are gone.
class FaceWatch {
 public:
  /// Context: setup; may allocate.
  void look(ManagerState& world, Nanoseconds at);

 private:
  std::uint32_t deaths_ = 0;
  std::int32_t lost_ = 0;
};

/// {"deaths", "last_end", "lost_output"}: docs/formats/control.md.
Json face_json(const ManagerState& world);

}  // namespace chimera::manager
