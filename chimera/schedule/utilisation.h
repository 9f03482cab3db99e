// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace chimera {

/// Share of a processor that real-time work may use: Linux throttles real-time threads above 0.95.
inline constexpr double kMaxUtilisation = 0.93;

/// Before the kernel's own limit, by so much, jobs give way: it counts more than their executor sees of them.
inline constexpr double kShareMargin = 0.005;

/// Whether shares of a processor that add up to `sum` are more than `limit`; how they are rounded does not count.
/// Context: setup; pure.
constexpr bool is_beyond(double sum, double limit = kMaxUtilisation) noexcept { return sum > limit + 1e-9; }

}  // namespace chimera
