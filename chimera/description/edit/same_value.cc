// SPDX-License-Identifier: Apache-2.0
// Compares values part by part, numbers in one unit.
#include "chimera/description/edit/same_value.h"

#include <algorithm>
#include <cmath>

#include "chimera/units/quantity.h"

namespace chimera {
namespace {

bool is_same_scalar(const Node& a, const Node& b, const UnitSystem& units) {
  if (a.text == b.text) return true;
  const auto x = parse_quantity(a.text, units), y = parse_quantity(b.text, units);
  if (!x || !y) return false;
  const auto in_unit = value_in(*x, y->unit, y->unit_text);
  return in_unit && std::fabs(*in_unit - y->value) <= 1e-12 * std::fabs(y->value);
}

}  // namespace

bool says_same(const Node& before, const Node& now, const UnitSystem& units) {
  if (now.is_list() && !before.is_list())
    return !now.items.empty() && std::all_of(now.items.begin(), now.items.end(),
                                             [&](const Node& item) { return says_same(before, item, units); });
  if (before.kind != now.kind || before.items.size() != now.items.size()) return false;
  if (before.is_scalar()) return is_same_scalar(before, now, units);
  for (std::size_t i = 0; i < before.items.size(); ++i) {
    const Node* item = before.is_map() ? now.find(before.keys[i].text) : &now.items[i];
    if (item == nullptr || !says_same(before.items[i], *item, units)) return false;
  }
  return true;
}

Node as_written(const Node& before, Node now, const UnitSystem& units) {
  if (says_same(before, now, units)) return before;
  if (before.kind != now.kind) return now;
  for (std::size_t i = 0; i < now.items.size(); ++i) {
    const Node* item = now.is_map() ? before.find(now.keys[i].text) : nullptr;
    if (now.is_list() && i < before.items.size()) item = &before.items[i];
    if (item != nullptr) now.items[i] = as_written(*item, std::move(now.items[i]), units);
  }
  return now;
}

}  // namespace chimera
