// SPDX-License-Identifier: Apache-2.0
// Prints values in the background. A terminal that stalls costs lines but delays no cycle. README.md is the data sheet.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "chimera/task/component.h"
#include "chimera/task/number_at.h"
#include "library/signals/row_ring.h"

using namespace chimera;

namespace {

constexpr std::size_t kRowsWaiting = 64;

struct Display {
  Many<In<Any[]>>     in{"in*", "U", "[n...<=64]", type = "T", doc = "Numbers or truth values of one unit."};
  InConst<Text<32>>   title{"title", "1", initial = "", doc = "Start of every line."};
  InConst<std::int32_t> digits{"digits", "1", initial = 6, range(1, 17), doc = "Significant digits."};
  Out<std::int64_t>   lines{"lines", "1", initial = 0, doc = "Lines printed or in the ring."};
  Out<std::int64_t>   lost{"lost", "1", initial = 0, doc = "Lines dropped; lines + lost is the number of cycles."};

  Outcome init() {
    if (in.size() == 0) return fault("there is nothing to show: name at least one input");
    if (*digits < 1 || *digits > 17) return fault("digits must be 1 to 17");
    std::size_t columns = 1;
    for (const auto& port : in) {
      if (port.element_type() > CHIMERA_FLOAT64) return fault("texts and structs cannot be shown");
      columns += port.size();
    }
    ring_.make(columns, kRowsWaiting);
    title_ = *title;
    digits_ = *digits;
    return ok();
  }
  void on(Cycle c) {
    if (*lines == 0) origin_ = c.now();
  }
  void cycle(Cycle c) {
    double* row = ring_.begin();
    if (row == nullptr) {
      *lost += 1;
      return;
    }
    *row++ = to_seconds(c.now() - origin_);
    for (const auto& port : in) {
      const std::span<const std::byte> bytes = port.bytes();
      for (std::size_t i = 0; i < port.size(); ++i) {
        const double value = number_at(port.element_type(), bytes.data() + i * port.element_size());
        *row++ = port.valid() ? value : std::nan("");
      }
    }
    ring_.commit();
    *lines += 1;
  }
  // Prints only lines that wait at the start of the call, so that a fast cycle cannot keep background() here.
  void background() {
    for (std::size_t n = 0; n < kRowsWaiting; ++n) {
      const double* row = ring_.front();
      if (row == nullptr) break;
      if (!title_.empty()) std::printf("%s ", title_.c_str());
      std::printf("%.3f s", row[0]);
      for (std::size_t i = 1; i < ring_.columns(); ++i) std::printf(" %.*g", digits_, row[i]);
      std::printf("\n");
      ring_.release();
    }
    std::fflush(stdout);
  }

 private:
  library::RowRing ring_;
  // Copied by init, because background must not read ports.
  Text<32> title_;
  int digits_ = 6;
  Nanoseconds origin_;
};

CHIMERA_COMPONENT(Display, "display", "Prints values, without delaying a cycle.", rate = 2.0);

}  // namespace
