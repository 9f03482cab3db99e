// SPDX-License-Identifier: Apache-2.0
// Index types that cannot be mixed up: a TaskId is not a VariableId.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace chimera {

/// A dense index from 0 into the array of things that `Tag` names. Context: any; wait-free.
template <class Tag>
struct Id {
  std::uint32_t index = UINT32_MAX;

  constexpr Id() noexcept = default;
  constexpr explicit Id(std::uint32_t i) noexcept : index(i) {}
  constexpr explicit Id(std::size_t i) noexcept : index(static_cast<std::uint32_t>(i)) {}
  constexpr auto operator<=>(const Id&) const noexcept = default;
  constexpr bool is_valid() const noexcept { return index != UINT32_MAX; }
};

using TaskId = Id<struct TaskTag>;
using VariableId = Id<struct VariableTag>;
using ConstantId = Id<struct ConstantTag>;
using GroupId = Id<struct GroupTag>;
using RtpuId = Id<struct RtpuTag>;

}  // namespace chimera
