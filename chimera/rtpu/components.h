// SPDX-License-Identifier: Apache-2.0
// The code of a real-time unit's tasks: opens their shared objects and holds each against what verification saw.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/load/sealed_objects.h"
#include "chimera/runtime/hosted/application_image.h"
#include "chimera/task/abi.h"

namespace chimera {

/// The component of every task of `rtpu`; nullptr for those of others. Refuses, with the task in `where`: what
/// SealedObjects::link refuses, and a component that is no longer the one that was verified. Linking an object runs
/// code of the object: meanwhile `serving` tells the watch of this unit which task it is, and `making` tells who finds
/// it dead. Context: setup; may block.
Result<std::vector<const chimera_component*>> load_components(const ApplicationImage& image,
                                                              const SealedObjects& objects, RtpuId rtpu,
                                                              std::atomic<std::uint32_t>& serving,
                                                              std::atomic<std::uint32_t>& making);

}  // namespace chimera
