// SPDX-License-Identifier: Apache-2.0
// Makes inputs that are read in place, copied, or refreshed together with others.
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

GroupInput GroupInput::following(LocalGroup& local) noexcept {
  GroupInput input = copied(local);
  input.refreshes_ = false;
  return input;
}

}  // namespace chimera
