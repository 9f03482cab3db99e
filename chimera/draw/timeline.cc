// SPDX-License-Identifier: Apache-2.0
// Writes a schedule as a line of letters, one for each interval of time, with a legend.
#include "chimera/draw/timeline.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>

#include "chimera/base/assert.h"

namespace chimera::draw {
namespace {

constexpr std::int64_t kMostUnits = 10'000'000;
constexpr std::size_t kLine = 60;

/// Letters for `count` tasks in order: A-Z, a-z, 0-9, then '?'.
char letter_in_order(std::size_t i) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
  return i < kLetters.size() ? kLetters[i] : '?';
}

std::vector<std::pair<char, std::string>> legend_of(std::span<const std::string> tasks) {
  std::vector<std::pair<char, std::string>> legend;
  std::string used;
  bool is_unique = true;
  for (const std::string& task : tasks) {
    const char first = task.empty() ? '?' : static_cast<char>(std::toupper(static_cast<unsigned char>(task[0])));
    is_unique = is_unique && std::isalpha(static_cast<unsigned char>(first)) != 0 &&
                used.find(first) == std::string::npos;
    used += first;
  }
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    legend.emplace_back(is_unique ? used[i] : letter_in_order(i), tasks[i]);
  }
  return legend;
}

/// Execution time of each task in each interval with a running task.
using Shares = std::map<std::int64_t, std::map<std::uint32_t, std::int64_t>>;

void add(Shares& shares, const TapRecord& record, Nanoseconds origin, Nanoseconds unit, Nanoseconds duration) {
  std::int64_t at = std::max<std::int64_t>((record.at - origin).count, 0);
  const std::int64_t end = std::min((record.at - origin).count + record.b, duration.count);
  while (at < end) {
    const std::int64_t index = at / unit.count;
    const std::int64_t upto = std::min(end, (index + 1) * unit.count);
    shares[index][record.task.index] += upto - at;
    at = upto;
  }
}

}  // namespace

Timeline timeline(std::span<const TapRecord> records, std::span<const std::string> tasks, Nanoseconds origin,
                  Nanoseconds unit, Nanoseconds duration) {
  CHIMERA_ASSERT(unit.count > 0);
  Timeline drawn{.letters = {}, .legend = legend_of(tasks)};
  const std::int64_t units = std::clamp<std::int64_t>((duration.count + unit.count - 1) / unit.count, 0, kMostUnits);
  duration = std::min(duration, Nanoseconds{units * unit.count});
  drawn.letters.assign(static_cast<std::size_t>(units), '.');
  Shares shares;
  for (const TapRecord& record : records) {
    if (record.kind == TapKind::kRun && record.task.index < tasks.size()) add(shares, record, origin, unit, duration);
  }
  for (const auto& [index, of_tasks] : shares) {
    const auto most = std::max_element(of_tasks.begin(), of_tasks.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    drawn.letters[static_cast<std::size_t>(index)] = drawn.legend[most->first].first;
  }
  return drawn;
}

std::string text(const Timeline& timeline) {
  std::string all;
  for (std::size_t at = 0; at < timeline.letters.size(); at += kLine) {
    char number[24];
    std::snprintf(number, sizeof number, "%8zu  ", at);
    all += number + timeline.letters.substr(at, kLine) + "\n";
  }
  std::size_t others = 0;  // tasks without a letter
  for (const auto& [letter, name] : timeline.legend) {
    if (letter == '?' && others++ > 0) continue;
    all += std::string("          ") + letter + " = " + name + "\n";
  }
  if (others > 1) all.insert(all.size() - 1, " and " + std::to_string(others - 1) + " more");
  return all + "          . = idle\n";
}

}  // namespace chimera::draw
