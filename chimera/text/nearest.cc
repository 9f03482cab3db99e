// SPDX-License-Identifier: Apache-2.0
// Computes edit distances in which a swap counts one, and finds the nearest name.
#include "chimera/text/nearest.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "chimera/base/hosted/wording.h"

namespace chimera {
namespace {

constexpr std::size_t kLongest = 128;  // longer names are cut: a message needs no more, hostile text gets no time

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

bool is_same_but_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

/// Distance with a replacement of case at half the cost: twice the edit distance otherwise.
std::size_t doubled_distance(std::string_view a, std::string_view b, std::size_t cost_of_case) {
  a = a.substr(0, kLongest);
  b = b.substr(0, kLongest);
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = 2 * j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = 2 * i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const char x = a[i - 1], y = b[j - 1];
      const std::size_t replace = x == y ? 0 : lower(x) == lower(y) ? cost_of_case : 2;
      row[j] = std::min({last[j] + 2, row[j - 1] + 2, last[j - 1] + replace});
      if (i > 1 && j > 1 && x == b[j - 2] && a[i - 2] == y) row[j] = std::min(row[j], before_last[j - 2] + 2);
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) { return doubled_distance(a, b, 2) / 2; }

std::string nearest(std::string_view wrong, std::span<const std::string> names) {
  const std::size_t limit = 2 * std::clamp<std::size_t>(wrong.size() / 3, 1, 3);
  std::size_t best = limit + 1;
  std::string_view found;
  for (const std::string& name : names) {
    if (name == wrong) continue;
    const std::size_t distance = is_same_but_case(wrong, name) ? 1 : doubled_distance(wrong, name, 1);
    if (distance < best) {
      best = distance;
      found = name;
    }
  }
  if (!found.empty() || wrong.size() < 3) return std::string(found);
  const auto longer = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return name.size() > wrong.size() && name.starts_with(wrong);
  });
  return longer == names.end() ? "" : *longer;
}

std::string did_you_mean(std::string_view near, char quote) {
  return near.empty() ? "" : std::string("; did you mean ") + quote + std::string(near) + quote + "?";
}

std::string no_such(std::string_view what, std::string_view wrong, std::span<const std::string> names) {
  return "no " + std::string(what) + " " + in_quotes(wrong) + did_you_mean(nearest(wrong, names));
}

}  // namespace chimera
