// SPDX-License-Identifier: Apache-2.0
// Does in cycle what a real-time component must not do: allocates. Shows that a test that counts allocations can fail.
#include <memory>

#include "chimera/task/component.h"

using namespace chimera;

struct Allocator {
  InConst<std::int64_t> from{"from", "1", initial = 0, doc = "the first cycle, from 0, that allocates"};
  Out<std::int64_t> allocations{"allocations", "1", initial = 0};

  void cycle(Cycle c) {
    if (static_cast<std::int64_t>(c.count()) < *from) return;
    kept_ = std::make_unique<std::int64_t>(*allocations + 1);
    *allocations = *kept_;
  }
  std::unique_ptr<std::int64_t> kept_;
};
CHIMERA_COMPONENT(Allocator, "t_allocator", "Allocates in every cycle.", rate = 1000.0);
