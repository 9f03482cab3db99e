// SPDX-License-Identifier: Apache-2.0
// Checks published values: written, finite, and within the range of the port.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "chimera/load/descriptor.h"
#include "chimera/verify/configuration.h"

namespace chimera::component_test {

/// Describes the first bad value of a row ("y[1] is NaN", "tau is 210, outside -200 to 200"); nothing if all are good.
/// `counts` are the elements of each out-var in use, `outputs` their values in the layout of output_places(), `valid`
/// their bits. Context: setup.
std::optional<std::string> first_unsound(const Configuration& configuration, const Descriptor& component,
                                         std::span<const std::uint32_t> counts, std::span<const std::byte> outputs,
                                         std::uint64_t valid, bool with_ranges);

}  // namespace chimera::component_test
