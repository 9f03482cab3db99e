// SPDX-License-Identifier: Apache-2.0
// Events for people, a line each. Consecutive missed deadlines are one line, so that the acts of users between them
// stay visible.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// The kinds of events that docs/formats/control.md lists.
std::span<const std::string_view> event_kinds() noexcept;

/// The words of --kind, "miss,set"; none for "". Refuses an unknown one with the nearest. Context: setup.
Result<std::vector<std::string>> read_kinds(std::string_view text);

/// The value of --since: events from a number on, or from an instant on. Plain value.
struct Since {
  std::int64_t number = 0;
  std::int64_t wall_ns = INT64_MIN;  ///< since 1970

  bool is_time() const noexcept { return wall_ns != INT64_MIN; }
};
/// "14:05" stands for the last one before `now_ns`, since 1970. Refuses what is neither. Context: setup.
Result<Since> read_since(const std::string& text, std::int64_t now_ns);

/// Takes events in their order. Context: setup.
class EventLines {
 public:
  /// Shows events of these kinds only; none: all. `each`: a line for every event. `from_ns`: no earlier events, since
  /// 1970. `is_dated`: lines have a date.
  explicit EventLines(std::vector<std::string> kinds = {}, bool each = false, std::int64_t from_ns = INT64_MIN,
                      bool is_dated = false)
      : kinds_(std::move(kinds)), each_(each), from_ns_(from_ns), is_dated_(is_dated) {}

  /// The lines that `event` completes; what may go on is kept back until end().
  std::string add(const Json& event);
  std::string end();
  bool is_wanted(const Json& event) const;

 private:
  struct Event {
    std::int64_t number = 0, at_ns = 0, wall_ns = 0;
    std::string kind, who, text;
  };
  static Event read(const Json& event);
  std::string line_of(const Event& event) const;
  std::string line_of(const std::vector<Event>& incident) const;
  std::string line(const Event& first, const std::string& kind, const std::string& text) const;

  std::vector<std::string> kinds_;
  bool each_;
  std::int64_t from_ns_;
  bool is_dated_;
  std::vector<Event> incident_;  ///< misses that are not printed yet
};

/// The answer of `events`, in lines; `since`: the number that was asked for.
std::string events_text(const Json& answer, std::int64_t since, EventLines lines = EventLines());

}  // namespace chimera::cli
