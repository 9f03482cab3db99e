// SPDX-License-Identifier: Apache-2.0
#include "chimera/table/transfer.h"

namespace chimera {

GroupInput GroupInput::direct(GroupReader reader) noexcept {
  GroupInput input;
  input.reader_ = reader;
  return input;
}

GroupInput GroupInput::copied(LocalGroup& local) noexcept {
  GroupInput input;
  input.local_ = &local;
  return input;
}

std::uint32_t transfer_in(std::span<GroupInput> inputs) noexcept {
  std::uint32_t stale = 0;
  for (GroupInput& input : inputs)
    if (!input.latch()) ++stale;
  return stale;
}

}  // namespace chimera
