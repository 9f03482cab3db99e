// SPDX-License-Identifier: Apache-2.0
// The code of an rtpu's tasks: opens their shared objects and compares each component with the verified one.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/load/sealed_objects.h"
#include "chimera/runtime/hosted/application_image.h"
#include "chimera/task/abi.h"

namespace chimera {

/// Returns the component of every task of `rtpu`; nullptr for tasks of other rtpus. Refuses a component that changed
/// after it was verified, and every refusal of SealedObjects::link; `where` names the object file.
/// Linking runs code of the object. During it, `serving` names the task to this rtpu's supervision, and `making` to the
/// processes that find the rtpu dead. Context: setup; may block.
Result<std::vector<const chimera_component*>> load_components(const ApplicationImage& image,
                                                              const SealedObjects& objects, RtpuId rtpu,
                                                              std::atomic<std::uint32_t>& serving,
                                                              std::atomic<std::uint32_t>& making);

}  // namespace chimera
