// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

#include "chimera/base/time.h"

namespace chimera::simulated {

/// Events in virtual time. Events of one instant happen in the order in which they were entered.
class Agenda {
 public:
  Nanoseconds now() const noexcept { return now_; }
  void after(Nanoseconds delay, std::function<void()> what) { at(now_ + delay, std::move(what)); }
  void at(Nanoseconds when, std::function<void()> what) {
    entries_.push({when > now_ ? when : now_, ++entered_, std::move(what)});
  }
  bool is_empty() const noexcept { return entries_.empty(); }
  void run_next() {
    Entry next = entries_.top();
    entries_.pop();
    now_ = next.when;
    next.what();
  }

 private:
  struct Entry {
    Nanoseconds when;
    std::uint64_t order = 0;
    std::function<void()> what;
    bool operator<(const Entry& other) const noexcept {
      return when != other.when ? when > other.when : order > other.order;
    }
  };
  Nanoseconds now_{seconds(1)};
  std::uint64_t entered_ = 0;
  std::priority_queue<Entry> entries_;
};

}  // namespace chimera::simulated
