// SPDX-License-Identifier: Apache-2.0
// Puts the pieces of a published row together again.
#include "chimera/runtime/hosted/tap_rows.h"

namespace chimera {

TapRows::TapRows(std::span<const std::uint32_t> payload_bytes) : of_(payload_bytes.size()) {
  for (std::size_t i = 0; i < of_.size(); ++i) {
    of_[i].words.resize(payload_bytes[i] / 8);
    of_[i].row.task = TaskId{i};
    of_[i].row.payload = std::as_bytes(std::span<const std::uint64_t>(of_[i].words));
  }
}

const TapRow* TapRows::take(const TapRecord& record) noexcept {
  if (record.task.index >= of_.size()) return nullptr;
  OfTask& t = of_[record.task.index];
  if (record.kind == TapKind::kGroup) {
    t.is_open = record.a == t.words.size();
    t.taken = 0;
    t.row.number = record.row;
    t.row.sequence = static_cast<std::uint64_t>(record.b);
    t.row.at = record.at;
    return t.is_open && t.words.empty() ? finish(t) : nullptr;
  }
  if (record.kind != TapKind::kValue || !t.is_open) return nullptr;
  if (record.row != t.row.number || record.a != t.taken) {
    t.is_open = false;
    return nullptr;
  }
  t.words[t.taken++] = static_cast<std::uint64_t>(record.b);
  return t.taken == t.words.size() ? finish(t) : nullptr;
}

const TapRow* TapRows::finish(OfTask& t) noexcept {
  t.is_open = false;
  t.row.lost = t.has_begun ? static_cast<std::uint32_t>(t.row.number - t.next) : 0;  // the number may wrap
  t.lost += t.row.lost;
  t.next = t.row.number + 1;
  t.has_begun = true;
  return &t.row;
}

}  // namespace chimera
