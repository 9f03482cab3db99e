// SPDX-License-Identifier: Apache-2.0
// Makes inputs that are read in place, copied, or refreshed together with others.
#include "chimera/table/transfer.h"

namespace chimera {

SharedGroupInput SharedGroupInput::direct(GroupReader reader) noexcept {
  SharedGroupInput input;
  input.reader_ = reader;
  return input;
}

SharedGroupInput SharedGroupInput::copied(LocalGroup& local) noexcept {
  SharedGroupInput input;
  input.local_ = &local;
  return input;
}

SharedGroupInput SharedGroupInput::following(LocalGroup& local) noexcept {
  SharedGroupInput input = copied(local);
  input.refreshes_ = false;
  return input;
}

}  // namespace chimera
